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

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

inline constexpr int kTileSide = 4;

// Of a rectangle's pixels, in units of EyeRays::right() and up(): the first and the last.
struct SquareBounds {
  double across[2], up[2];

  double FarthestAcross() const { return std::max(std::abs(across[0]), std::abs(across[1])); }
  double FarthestUp() const { return std::max(std::abs(up[0]), std::abs(up[1])); }
};

// EyeRays::ThroughPixel, in its order.
class EyeGrid {
 public:
  HWY_INLINE EyeGrid(const EyeRays& eye_rays, int column, int row) : eye_rays_(eye_rays) {
    for (int i = 0; i < kBlockSide; ++i) {
      across_[i] = 2 * (column + i + 0.5) / eye_rays.width() - 1;
      up_[i] = 1 - 2 * (row + i + 0.5) / eye_rays.height();
    }
    for (int tile = 0; tile < kTiles; ++tile) {
      for (int lane = 0; lane < kPacketLanes; ++lane) {
        tile_across_[tile][lane] = across_[tile * kTileSide + lane % kTileSide];
        tile_up_[tile][lane] = up_[tile * kTileSide + lane / kTileSide];
      }
    }
  }

  // Of the tile whose top left pixel is this one of the block's.
  HWY_INLINE void SetDirections(int column, int row, PacketRays& rays) const {
    const WideVectors through = Through(Across(column), Up(row));
    Store(Normalized(through, Dot(through, through)), rays.direction);
  }

  // How far to the right and up the pixels of a tile lie, in units of right() and up(), given the
  // block's column or row where it begins.
  HWY_INLINE Doubles Across(int column) const {
    return Doubles::Load(tile_across_[column / kTileSide]);
  }
  HWY_INLINE Doubles Up(int row) const { return Doubles::Load(tile_up_[row / kTileSide]); }

  // From the eye to the pixels of these columns and rows of the block, in the plane at depth 1.
  HWY_INLINE WideVectors Through(const int columns[kTileSide], const int rows[kTileSide]) const {
    alignas(64) double x[kPacketLanes], y[kPacketLanes];
    for (int line = 0; line < kTileSide; ++line) {
      for (int i = 0; i < kTileSide; ++i) {
        x[line * kTileSide + i] = across_[columns[i]];
        y[line * kTileSide + i] = up_[rows[line]];
      }
    }
    return Through(Doubles::Load(x), Doubles::Load(y));
  }
  HWY_INLINE WideVectors Through(const Doubles& across, const Doubles& up) const {
    return Spread(eye_rays_.forward()) + Spread(eye_rays_.right()) * across +
           Spread(eye_rays_.up()) * up;
  }

  HWY_INLINE SquareBounds BoundsOf(int column, int row, int width, int height) const {
    return {{across_[column], across_[column + width - 1]}, {up_[row], up_[row + height - 1]}};
  }

  // Of what Through gives for the pixels of a rectangle; to be padded by what float rounds.
  HWY_INLINE Bounds DirectionBounds(int column, int row, int width, int height) const {
    const auto of = [](const Vec3d& v, size_t axis) HWY_ATTR { return v[axis]; };
    Bounds bounds;
    for (size_t axis = 0; axis < 3; ++axis) {
      const double right = of(eye_rays_.right(), axis), up = of(eye_rays_.up(), axis);
      const double a = right * across_[column], b = right * across_[column + width - 1];
      const double c = up * up_[row], d = up * up_[row + height - 1];
      const double forward = of(eye_rays_.forward(), axis);
      bounds.low[axis] = static_cast<float>(forward + std::min(a, b) + std::min(c, d));
      bounds.high[axis] = static_cast<float>(forward + std::max(a, b) + std::max(c, d));
    }
    return bounds;
  }

 private:
  const EyeRays& eye_rays_;
  static constexpr int kTiles = kBlockSide / kTileSide;
  alignas(64) double tile_across_[kTiles][kPacketLanes], tile_up_[kTiles][kPacketLanes];
  double across_[kBlockSide], up_[kBlockSide];
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
