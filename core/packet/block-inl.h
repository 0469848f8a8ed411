// Blocks of pixels: packets of eye rays first, then, leg by leg, what they spawn.
#if defined(LINETREE_CORE_PACKET_BLOCK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_BLOCK_INL_H_
#undef LINETREE_CORE_PACKET_BLOCK_INL_H_
#else
#define LINETREE_CORE_PACKET_BLOCK_INL_H_
#endif

#include "core/packet/follow-inl.h"
#include "core/packet/packet_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

inline constexpr int kTileSide = 4;

// The lanes of a tile of which so many columns and rows are wanted.
HWY_INLINE LaneMask LanesWithin(int columns, int rows) {
  if (columns >= kTileSide && rows >= kTileSide) return kAllLanes;
  LaneMask lanes = 0;
  for (int lane = 0; lane < kPacketLanes; ++lane) {
    if (lane % kTileSide < columns && lane / kTileSide < rows) lanes |= LaneMask{1} << lane;
  }
  return lanes;
}

// Eye rays of a block's pixels: EyeRays::ThroughPixel, in its order.
class EyeGrid {
 public:
  HWY_INLINE EyeGrid(const EyeRays& eye_rays, int column, int row) : eye_rays_(eye_rays) {
    for (int i = 0; i < kBlockSide; ++i) {
      across_[i] = 2 * (column + i + 0.5) / eye_rays.width() - 1;
      up_[i] = 1 - 2 * (row + i + 0.5) / eye_rays.height();
    }
  }

  // Of the tile whose top left pixel is this one of the block's.
  HWY_INLINE void SetDirections(int column, int row, PacketRays& rays) const {
    alignas(64) double x[kPacketLanes], y[kPacketLanes];
    for (int line = 0; line < kTileSide; ++line) {
      for (int i = 0; i < kTileSide; ++i) {
        x[line * kTileSide + i] = across_[column + i];
        y[line * kTileSide + i] = up_[row + line];
      }
    }
    const Doubles across = Doubles::Load(x), up = Doubles::Load(y);
    const WideVectors sum = Spread(eye_rays_.forward()) + Spread(eye_rays_.right()) * across +
                            Spread(eye_rays_.up()) * up;
    Store(Normalized(sum, Dot(sum, sum)), rays.direction);
  }

 private:
  const EyeRays& eye_rays_;
  double across_[kBlockSide], up_[kBlockSide];
};

HWY_INLINE void SetEyes(const EyeRays& eye_rays, PacketRays& rays) {
  Store(Spread(eye_rays.eye()), rays.origin);
  Ints::All(kNoObject).Store(rays.start_object);
  Ints::All(0).Store(rays.start_face);
  rays.start_inside = 0;
}

// The beginning of paths.
HWY_INLINE void SetUpPaths(PathPacket& packet) {
  for (int lane = 0; lane < kPacketLanes; ++lane) {
    packet.weight[lane] = 1;
    packet.path[lane] = kEyePath;
    for (auto& throughput : packet.throughput) throughput[lane] = 1;
  }
}

HWY_INLINE void SetPixels(int first, PathPacket& packet) {
  for (int lane = 0; lane < kPacketLanes; ++lane) packet.pixel[lane] = first + lane;
}

// The legs after the first one: their light goes to the block's sums.
template <class Follower>
HWY_INLINE void FollowQueues(Follower& follower, const PathLimits& limits,
                             PacketWorkspace& workspace) {
  for (int depth = 2; depth <= limits.max_depth; ++depth) {
    const int level = (depth - 1) % 2;
    workspace.queue(1 - level, 0).Clear();
    workspace.queue(1 - level, 1).Clear();
    bool any = false;
    for (int branch = 0; branch < 2; ++branch) {
      for (const PathPacket& packet : workspace.queue(level, branch).packets) {
        any = true;
        follower.Follow(packet, depth);
        alignas(64) float light[3][kPacketLanes];
        for (int c = 0; c < 3; ++c) {
          (follower.sum()[c] * Floats::Load(packet.throughput[c])).Store(light[c]);
        }
        for (LaneMask left = packet.rays.active; left != 0; left &= left - 1) {
          const int lane = std::countr_zero(left);
          float* sum = workspace.radiance() + packet.pixel[lane];
          for (int c = 0; c < 3; ++c) sum[c * kBlockPixels] += light[c][lane];
          workspace.uses()[packet.pixel[lane]] |= kSearched;
        }
      }
    }
    if (!any) return;
  }
}

HWY_INLINE void ClearQueues(PacketWorkspace& workspace) {
  for (int level = 0; level < 2; ++level) {
    for (int branch = 0; branch < 2; ++branch) workspace.queue(level, branch).Clear();
  }
}

// Where the lanes of a tile lie in the image.
struct TilePlace {
  int column = 0, row = 0;  // of the top left pixel
  LaneMask lanes = 0;       // that are pixels

  HWY_INLINE size_t PixelOf(int lane, size_t stride) const {
    return static_cast<size_t>(row + lane / kTileSide) * stride +
           static_cast<size_t>(column + lane % kTileSide);
  }
};

// Copies sixteen items of `width` values each to their pixels.
template <int kWidth, class T>
HWY_INLINE void StoreTile(const T* from, const TilePlace& place, size_t stride, T* to) {
  if (place.lanes == kAllLanes) {
    for (int line = 0; line < kTileSide; ++line) {
      std::memcpy(to + kWidth * place.PixelOf(line * kTileSide, stride),
                  from + kWidth * line * kTileSide, sizeof(T) * kWidth * kTileSide);
    }
    return;
  }
  for (LaneMask left = place.lanes; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    std::memcpy(to + kWidth * place.PixelOf(lane, stride), from + kWidth * lane,
                sizeof(T) * kWidth);
  }
}

HWY_INLINE void StoreFirstHits(const PacketHits& hits, const TilePlace& place, size_t stride,
                               const PixelTarget& target) {
  const Mask hit = MaskOf(hits.hit);
  if (target.object != nullptr) {
    alignas(64) int32_t object[kPacketLanes];
    Select(hit, Ints::Load(hits.object), Ints::All(kNoObject)).Store(object);
    StoreTile<1>(object, place, stride, target.object);
  }
  if (target.depth != nullptr) {
    alignas(64) float depth[kPacketLanes];
    const Floats infinity = Floats::All(std::numeric_limits<float>::infinity());
    Select(hit, Demoted(Doubles::Load(hits.t)), infinity).Store(depth);
    StoreTile<1>(depth, place, stride, target.depth);
  }
}

// The sums of a tile, channel by channel, as pixels.
HWY_INLINE void StoreRadiance(const float* sums, const TilePlace& place, size_t stride, float* to) {
  alignas(64) float pixels[3 * kPacketLanes];
  for (int lane = 0; lane < kPacketLanes; ++lane) {
    for (int c = 0; c < 3; ++c) pixels[3 * lane + c] = sums[c * kBlockPixels + lane];
  }
  StoreTile<3>(pixels, place, stride, to);
}

// Of the block's tiles, row by row, those whose bit is set in `tiles`.
template <class Lights>
HWY_INLINE void RenderTiles(const PacketScene& scene, const BlockTask& task, uint64_t tiles,
                            Lights& lights, PacketWorkspace& workspace, PacketCounts& counts) {
  const PixelTarget& target = task.target;
  const PacketTracer::Region& region = task.region;
  const bool digested = target.topology != nullptr;
  Follower<Lights> follower(scene, task.limits, lights, digested, workspace, counts);
  ClearQueues(workspace);
  std::fill_n(workspace.uses(), kBlockPixels, 0);
  if (digested) std::fill_n(workspace.digest(), kBlockPixels, 0);
  const int tiles_across = (region.width + kTileSide - 1) / kTileSide;
  const int tiles_down = (region.height + kTileSide - 1) / kTileSide;
  const int count = tiles_across * tiles_down;
  const EyeGrid grid(task.eye_rays, region.column, region.row);
  PathPacket packet;
  SetUpPaths(packet);
  SetEyes(task.eye_rays, packet.rays);
  TilePlace places[kBlockPixels / kPacketLanes];
  for (int tile = 0; tile < count; ++tile) {
    if ((tiles >> tile & 1) == 0) continue;
    const int column = tile % tiles_across * kTileSide, row = tile / tiles_across * kTileSide;
    TilePlace& place = places[tile];
    place = {region.column + column, region.row + row,
             LanesWithin(region.width - column, region.height - row)};
    const int first = tile * kPacketLanes;
    grid.SetDirections(column, row, packet.rays);
    packet.rays.active = place.lanes;
    SetPixels(first, packet);
    counts.rays.eye += static_cast<uint64_t>(std::popcount(place.lanes));
    follower.Follow(packet, 1);
    for (int c = 0; c < 3; ++c) {
      follower.sum()[c].Store(workspace.radiance() + c * kBlockPixels + first);
    }
    StoreFirstHits(follower.hits(), place, task.stride, target);
  }
  FollowQueues(follower, task.limits, workspace);
  for (int tile = 0; tile < count; ++tile) {
    const TilePlace& place = places[tile];
    if (place.lanes == 0) continue;
    const int first = tile * kPacketLanes;
    StoreRadiance(workspace.radiance() + first, place, task.stride, target.radiance);
    if (digested) StoreTile<1>(workspace.digest() + first, place, task.stride, target.topology);
    if (target.uses != nullptr) {
      StoreTile<1>(workspace.uses() + first, place, task.stride, target.uses);
    }
  }
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
