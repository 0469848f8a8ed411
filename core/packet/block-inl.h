// Blocks of pixels: packets of eye rays first, then, leg by leg, what they spawn.
#if defined(LINETREE_CORE_PACKET_BLOCK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_BLOCK_INL_H_
#undef LINETREE_CORE_PACKET_BLOCK_INL_H_
#else
#define LINETREE_CORE_PACKET_BLOCK_INL_H_
#endif

#include "core/packet/eye_grid-inl.h"
#include "core/packet/follow-inl.h"
#include "core/packet/packet_kernels.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// The lanes of a tile of which so many columns and rows are wanted.
HWY_INLINE LaneMask LanesWithin(int columns, int rows) {
  if (columns >= kTileSide && rows >= kTileSide) return kAllLanes;
  LaneMask lanes = 0;
  for (int lane = 0; lane < kPacketLanes; ++lane) {
    if (lane % kTileSide < columns && lane / kTileSide < rows) lanes |= LaneMask{1} << lane;
  }
  return lanes;
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
  packet.is_tile = true;
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

// Where the lanes of a tile lie in the target.
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

// Of a tile all of which sees one object.
HWY_INLINE void StoreFirstHit(int32_t seen, const Floats& depth, const TilePlace& place,
                              size_t stride, const PixelTarget& target) {
  if (target.object != nullptr) {
    alignas(64) int32_t object[kPacketLanes];
    Ints::All(seen).Store(object);
    StoreTile<1>(object, place, stride, target.object);
  }
  if (target.depth != nullptr) {
    alignas(64) float at[kPacketLanes];
    depth.Store(at);
    StoreTile<1>(at, place, stride, target.depth);
  }
}

// The sums of a tile, channel by channel, as pixels.
HWY_INLINE void StoreRadiance(const float* sums, const TilePlace& place, size_t stride, float* to) {
  alignas(64) float pixels[3 * kPacketLanes];
  for (size_t k = 0; k < LanesOf<float>::kVectors; ++k) {
    const Floats::Tag tag;
    const float* from = sums + k * LanesOf<float>::kWidth;
    hn::StoreInterleaved3(hn::Load(tag, from), hn::Load(tag, from + kBlockPixels),
                          hn::Load(tag, from + 2 * kBlockPixels), tag,
                          pixels + 3 * k * LanesOf<float>::kWidth);
  }
  StoreTile<3>(pixels, place, stride, to);
}

// Renders tiles of one block.
template <class Lights>
class BlockRenderer {
 public:
  HWY_INLINE BlockRenderer(const PacketScene& scene, const BlockTask& task, Lights& lights,
                           PacketWorkspace& workspace, PacketCounts& counts)
      : scene_(scene),
        task_(task),
        lights_(lights),
        workspace_(workspace),
        counts_(counts),
        digested_(task.target.topology != nullptr),
        tiles_across_((task.region.width + kTileSide - 1) / kTileSide),
        tiles_down_((task.region.height + kTileSide - 1) / kTileSide),
        grid_(task.eye_rays, task.region.column, task.region.row, task.samples),
        sighter_(scene, task.eye_rays, grid_),
        follower_(scene, task.limits, lights, digested_, workspace, counts) {
    SetUpPaths(packet_);
    SetEyes(task.eye_rays, packet_.rays);
  }

  HWY_INLINE void Render() {
    ClearQueues(workspace_);
    std::fill_n(workspace_.uses(), kBlockPixels, 0);
    if (digested_) std::fill_n(workspace_.digest(), kBlockPixels, 0);
    for (int row = 0; row < tiles_down_; row += kSquareTiles) {
      for (int column = 0; column < tiles_across_; column += kSquareTiles) {
        RenderSquare(column, row, kSquareTiles);
      }
    }
    FollowQueues(follower_, task_.limits, workspace_);
    StoreTiles();
  }

 private:
  // Sides of the squares that are looked at as a whole, in tiles: the block first, then its
  // quadrants, and of them those that seem to see one face. To look costs as much as a packet.
  static constexpr int kSquareTiles = 8, kLeastSquareTiles = 2;

  HWY_INLINE bool IsWanted(int column, int row) const {
    return column < tiles_across_ && row < tiles_down_ &&
           (task_.tiles >> (row * tiles_across_ + column) & 1) != 0;
  }

  HWY_INLINE int CountWanted(int column, int row, int side) const {
    int count = 0;
    for (int r = row; r < row + side; ++r) {
      for (int c = column; c < column + side; ++c) count += IsWanted(c, r) ? 1 : 0;
    }
    return count;
  }

  // Whether it is known what all wanted tiles of the square see.
  HWY_INLINE bool IsSeen(int column, int row, int side) const {
    for (int r = row; r < row + side; ++r) {
      for (int c = column; c < column + side; ++c) {
        if (IsWanted(c, r) && !task_.seen[r * tiles_across_ + c].is_known) return false;
      }
    }
    return true;
  }

  HWY_INLINE Sight Look(int column, int row, int side) const {
    const int x = column * kTileSide, y = row * kTileSide;
    return sighter_.Look(x, y, std::min(side * kTileSide, task_.region.width - x),
                         std::min(side * kTileSide, task_.region.height - y));
  }
  // Column, row and side in tiles.
  HWY_NOINLINE void RenderSquare(int column, int row, int side) {
    const int wanted = CountWanted(column, row, side);
    if (wanted == 0) return;
    if (task_.seen != nullptr && IsSeen(column, row, side)) {
      RenderTilesOf(column, row, side, nullptr);
      return;
    }
    Sight sight;
    if (task_.sees_squares && 2 * wanted >= side * side) sight = Look(column, row, side);
    const int half = side / 2;
    const bool looks_on = side == kSquareTiles && task_.sees_squares;
    if (sight.face || side == kLeastSquareTiles || (sight.quadrants == 0 && !looks_on)) {
      RenderTilesOf(column, row, side, sight.face ? &*sight.face : nullptr);
      return;
    }
    for (int q = 0; q < 4; ++q) {
      const int c = column + q % 2 * half, r = row + q / 2 * half;
      if (looks_on || (sight.quadrants >> q & 1) != 0) {
        RenderSquare(c, r, half);
      } else {
        RenderTilesOf(c, r, half, nullptr);
      }
    }
  }

  HWY_INLINE void RenderTilesOf(int column, int row, int side, const VisibleFace* face) {
    for (int r = row; r < row + side; ++r) {
      for (int c = column; c < column + side; ++c) {
        if (!IsWanted(c, r)) continue;
        const SeenFace* seen = task_.seen != nullptr ? &task_.seen[r * tiles_across_ + c] : nullptr;
        if (face == nullptr && seen != nullptr && seen->is_known) {
          const VisibleFace own = {seen->object, seen->code};
          RenderTile(c, r, &own);
        } else {
          RenderTile(c, r, face);
        }
      }
    }
  }

  // `face`: what all of it sees, if that is known.
  HWY_NOINLINE void RenderTile(int tile_column, int tile_row, const VisibleFace* face) {
    const PacketTracer::Region& region = task_.region;
    const int tile = tile_row * tiles_across_ + tile_column;
    const int column = tile_column * kTileSide, row = tile_row * kTileSide;
    TilePlace& place = places_[tile];
    place = {region.column - task_.left + column, region.row - task_.top + row,
             LanesWithin(region.width - column, region.height - row)};
    const int first = tile * kPacketLanes;
    packet_.rays.active = place.lanes;
    SetPixels(first, packet_);
    counts_.rays.eye += static_cast<uint64_t>(std::popcount(place.lanes));
    if (face != nullptr) {
      CountSeen(place.lanes);
      if (RenderSheet(*face, column, row, place, first)) return;
      grid_.SetDirections(column, row, packet_.rays);
      SetHitsOn(scene_, packet_.rays, *face, follower_.hits(), counts_);
    } else {
      grid_.SetDirections(column, row, packet_.rays);
      HitSearch search;
      SearchHits(scene_, packet_.rays, search, counts_);
      const auto own = FaceOf(search, place.lanes);
      if (own && RenderSheet(*own, column, row, place, first)) return;
      CompleteHits(scene_, packet_.rays, search, follower_.hits(), counts_);
    }
    follower_.Shade(packet_, 1);
    float* sums = workspace_.radiance() + first;
    for (int c = 0; c < 3; ++c) follower_.sum()[c].Store(sums + c * kBlockPixels);
    StoreFirstHits(follower_.hits(), place, task_.stride, task_.target);
    MarkMissed(place.lanes & ~follower_.hits().hit, workspace_.uses() + first);
  }

  static HWY_INLINE void MarkMissed(LaneMask missed, uint8_t* uses) {
    for (; missed != 0; missed &= missed - 1) uses[std::countr_zero(missed)] |= kMissed;
  }

  // A search that was spared counts as one all the same: as many rays are answered.
  HWY_INLINE void CountSeen(LaneMask lanes) {
    const auto seen = static_cast<uint64_t>(std::popcount(lanes));
    counts_.rays.intersect += seen;
    counts_.seen += seen;
  }

  // What packet_ sees on a face, if its light is known without its hits.
  HWY_INLINE bool RenderSheet(const VisibleFace& face, int column, int row, const TilePlace& place,
                              int first) {
    if constexpr (Lights::kHasSheets) {
      if (face.object == kNoObject ||
          !lights_.OpenSheet(face, task_.eye_rays,
                             grid_.BoundsOf(0, 0, task_.region.width, task_.region.height))) {
        return false;
      }
      Floats radiance[3], depth;
      const EyeGrid::PlanePlaces at = grid_.PlacesOf(column, row);
      if (!lights_.EvaluateSheet(packet_, at.across, at.up, radiance, depth)) return false;
      counts_.on_sheets += static_cast<uint64_t>(std::popcount(place.lanes));
      float* sums = workspace_.radiance() + first;
      for (int c = 0; c < 3; ++c) radiance[c].Store(sums + c * kBlockPixels);
      StoreFirstHit(face.object, depth, place, task_.stride, task_.target);
      return true;
    }
    return false;
  }

  HWY_INLINE void StoreTiles() {
    const PixelTarget& target = task_.target;
    for (int tile = 0; tile < tiles_across_ * tiles_down_; ++tile) {
      const TilePlace& place = places_[tile];
      if (place.lanes == 0) continue;
      const int first = tile * kPacketLanes;
      StoreRadiance(workspace_.radiance() + first, place, task_.stride, target.radiance);
      if (digested_)
        StoreTile<1>(workspace_.digest() + first, place, task_.stride, target.topology);
    }
  }

  const PacketScene& scene_;
  const BlockTask& task_;
  Lights& lights_;
  PacketWorkspace& workspace_;
  PacketCounts& counts_;
  const bool digested_;
  const int tiles_across_, tiles_down_;
  const EyeGrid grid_;
  const Sighter sighter_;
  Follower<Lights> follower_;
  PathPacket packet_;
  TilePlace places_[kBlockPixels / kPacketLanes];
};

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
