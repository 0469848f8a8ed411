// Pixels of several samples on a flat matt face, evaluated once: at their centres, with a proved
// bound on how far that is from the samples' mean.
#if defined(LINETREE_CORE_FRAME_PIXEL_SHEET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_FRAME_PIXEL_SHEET_INL_H_
#undef LINETREE_CORE_FRAME_PIXEL_SHEET_INL_H_
#else
#define LINETREE_CORE_FRAME_PIXEL_SHEET_INL_H_
#endif

#include "core/frame/sheet-inl.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// Where the samples are. With V the ray through the pixel's centre and dV its change to a sample,
// at most half a pixel in either direction, turn = dV.z / V.z, the places on the face differ by
//   d = l / (1 + turn) = l - l turn / (1 + turn),   l = t (dV - turn V), linear in the sample.
// So |d| <= |l| / (1 - |turn|), and as the samples' mean is off the centre by no more than the
// share `mean_off` of half a pixel, |mean d| <= |l| (mean_off + |turn| / (1 - |turn|)).
//
// What light they get. A light that reaches all of a pixel gives the term f = E h s(r) / r, h its
// constant height over the plane, r >= h its distance and s = 2 / (1 + (r / D)^p), or p = 0, its
// fall-off. Of u = ln f, with q = (r / D)^p / (1 + (r / D)^p) in [0, 1], as functions of r:
//   |u'| = (1 + p q) / r <= (1 + p) / r
//   |u''| = |1 - p q (p (1 - q) - 1)| / r^2 <= (1 + p max(1, p / 4)) / r^2
// and so in the plane, where the second derivatives of u lie between u'' and u' / r,
//   |grad f| <= f a / r, a = 1 + p;   |f_ij| <= f k / r^2, k = (1 + p)^2 + 1 + p max(1, p / 4).
// Along a way |d| <= r / (4 a) f grows by e^(1/4) at most. So by Taylor's formula the mean of f
// over the samples differs from f at the centre by no more than the share
//   deviation = a |mean d| / r + 0.65 k |d|^2 / r^2
// of it, r the least distance. Terms are not negative, so for their sum and ambient light the
// largest deviation of all lights holds; light from far away deviates by nothing. A sum of diffuse
// light that is off by `spread` of itself, at the centre, is off the mean M by no more than
//   (spread + deviation) / (1 - deviation) M.
//
// Whether the same lights reach all of it is decided by cells that hold all of the pixel and by
// their shadow functions. Pixels for which all that is not certain are left to others.
class PixelSheet : public Sheet {
 public:
  HWY_INLINE PixelSheet(const PacketScene& scene, const SurfaceCache::Reader& reader,
                        OpenCells& cells)
      : Sheet(scene, reader, cells) {}

  // Evaluates those of a tile's pixels for which that holds, and returns them. `bounds`: of all of
  // the tile's pixels. mean_off: PixelSamples::MeanOff.
  HWY_NOINLINE LaneMask EvaluateOnce(const EyeGrid::PlanePlaces& at, const SquareBounds& bounds,
                                     double mean_off, LaneMask lanes, Floats radiance[3],
                                     LaneUses& uses) {
    if (!FindFoot(bounds, mean_off)) return 0;
    const auto form = [&](size_t k) HWY_ATTR {
      return Doubles::All(f_[k]) + Doubles::All(r_[k]) * at.across + Doubles::All(u_[k]) * at.up;
    };
    const Doubles t = Doubles::All(-e_[2]) / form(2), half = Doubles::All(0.5);
    const auto place = [&](size_t k)
                           HWY_ATTR { return (Doubles::All(e_[k]) + t * form(k)) * half + half; };
    Tile tile(at.across, at.up, t, place(0), place(1));
    alignas(64) double x[kPacketLanes], y[kPacketLanes];
    tile.x.Store(x);
    tile.y.Store(y);
    for (size_t c = 0; c < 3; ++c) radiance[c] = Floats::All(ambient_[c]);
    LaneMask done = 0;
    for (LaneMask left = lanes; left != 0;) {
      const int lane = std::countr_zero(left);
      left &= ~(LaneMask{1} << lane);
      if (!(x[lane] >= 0 && x[lane] <= 1 && y[lane] >= 0 && y[lane] <= 1)) continue;
      OpenCells::Entry& entry = cells_.Find(*tree_, patch_, IndexOf(x[lane]), IndexOf(y[lane]));
      const CellLights* known = entry.node->payload.get();
      LaneMask same = 0;
      const LaneMask inner = PixelsIn(entry, tile, left | LaneMask{1} << lane, same);
      left &= ~same;
      if (known == nullptr || inner == 0) continue;
      const LaneMask sure = AddPixels(entry, *known, tile, inner, radiance, uses);
      cells_.AddUses(entry, sure);
      done |= sure;
    }
    uses.listed = done;
    uses.summed &= done;
    return done;
  }

 private:
  // How far a pixel of the tile reaches from its centre, and the mean of its samples.
  struct Foot {
    double chart[2];  // in [0, 1] over the chart
    double world;
    double mean;
    double deviation;
  };

  // False where the face is seen so flatly that nothing is certain.
  HWY_INLINE bool FindFoot(const SquareBounds& bounds, double mean_off) {
    constexpr double kRounded = 1 + 0x1p-20;
    const double a = kRounded / eye_rays_->width(), b = kRounded / eye_rays_->height();
    double least = Box3::kInf, most[2] = {};
    for (size_t corner = 0; corner < 4; ++corner) {
      const double across = bounds.across[corner % 2], up = bounds.up[corner / 2];
      least = std::min(least, std::abs(V(2, across, up)));
      for (size_t k = 0; k < 2; ++k) most[k] = std::max(most[k], std::abs(V(k, across, up)));
    }
    const double turn = (std::abs(r_[2]) * a + std::abs(u_[2]) * b) / least;
    if (!(turn < 1.0 / 16)) return false;
    const double t = std::abs(e_[2]) / least, stretch = 1 / (1 - turn);
    for (size_t k = 0; k < 2; ++k) {
      const double way = t * (std::abs(r_[k]) * a + std::abs(u_[k]) * b + turn * most[k]);
      foot_.chart[k] = way * stretch / 2 + 2 * off_;
    }
    const double right = Length(eye_rays_->right()), up = Length(eye_rays_->up());
    const double longest = 1 + bounds.FarthestAcross() * right + bounds.FarthestUp() * up;
    const double way = t * (right * a + up * b + turn * longest);
    foot_.world = way * stretch + world_off_;
    foot_.mean = way * (mean_off + turn * stretch) + world_off_;
    FindDeviation(bounds);
    return foot_.deviation < 1.0 / 4;
  }

  // Distances are taken from the middle of the tile, which reaches no farther than to its corners.
  HWY_INLINE void FindDeviation(const SquareBounds& bounds) {
    const Vec3d middle =
        PointAt((bounds.across[0] + bounds.across[1]) / 2, (bounds.up[0] + bounds.up[1]) / 2);
    double radius = 0;
    for (size_t corner = 0; corner < 4; ++corner) {
      const Vec3d point = PointAt(bounds.across[corner % 2], bounds.up[corner / 2]);
      radius = std::max(radius, Length(point - middle));
    }
    foot_.deviation = 0;
    for (const Light& light : scene_.scene().lights) {
      if (light.kind == LightKind::kDirectional) continue;
      const Vec3d way = light.position - middle;
      const double height = linetree::Dot(normal_, way);
      if (height <= -world_off_) continue;  // it lies behind the face
      const double r = std::max(height - world_off_, Length(way) - radius - 2 * world_off_);
      const double power = light.fade_distance > 0 ? light.fade_power : 0;
      const double slope = 1 + power;
      const double curve = slope * slope + 1 + power * std::max(1.0, power / 4);
      if (!(4 * slope * foot_.world <= r)) {
        foot_.deviation = Box3::kInf;
        return;
      }
      const double share = foot_.world / r;
      foot_.deviation =
          std::max(foot_.deviation, slope * foot_.mean / r + 0.65 * curve * share * share);
    }
  }

  HWY_INLINE Vec3d PointAt(double across, double up) const {
    const Vec3d through = eye_rays_->forward() + eye_rays_->right() * across + eye_rays_->up() * up;
    return eye_rays_->eye() + through * (-e_[2] / V(2, across, up));
  }

  // Of `lanes`, those whose pixels lie in the cell; `same`: those whose centres do.
  HWY_INLINE LaneMask PixelsIn(const OpenCells::Entry& entry, const Tile& tile, LaneMask lanes,
                               LaneMask& same) const {
    const double scale = static_cast<double>(1u << (kMaxSurfaceDepth - entry.shift));
    const auto within = [&](const Doubles& x, int32_t cell, double margin) HWY_ATTR {
      const Doubles in = x * Doubles::All(scale) - Doubles::All(cell);
      return (in >= Doubles::All(margin)) & (in <= Doubles::All(1 - margin));
    };
    same = BitsOf(within(tile.x, entry.i, 0) & within(tile.y, entry.j, 0)) & lanes;
    if (off_ * scale > kMostOff) return 0;
    return same & BitsOf(within(tile.x, entry.i, foot_.chart[0] * scale) &
                         within(tile.y, entry.j, foot_.chart[1] * scale));
  }

  // Adds the light in those of the lanes, which lie in the cell, whose pixels it knows all about,
  // and returns them.
  HWY_INLINE LaneMask AddPixels(const OpenCells::Entry& entry, const CellLights& known, Tile& tile,
                                LaneMask lanes, Floats radiance[3], LaneUses& uses) const {
    const double allowed = reader_.epsilon() * (1 - foot_.deviation) - foot_.deviation;
    if (!(allowed >= 0)) return 0;
    if (!known.contacts.empty()) lanes &= ClearPixels(known, tile);
    const double scale = static_cast<double>(1u << (kMaxSurfaceDepth - entry.shift));
    const auto local = [&](const Doubles& of, int32_t cell) HWY_ATTR {
      return Demoted(of * Doubles::All(scale) - Doubles::All(cell));
    };
    const Floats s = local(tile.x, entry.i), t = local(tile.y, entry.j);
    const auto reach = [&](size_t k) { return static_cast<float>(foot_.chart[k] * scale * 1.001); };
    uint32_t tasks = known.rest_of_tasks;
    if (known.CountSummed() > 0) {
      const DiffuseSum* sum = known.sums[side_].get();
      if (sum != nullptr && sum->spread <= allowed) {
        AddSum(*sum, s, t, lanes, radiance);
        uses.summed |= lanes;
      } else {
        tasks = static_cast<uint32_t>(known.tasks.size());
      }
    }
    for (uint32_t i = 0; i < tasks && lanes != 0; ++i) {
      const LightTask& task = known.tasks[i];
      LaneMask lit = lanes;
      if (task.kind == LightTask::Kind::kUnknown) return 0;
      if (task.kind == LightTask::Kind::kListed) {
        lanes &= FindLitPixels(known, task, s, t, reach(0), reach(1), lit);
        lit &= lanes;
      }
      if (lit != 0 && !AddLight(task.light, tile, lit, radiance)) return 0;
    }
    return lanes;
  }

  // Lanes whose pixels are in front of the walls that the cell touches.
  HWY_NOINLINE LaneMask ClearPixels(const CellLights& known, Tile& tile) const {
    NeedPoint(tile);
    LaneMask clear = kAllLanes;
    for (const Contact& contact : known.contacts) {
      const Doubles height =
          Dot(tile.point - Spread(contact.plane.point), Spread(contact.plane.normal));
      clear &= BitsOf(height > Doubles::All(contact.clearance + world_off_ + foot_.world));
    }
    return clear;
  }

  // Leaves those lanes in `lit` that the light reaches all over their pixels, and returns those of
  // which it is known whether it reaches all or nothing.
  static HWY_INLINE LaneMask FindLitPixels(const CellLights& known, const LightTask& task,
                                           const Floats& s, const Floats& t, float ds, float dt,
                                           LaneMask& lit) {
    if (known.functions.empty()) return 0;
    LaneMask blocked = 0, doubt = 0;
    for (uint32_t i = task.first; i < task.first + task.count; ++i) {
      const LaneShadowing at =
          ShadowingAround(known.functions[i], known.coefficients.data(), s, t, ds, dt);
      blocked |= BitsOf(at.blocks);
      doubt |= ~BitsOf(at.misses);
    }
    lit &= ~blocked;
    return kAllLanes & (blocked | ~doubt);
  }

  Foot foot_;
};

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
