// Eye rays of a block's pixels.
#if defined(LINETREE_CORE_PACKET_EYE_GRID_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_EYE_GRID_INL_H_
#undef LINETREE_CORE_PACKET_EYE_GRID_INL_H_
#else
#define LINETREE_CORE_PACKET_EYE_GRID_INL_H_
#endif

#include "core/packet/finish-inl.h"
#include "core/packet/packet_workspace.h"
#include "core/packet/shaft-inl.h"
#include "core/scene/camera.h"
#include "core/scene/pixel_samples.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

inline constexpr int kTileSide = 4;

// Of a rectangle's pixels, in units of EyeRays::right() and up(): the first and the last.
struct SquareBounds {
  double across[2], up[2];

  double FarthestAcross() const { return std::max(std::abs(across[0]), std::abs(across[1])); }
  double FarthestUp() const { return std::max(std::abs(up[0]), std::abs(up[1])); }
};

// EyeRays::Through, in its order, for the centres of pixels or for the samples of cells.
class EyeGrid {
 public:
  // What bounds of pixels hold: the rays through their centres, or all of each pixel.
  enum class Extent { kCentres, kWhole };

  // `samples`: pixels are cells of the finer image that these are counted in.
  HWY_INLINE EyeGrid(const EyeRays& eye_rays, int column, int row,
                     const PixelSamples* samples = nullptr, Extent extent = Extent::kCentres)
      : eye_rays_(eye_rays),
        scattered_(samples != nullptr && !samples->AreCentred() ? samples : nullptr),
        column_(column),
        row_(row) {
    for (int i = 0; i < kBlockSide; ++i) {
      across_[i] = AcrossAt(column + i + 0.5);
      up_[i] = UpAt(row + i + 0.5);
    }
    for (int tile = 0; tile < kTiles; ++tile) {
      for (int lane = 0; lane < kPacketLanes; ++lane) {
        tile_across_[tile][lane] = across_[tile * kTileSide + lane % kTileSide];
        tile_up_[tile][lane] = up_[tile * kTileSide + lane / kTileSide];
      }
    }
    if (scattered_ == nullptr && extent == Extent::kCentres) return;
    first_across_ = across_edges_;
    last_across_ = across_edges_ + 1;
    first_up_ = up_edges_;
    last_up_ = up_edges_ + 1;
    for (int i = 0; i <= kBlockSide; ++i) {
      across_edges_[i] = AcrossAt(column + i);
      up_edges_[i] = UpAt(row + i);
    }
  }

  EyeGrid(const EyeGrid&) = delete;
  EyeGrid& operator=(const EyeGrid&) = delete;

  // Of the tile whose top left pixel is this one of the block's.
  HWY_INLINE void SetDirections(int column, int row, PacketRays& rays) const {
    const PlanePlaces at = PlacesOf(column, row);
    const WideVectors through = Through(at.across, at.up);
    Store(Normalized(through, Dot(through, through)), rays.direction);
  }

  // How far to the right and up the rays of a tile's pixels lie, in units of right() and up().
  struct PlanePlaces {
    Doubles across, up;
  };
  // Given the block's column and row where the tile begins.
  HWY_INLINE PlanePlaces PlacesOf(int column, int row) const {
    if (scattered_ != nullptr) return ScatteredPlacesOf(column, row);
    return {Doubles::Load(tile_across_[column / kTileSide]),
            Doubles::Load(tile_up_[row / kTileSide])};
  }

  // From the eye to the pixels of these columns and rows of the block, in the plane at depth 1; to
  // the outer sides of the first and the last ones where bounds hold whole pixels.
  HWY_INLINE WideVectors Through(const int columns[kTileSide], const int rows[kTileSide]) const {
    alignas(64) double x[kPacketLanes], y[kPacketLanes];
    for (int line = 0; line < kTileSide; ++line) {
      for (int i = 0; i < kTileSide; ++i) {
        x[line * kTileSide + i] = (i == 0 ? first_across_ : last_across_)[columns[i]];
        y[line * kTileSide + i] = (line == 0 ? first_up_ : last_up_)[rows[line]];
      }
    }
    return Through(Doubles::Load(x), Doubles::Load(y));
  }
  HWY_INLINE WideVectors Through(const Doubles& across, const Doubles& up) const {
    return Spread(eye_rays_.forward()) + Spread(eye_rays_.right()) * across +
           Spread(eye_rays_.up()) * up;
  }

  HWY_INLINE SquareBounds BoundsOf(int column, int row, int width, int height) const {
    return {{first_across_[column], last_across_[column + width - 1]},
            {first_up_[row], last_up_[row + height - 1]}};
  }

  // Of what Through gives for the pixels of a rectangle; to be padded by what float rounds.
  HWY_INLINE Bounds DirectionBounds(int column, int row, int width, int height) const {
    const auto of = [](const Vec3d& v, size_t axis) HWY_ATTR { return v[axis]; };
    const SquareBounds ends = BoundsOf(column, row, width, height);
    Bounds bounds;
    for (size_t axis = 0; axis < 3; ++axis) {
      const double right = of(eye_rays_.right(), axis), up = of(eye_rays_.up(), axis);
      const double a = right * ends.across[0], b = right * ends.across[1];
      const double c = up * ends.up[0], d = up * ends.up[1];
      const double forward = of(eye_rays_.forward(), axis);
      bounds.low[axis] = static_cast<float>(forward + std::min(a, b) + std::min(c, d));
      bounds.high[axis] = static_cast<float>(forward + std::max(a, b) + std::max(c, d));
    }
    return bounds;
  }

 private:
  static constexpr int kTiles = kBlockSide / kTileSide;

  HWY_INLINE double AcrossAt(double x) const { return 2 * x / eye_rays_.width() - 1; }
  HWY_INLINE double UpAt(double y) const { return 1 - 2 * y / eye_rays_.height(); }

  HWY_NOINLINE PlanePlaces ScatteredPlacesOf(int column, int row) const {
    alignas(64) double across[kPacketLanes], up[kPacketLanes];
    for (int lane = 0; lane < kPacketLanes; ++lane) {
      const int x = column_ + column + lane % kTileSide, y = row_ + row + lane / kTileSide;
      const PixelSamples::Place place = scattered_->PlaceIn(x, y);
      across[lane] = AcrossAt(x + place.x);
      up[lane] = UpAt(y + place.y);
    }
    return {Doubles::Load(across), Doubles::Load(up)};
  }

  const EyeRays& eye_rays_;
  const PixelSamples* const scattered_;  // null: rays go through the centres
  const int column_, row_;               // of the block
  alignas(64) double tile_across_[kTiles][kPacketLanes], tile_up_[kTiles][kPacketLanes];
  double across_[kBlockSide], up_[kBlockSide];
  double across_edges_[kBlockSide + 1],
      up_edges_[kBlockSide + 1];                                   // where bounds hold whole pixels
  const double *first_across_ = across_, *last_across_ = across_;  // where a pixel's bounds begin
  const double *first_up_ = up_, *last_up_ = up_;                  // and end
};

HWY_INLINE void SetEyes(const EyeRays& eye_rays, PacketRays& rays) {
  Store(Spread(eye_rays.eye()), rays.origin);
  Ints::All(kNoObject).Store(rays.start_object);
  Ints::All(0).Store(rays.start_face);
  rays.start_inside = 0;
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
