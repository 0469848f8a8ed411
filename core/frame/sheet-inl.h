// Tiles of pixels that see a flat matt face whose light is known: no hit is computed, for the
// face's chart is a projective map of the image.
#if defined(LINETREE_CORE_FRAME_SHEET_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_FRAME_SHEET_INL_H_
#undef LINETREE_CORE_FRAME_SHEET_INL_H_
#else
#define LINETREE_CORE_FRAME_SHEET_INL_H_
#endif

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/frame/open_cells-inl.h"
#include "core/frame/shadows-inl.h"
#include "core/frame/sums-inl.h"
#include "core/packet/follow-inl.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// Pixels of a block on one face, one ray each (PixelSheet: several). In the face's chart (the rows
// of its FaceForm; the centre is 0 and the face z = 0) the ray through the pixel (a, b) is E + t V,
// V = F + a R + b U; it meets the face at t = -E.z / V.z.
//
// With n = 2^-53, V is off by 8 n |row| (1 + |a R| + |b U|), row by row, E by 8 n |row| (|eye| +
// reach), for the tracer may measure from any point of the object, and with them t and the place.
// The classical tracer's own place is as far off. Cells know what they say up to the chart's
// tolerance around them, and the places in a cell may be off by kMostOff of its side (the sums'
// kNodeRounding allows for it). Blocks and cells for which that is not certain are left to others.
class Sheet {
 public:
  static constexpr double kMostOff = 0x1p-26;

  HWY_INLINE Sheet(const PacketScene& scene, const SurfaceCache::Reader& reader, OpenCells& cells)
      : scene_(scene), reader_(reader), cells_(cells) {}

  // Whether the block's pixels that see the face may be a sheet.
  HWY_NOINLINE bool Open(const SurfaceTree& tree, const VisibleFace& face, const EyeRays& eye_rays,
                         const SquareBounds& block) {
    const FaceForm& form = tree.FormOf(face.face());
    // Flat triangles whose normals turn lie on a plane, too.
    if (!scene_.IsFlat(face.object, face.face()) || face.IsInside()) return false;
    const auto material =
        static_cast<size_t>(scene_.material_of()[static_cast<size_t>(face.object)]);
    const PacketMaterials& table = scene_.materials();
    if (table.spawns[material] != 0 || table.shines[material] != 0) return false;
    for (size_t c = 0; c < 3; ++c) {
      ambient_[c] = table.ambient[c][material];
      diffuse_[c] = table.diffuse[c][material];
    }
    tree_ = &tree;
    patch_ = form.patch;
    eye_rays_ = &eye_rays;
    across_square_ = static_cast<float>(linetree::Dot(eye_rays.right(), eye_rays.right()));
    up_square_ = static_cast<float>(linetree::Dot(eye_rays.up(), eye_rays.up()));
    for (size_t k = 0; k < 3; ++k) {
      e_[k] = linetree::Dot(form.row[k], eye_rays.eye() - form.center);
      f_[k] = linetree::Dot(form.row[k], eye_rays.forward());
      r_[k] = linetree::Dot(form.row[k], eye_rays.right());
      u_[k] = linetree::Dot(form.row[k], eye_rays.up());
    }
    side_ = e_[2] > 0 ? 0 : 1;
    center_ = form.center;
    normal_ = side_ == 0 ? form.row[2] : -form.row[2];
    // Of which the slack is a multiple.
    reach_ = tree.chart().Slack() / kSurfaceSlack;
    return (side_ == 0 || tree.chart().IsThin()) && BoundErrors(form, eye_rays, block);
  }

  // The light of a tile and how far away it is; false when that takes more than cells know.
  HWY_NOINLINE bool Evaluate(const Doubles& across, const Doubles& up, LaneMask lanes,
                             Floats radiance[3], Floats& depth, LaneUses& uses) {
    const auto form = [&](size_t k) HWY_ATTR {
      return Doubles::All(f_[k]) + Doubles::All(r_[k]) * across + Doubles::All(u_[k]) * up;
    };
    const Doubles t = Doubles::All(-e_[2]) / form(2), half = Doubles::All(0.5);
    const auto place = [&](size_t k)
                           HWY_ATTR { return (Doubles::All(e_[k]) + t * form(k)) * half + half; };
    Tile tile(across, up, t, place(0), place(1));
    alignas(64) double x[kPacketLanes], y[kPacketLanes];
    tile.x.Store(x);
    tile.y.Store(y);
    for (size_t c = 0; c < 3; ++c) radiance[c] = Floats::All(ambient_[c]);
    for (LaneMask left = lanes; left != 0;) {
      const int lane = std::countr_zero(left);
      if (!(x[lane] >= 0 && x[lane] <= 1 && y[lane] >= 0 && y[lane] <= 1)) return false;
      OpenCells::Entry& entry = cells_.Find(*tree_, patch_, IndexOf(x[lane]), IndexOf(y[lane]));
      const CellLights* known = entry.node->payload.get();
      if (known == nullptr) return false;
      const LaneMask same = AddCell(entry, *known, tile, left, radiance, uses);
      if ((same >> lane & 1) == 0) return false;
      left &= ~same;
      cells_.AddUses(entry, same);
    }
    depth = DepthOf(across, up, t);
    uses.listed = lanes;
    return true;
  }

  // Along the rays through these places.
  HWY_INLINE Floats DepthAt(const Doubles& across, const Doubles& up) const {
    const Doubles z = Doubles::All(f_[2]) + Doubles::All(r_[2]) * across + Doubles::All(u_[2]) * up;
    return DepthOf(across, up, Doubles::All(-e_[2]) / z);
  }

 protected:
  static constexpr double kUnit = 0x1p-53;

  struct Tile {
    const Doubles &across, &up, &t;
    Doubles x, y;       // in [0, 1] over the chart
    WideVectors point;  // see NeedPoint
    bool has_point = false;

    HWY_INLINE Tile(const Doubles& across_of, const Doubles& up_of, const Doubles& t_of,
                    const Doubles& x_of, const Doubles& y_of)
        : across(across_of), up(up_of), t(t_of), x(x_of), y(y_of) {}
  };

  HWY_INLINE Floats DepthOf(const Doubles& across, const Doubles& up, const Doubles& t) const {
    const Floats a = Demoted(across), b = Demoted(up);
    const Floats square = MulAdd(a * a, Floats::All(across_square_),
                                 MulAdd(b * b, Floats::All(up_square_), Floats::All(1)));
    return Demoted(t) * Sqrt(square);
  }

  HWY_INLINE double V(size_t k, double across, double up) const {
    return f_[k] + across * r_[k] + up * u_[k];
  }

  HWY_INLINE bool BoundErrors(const FaceForm& form, const EyeRays& eye_rays,
                              const SquareBounds& block) {
    const double reach = Length(eye_rays.eye()) + reach_;
    const double width = 1 + block.FarthestAcross() * Length(eye_rays.right()) +
                         block.FarthestUp() * Length(eye_rays.up());
    const auto v_off = [&](size_t k) { return 8 * kUnit * Length(form.row[k]) * width; };
    const auto e_off = [&](size_t k) { return 8 * kUnit * Length(form.row[k]) * reach; };
    // V is linear: its extremes are at the corners.
    double least = Box3::kInf, most[2] = {};
    for (size_t corner = 0; corner < 4; ++corner) {
      const double a = block.across[corner % 2], b = block.up[corner / 2];
      if (!(V(2, a, b) * e_[2] < 0)) return false;
      least = std::min(least, std::abs(V(2, a, b)));
      for (size_t k = 0; k < 2; ++k) most[k] = std::max(most[k], std::abs(V(k, a, b)));
    }
    const double t = std::abs(e_[2]) / least;
    const double t_off = t * (v_off(2) / least + 2 * kUnit) + e_off(2) / least;
    off_ = 0;
    for (size_t k = 0; k < 2; ++k) {
      const double off = e_off(k) + t * v_off(k) + most[k] * t_off +
                         4 * kUnit * (std::abs(e_[k]) + t * most[k] + 1);
      if (!(2 * off <= form.tolerance * Length(form.row[k]))) return false;
      off_ = std::max(off_, off);  // twice, and half of [-1, 1]
    }
    world_off_ = 2 * (width * (t_off + 8 * kUnit * t) + 8 * kUnit * reach);
    return true;
  }

  static HWY_INLINE int32_t IndexOf(double x) {
    constexpr double kCells = 1 << kMaxSurfaceDepth;
    return static_cast<int32_t>(std::min(x * kCells, kCells - 1));
  }

  // Adds the light in those of `left` that lie in the cell, and returns them; none when the cell
  // does not know enough.
  HWY_INLINE LaneMask AddCell(const OpenCells::Entry& entry, const CellLights& known, Tile& tile,
                              LaneMask left, Floats radiance[3], LaneUses& uses) const {
    const double scale = static_cast<double>(1u << (kMaxSurfaceDepth - entry.shift));
    if (off_ * scale > kMostOff) return 0;
    const auto local = [&](const Doubles& of, int32_t cell)
                           HWY_ATTR { return of * Doubles::All(scale) - Doubles::All(cell); };
    const Doubles s = local(tile.x, entry.i), t = local(tile.y, entry.j);
    const Doubles zero = Doubles::All(0), one = Doubles::All(1);
    const LaneMask lanes = BitsOf((s >= zero) & (s <= one) & (t >= zero) & (t <= one)) & left;
    if (!known.contacts.empty() && !IsClear(known, tile, lanes)) return 0;
    const Floats s_in = Demoted(s), t_in = Demoted(t);
    uint32_t tasks = known.rest_of_tasks;
    if (known.CountSummed() > 0) {
      const DiffuseSum* sum = known.sums[side_].get();
      if (sum != nullptr && sum->spread <= reader_.epsilon()) {
        AddSum(*sum, s_in, t_in, lanes, radiance);
        uses.summed |= lanes;
      } else {
        tasks = static_cast<uint32_t>(known.tasks.size());
      }
    }
    for (uint32_t i = 0; i < tasks; ++i) {
      const LightTask& task = known.tasks[i];
      LaneMask lit = lanes;
      if (task.kind == LightTask::Kind::kUnknown) return 0;
      if (task.kind == LightTask::Kind::kListed && !FindLit(known, task, s_in, t_in, lit)) return 0;
      if (lit != 0 && !AddLight(task.light, tile, lit, radiance)) return 0;
    }
    return lanes;
  }

  HWY_INLINE void AddSum(const DiffuseSum& sum, const Floats& s, const Floats& t, LaneMask lanes,
                         Floats radiance[3]) const {
    Floats light[3];
    SumAt(sum, s, t, light);
    const Mask which = MaskOf(lanes);
    for (size_t c = 0; c < 3; ++c) {
      const Floats total = MulAdd(light[c], Floats::All(diffuse_[c]), radiance[c]);
      radiance[c] = Select(which, total, radiance[c]);
    }
  }

  HWY_INLINE void NeedPoint(Tile& tile) const {
    if (tile.has_point) return;
    tile.has_point = true;
    const WideVectors through = Spread(eye_rays_->forward()) +
                                Spread(eye_rays_->right()) * tile.across +
                                Spread(eye_rays_->up()) * tile.up;
    tile.point = Spread(eye_rays_->eye()) + through * tile.t;
  }

  // Whether all these lanes are in front of the walls that the cell touches.
  HWY_NOINLINE bool IsClear(const CellLights& known, Tile& tile, LaneMask lanes) const {
    NeedPoint(tile);
    for (const Contact& contact : known.contacts) {
      const Doubles height =
          Dot(tile.point - Spread(contact.plane.point), Spread(contact.plane.normal));
      if ((lanes & ~BitsOf(height > Doubles::All(contact.clearance + world_off_))) != 0) {
        return false;
      }
    }
    return true;
  }

  // Leaves those of the lanes that the light reaches, as its shadow functions know; false when they
  // do not.
  static HWY_INLINE bool FindLit(const CellLights& known, const LightTask& task, const Floats& s,
                                 const Floats& t, LaneMask& lit) {
    if (known.functions.empty()) return false;
    LaneMask doubt = 0;
    for (uint32_t i = task.first; i < task.first + task.count && lit != 0; ++i) {
      const LaneShadowing at = ShadowingOf(known.functions[i], known.coefficients.data(), s, t);
      lit &= ~BitsOf(at.blocks);
      doubt |= ~BitsOf(at.misses);
    }
    return (lit & doubt) == 0;
  }

  // The diffuse light of one that reaches these lanes. On a plane n.(L - x) is one number h, so the
  // cosine is h / |L - x|; false where h or the distance would be off by more than 2^-24.
  HWY_NOINLINE bool AddLight(size_t index, Tile& tile, LaneMask lit, Floats radiance[3]) const {
    const Light& from = scene_.scene().lights[index];
    const PacketLight& light = scene_.lights()[index];
    const Mask which = MaskOf(lit);
    Floats cosine;
    if (light.directional) {
      const double height = linetree::Dot(normal_, from.to_light);
      if (!(std::abs(height) > 0x1p-24)) return false;
      if (height < 0) return true;
      cosine = Floats::All(static_cast<float>(height));
    } else {
      const Vec3d way = from.position - center_;
      const double height = linetree::Dot(normal_, way);
      const double off = 4 * kUnit * (Length(from.position) + reach_) + world_off_;
      if (!(std::abs(height) > 0x1p24 * off)) return false;
      if (height < 0) return true;
      NeedPoint(tile);
      const Vectors segment = Demoted(Spread(from.position) - tile.point);
      const Floats square = Dot(segment, segment);
      const LaneMask fits = BitsOf((square > Floats::All(1e-30f)) & (square < Floats::All(1e30f)));
      if ((lit & ~fits) != 0) return false;
      const Floats inverse = InverseSqrt(square);
      cosine = Floats::All(static_cast<float>(height)) * inverse;
      if (light.inverse_fade_distance > 0) cosine = cosine * StrengthAt(light, square * inverse);
    }
    for (size_t c = 0; c < 3; ++c) {
      const Floats term = cosine * Floats::All(light.irradiance[c] * diffuse_[c]);
      radiance[c] = Select(which, radiance[c] + term, radiance[c]);
    }
    return true;
  }

  const PacketScene& scene_;
  const SurfaceCache::Reader& reader_;
  OpenCells& cells_;
  const SurfaceTree* tree_ = nullptr;
  int patch_ = 0;
  size_t side_ = 0;  // see CellLights::sums
  float ambient_[3], diffuse_[3];
  Vec3d center_, normal_;  // that points to the eye
  double e_[3], f_[3], r_[3], u_[3];
  const EyeRays* eye_rays_ = nullptr;
  double off_ = 0;        // of places, in [0, 1] over the chart
  double world_off_ = 0;  // of points
  double reach_ = 0;      // of the object: see SurfaceChart::Slack
  float across_square_ = 0, up_square_ = 0;
};

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
