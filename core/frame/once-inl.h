// Blocks of pixels that have several samples each: which of the pixels are evaluated once for all
// of them, and what the others are certain to see.
#if defined(LINETREE_CORE_FRAME_ONCE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_FRAME_ONCE_INL_H_
#undef LINETREE_CORE_FRAME_ONCE_INL_H_
#else
#define LINETREE_CORE_FRAME_ONCE_INL_H_
#endif

#include "core/frame/frame_kernels.h"
#include "core/frame/pixel_sheet-inl.h"
#include "core/packet/block-inl.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

class OnceRenderer {
 public:
  HWY_INLINE OnceRenderer(const PacketScene& scene, const OnceTask& task,
                          const SurfaceCache::Reader& reader, const FramePlan& plan,
                          PacketWorkspace& workspace, PacketCounts& counts, OnceBlock& block)
      : scene_(scene),
        task_(task),
        reader_(reader),
        plan_(plan),
        workspace_(workspace),
        counts_(counts),
        block_(block),
        tiles_across_((task.region.width + kTileSide - 1) / kTileSide),
        tiles_down_((task.region.height + kTileSide - 1) / kTileSide),
        grid_(task.eye_rays, task.region.column, task.region.row, nullptr, EyeGrid::Extent::kWhole),
        sighter_(scene, task.eye_rays, grid_),
        cells_(reader),
        sheet_(scene, reader, cells_) {}
  // Written down, because what is implicit is not compiled for this target.
  HWY_INLINE ~OnceRenderer() {}

  HWY_INLINE void Render() {
    block_ = {};
    std::fill_n(workspace_.uses(), kBlockPixels, 0);
    for (int row = 0; row < tiles_down_; row += kMostTiles) {
      for (int column = 0; column < tiles_across_; column += kMostTiles) {
        Look(column, row, kMostTiles);
      }
    }
  }

 private:
  // Sides of the squares that are looked at as a whole, in tiles. The samples of a tile are many
  // packets, so even one is worth a look.
  static constexpr int kMostTiles = 8;

  HWY_NOINLINE void Look(int column, int row, int side) {
    if (column >= tiles_across_ || row >= tiles_down_) return;
    const Extents size = SizeOf(column, row, side);
    const Sight sight = sighter_.Look(column * kTileSide, row * kTileSide, size.width, size.height);
    if (sight.face) {
      for (int r = row; r < std::min(row + side, tiles_down_); ++r) {
        for (int c = column; c < std::min(column + side, tiles_across_); ++c) {
          Evaluate(c, r, *sight.face);
        }
      }
      return;
    }
    for (int q = 0; q < 4 && side > 1; ++q) {
      if (side != kMostTiles && (sight.quadrants >> q & 1) == 0) continue;
      Look(column + q % 2 * (side / 2), row + q / 2 * (side / 2), side / 2);
    }
  }

  struct Extents {
    int width, height;
  };
  // In pixels.
  HWY_INLINE Extents SizeOf(int column, int row, int side) const {
    return {std::min(side * kTileSide, task_.region.width - column * kTileSide),
            std::min(side * kTileSide, task_.region.height - row * kTileSide)};
  }

  HWY_NOINLINE void Evaluate(int column, int row, const VisibleFace& face) {
    const int tile = row * tiles_across_ + column;
    block_.seen[tile] = {face.object, face.code, true};
    const Extents size = SizeOf(column, row, 1);
    const LaneMask lanes = LanesWithin(size.width, size.height);
    const EyeGrid::PlanePlaces at = grid_.PlacesOf(column * kTileSide, row * kTileSide);
    Floats radiance[3], depth;
    LaneUses uses;
    LaneMask done = lanes;
    if (face.object == kNoObject) {
      for (int c = 0; c < 3; ++c) {
        radiance[c] = Floats::All(static_cast<float>(scene_.scene().background[c]));
      }
      depth = Floats::All(std::numeric_limits<float>::infinity());
    } else {
      if (!Opens(face)) return;
      const SquareBounds bounds =
          grid_.BoundsOf(column * kTileSide, row * kTileSide, size.width, size.height);
      done = sheet_.EvaluateOnce(at, bounds, task_.samples.MeanOff(), lanes, radiance, uses);
      if (done == 0) return;
      const EyeGrid::PlanePlaces shown = ShownPlaces(column * kTileSide, row * kTileSide, at);
      depth = sheet_.DepthAt(shown.across, shown.up);
    }
    block_.done[tile] = done;
    Store(tile, face.object, done, radiance, depth, uses);
  }

  HWY_INLINE void Store(int tile, int32_t object, LaneMask done, const Floats radiance[3],
                        const Floats& depth, const LaneUses& uses) {
    const int column = tile % tiles_across_ * kTileSide, row = tile / tiles_across_ * kTileSide;
    const TilePlace place = {task_.region.column + column, task_.region.row + row, done};
    const int first = tile * kPacketLanes;
    float* sums = workspace_.radiance() + first;
    for (int c = 0; c < 3; ++c) radiance[c].Store(sums + c * kBlockPixels);
    StoreRadiance(sums, place, task_.stride, task_.target.radiance);
    StoreFirstHit(object, depth, place, task_.stride, task_.target);
    uint8_t* to = workspace_.uses() + first;
    for (LaneMask left = done; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const auto has = [lane](LaneMask mask, int use) { return (mask >> lane & 1) != 0 ? use : 0; };
      to[lane] = static_cast<uint8_t>(
          object == kNoObject ? kMissed : has(uses.listed, kListed) | has(uses.summed, kSummed));
    }
    const auto pixels = static_cast<uint64_t>(std::popcount(done));
    const uint64_t samples = pixels * static_cast<uint64_t>(task_.samples.count());
    counts_.rays.eye += samples;
    counts_.rays.intersect += samples;
    counts_.seen += samples;
    if (object == kNoObject) return;
    counts_.on_sheets += samples;
    counts_.rays.shade += pixels;
    counts_.rays.summed += static_cast<uint64_t>(std::popcount(uses.summed));
  }

  // Whether the face may be a sheet.
  HWY_INLINE bool Opens(const VisibleFace& face) {
    if (face.object == asked_face_.object && face.code == asked_face_.code) return opens_;
    asked_face_ = face;
    opens_ = false;
    const auto object = static_cast<size_t>(face.object);
    if (!(reader_.epsilon() > 0) || !plan_.Pays(object)) return false;
    const SurfaceTree* tree = reader_.TreeOf(object);
    return opens_ = tree != nullptr &&
                    sheet_.Open(*tree, face, task_.eye_rays,
                                grid_.BoundsOf(0, 0, task_.region.width, task_.region.height));
  }

  // Of the samples that are shown (ShownSample).
  HWY_NOINLINE EyeGrid::PlanePlaces ShownPlaces(int column, int row,
                                                const EyeGrid::PlanePlaces& centres) const {
    const PixelSamples& samples = task_.samples;
    const double by_x = 2 / task_.eye_rays.width(), by_y = -2 / task_.eye_rays.height();
    const auto off = [&](int x, int y) {
      const PixelSamples::Place in = samples.PlaceIn(x * samples.across() + task_.shown_column,
                                                     y * samples.down() + task_.shown_row);
      return PixelSamples::Place{(task_.shown_column + in.x) / samples.across() - 0.5,
                                 (task_.shown_row + in.y) / samples.down() - 0.5};
    };
    if (samples.AreCentred()) {  // the same in all pixels
      const PixelSamples::Place all = off(0, 0);
      return {centres.across + Doubles::All(by_x * all.x), centres.up + Doubles::All(by_y * all.y)};
    }
    alignas(64) double across[kPacketLanes], up[kPacketLanes];
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      const PixelSamples::Place own = off(task_.region.column + column + lane % kTileSide,
                                          task_.region.row + row + lane / kTileSide);
      across[lane] = by_x * own.x;
      up[lane] = by_y * own.y;
    }
    return {centres.across + Doubles::Load(across), centres.up + Doubles::Load(up)};
  }

  const PacketScene& scene_;
  const OnceTask& task_;
  const SurfaceCache::Reader& reader_;
  const FramePlan& plan_;
  PacketWorkspace& workspace_;
  PacketCounts& counts_;
  OnceBlock& block_;
  const int tiles_across_, tiles_down_;
  const EyeGrid grid_;
  const Sighter sighter_;
  OpenCells cells_;
  PixelSheet sheet_;
  VisibleFace asked_face_;  // whether it
  bool opens_ = false;      // may be a sheet
};

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
