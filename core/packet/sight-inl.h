// What a square of pixels sees, where that is one face and nothing else: then none of its eye rays
// is searched for.
//
// Solids are convex. Of the rays through a square's pixels each lies between those through its
// corners, so a face that the corners' rays meet (for certain: with the margins of the search) is
// met by all of them, provided that the rays from the eye that enter the solid through this face
// fill a convex cone: flat faces, balls, and walls of frusta whose caps are not seen. No ray goes
// farther, in units of the ray through its pixel of depth one, than the corners' farthest.
// What else is in the scene lies beyond that, beside the square's pyramid, or behind the face's
// plane, box by box; otherwise the square is not decided.
#if defined(LINETREE_CORE_PACKET_SIGHT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_SIGHT_INL_H_
#undef LINETREE_CORE_PACKET_SIGHT_INL_H_
#else
#define LINETREE_CORE_PACKET_SIGHT_INL_H_
#endif

#include <optional>

#include "core/packet/eye_grid-inl.h"
#include "core/packet/hits-inl.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// What all rays of a square meet first: a face, or nothing at all.
struct VisibleFace {
  int32_t object = kNoObject;
  int32_t code = 0;  // see Nearest

  HWY_INLINE bool IsInside() const { return (code & Nearest::kInside) != 0; }
  HWY_INLINE int face() const { return code >> Nearest::kFaceShift; }
};

// What all rays of a packet meet, if that is one face for certain.
HWY_INLINE std::optional<VisibleFace> FaceOf(const HitSearch& search, LaneMask active) {
  if (search.again != 0 || search.exits.lanes != 0 || active == 0) return std::nullopt;
  const int first = std::countr_zero(active);
  alignas(64) int32_t objects[kPacketLanes], codes[kPacketLanes];
  search.nearest.object().Store(objects);
  search.nearest.code().Store(codes);
  const LaneMask same = BitsOf(OfFloats((search.nearest.object() == Ints::All(objects[first])) &
                                        (search.nearest.code() == Ints::All(codes[first]))));
  if ((active & ~same) != 0) return std::nullopt;
  return VisibleFace{objects[first], codes[first]};
}

// What is known of a square.
struct Sight {
  std::optional<VisibleFace> face;
  uint32_t quadrants = 0;  // those worth a look of their own: bit column + 2 * row
};

// As FindHitsOf, of rays that all meet this face first.
inline HWY_NOINLINE void SetHitsOn(const PacketScene& scene, const PacketRays& rays,
                                   const VisibleFace& face, PacketHits& hits,
                                   PacketCounts& counts) {
  hits.hit = hits.inside = hits.first_on_line = 0;
  Ints::All(face.object).Store(hits.object);
  if (face.object == kNoObject) return;
  Ints::All(face.face()).Store(hits.face);
  const FinishedHit hit = Finish(scene, face.object, face.face(), face.IsInside(),
                                 Load(rays.origin), Load(rays.direction), nullptr, WideMask());
  hit.t.Store(hits.t);
  Store(hit.point, hits.point);
  Store(hit.normal, hits.normal);
  hits.hit = rays.active;
  if (face.IsInside()) hits.inside = rays.active;
  if ((face.code & Nearest::kFirst) != 0) hits.first_on_line = rays.active;
  const LaneMask bad = rays.active & ~BitsOf(hit.good);
  if (bad != 0) FindAgain(scene, rays, bad, hits, counts);
}

class Sighter {
 public:
  HWY_INLINE Sighter(const PacketScene& scene, const EyeRays& eye_rays, const EyeGrid& grid)
      : scene_(scene), eye_rays_(eye_rays), grid_(grid) {
    const Vec3d eye = eye_rays.eye() - scene.reference();
    for (int i = 0; i < 3; ++i) {
      eye_.low[i] = eye_.high[i] = static_cast<float>(eye[static_cast<size_t>(i)]);
    }
    size_ = SizeOf(eye_) + scene.least_length();
  }

  // Of the pixels [column, column + width) x [row, row + height) of the block.
  HWY_NOINLINE Sight Look(int column, int row, int width, int height) const {
    Sight sight;
    if (!(size_ < PacketScene::kMostOfFloat)) return sight;
    const Samples samples = SamplesOf(column, row, width, height);
    const Nearest nearest = NearestOf(samples);
    const LaneMask open = BitsOf(nearest.Open());
    alignas(64) int32_t objects[kPacketLanes], codes[kPacketLanes];
    nearest.object().Store(objects);
    nearest.code().Store(codes);
    const LaneMask same = BitsOf(OfFloats((nearest.object() == Ints::All(objects[0])) &
                                          (nearest.code() == Ints::All(codes[0])))) &
                          ~open;
    if (same != kAllLanes) {
      sight.quadrants = AlikeQuadrants(objects, codes, open);
      return sight;
    }
    const VisibleFace face = {objects[0], codes[0]};
    const Bounds directions = grid_.DirectionBounds(column, row, width, height);
    const Shaft shaft(eye_, directions, kShaftPad * size_, kShaftPad * SizeOf(directions),
                      kFarAway);
    if (face.object == kNoObject) {
      if (IsClear(shaft, kFarAway, kNoObject, nullptr)) sight.face = face;
    } else if (FillsCone(face)) {
      // Of unit rays, to multiples of the rays through the pixels: 8 u for the quotient.
      const float last = Largest(nearest.high() * samples.inverse_length) * (1 + 8 * kFloatUnit);
      const std::optional<Behind> behind = BehindOf(face, samples, nearest);
      if (IsClear(shaft, last, face.object, behind ? &*behind : nullptr)) sight.face = face;
    }
    if (!sight.face) sight.quadrants = 0xf;
    return sight;
  }

 private:
  // Sixteen pixels of the square, its corners among them.
  struct Samples {
    FloatRays rays;
    Floats inverse_length;  // of the ray through the pixel of depth one
  };
  // The half space that a flat face hides: normal . x < offset.
  struct Behind {
    float normal[3];
    float offset;
  };

  HWY_INLINE Samples SamplesOf(int column, int row, int width, int height) const {
    int columns[4], rows[4];
    for (int i = 0; i < 4; ++i) {
      columns[i] = column + (width - 1) * i / 3;
      rows[i] = row + (height - 1) * i / 3;
    }
    const WideVectors through = grid_.Through(columns, rows);
    const Doubles inverse = Doubles::All(1) / Sqrt(Dot(through, through));
    Samples samples;
    samples.rays.o = Spread(eye_.low);
    samples.rays.d = Demoted(through * inverse);
    samples.rays.size = size_;
    samples.inverse_length = Demoted(inverse);
    return samples;
  }

  HWY_INLINE Nearest NearestOf(const Samples& samples) const {
    FloatRays rays = samples.rays;
    const Bounds directions = BoundsOf(rays.d);
    const Shaft shaft(eye_, directions, kShaftPad * size_, kShaftPad, kFarAway);
    Nearest nearest;
    FindNearest(scene_, rays, Ints::All(kNoObject), MaskOf(kAllLanes), shaft, nearest);
    return nearest;
  }

  static HWY_INLINE uint32_t AlikeQuadrants(const int32_t* objects, const int32_t* codes,
                                            LaneMask open) {
    uint32_t alike = 0;
    for (int q = 0; q < 4; ++q) {
      const int first = q % 2 * 2 + q / 2 * 8;
      bool same = true;
      for (const int lane : {first, first + 1, first + 4, first + 5}) {
        same = same && objects[lane] == objects[first] && codes[lane] == codes[first] &&
               (open >> lane & 1) == 0;
      }
      if (same) alike |= uint32_t{1} << q;
    }
    return alike;
  }

  // Whether rays from the eye that meet the solid first through this face fill a convex cone.
  HWY_INLINE bool FillsCone(const VisibleFace& face) const {
    const Shape& shape = scene_.scene().objects[static_cast<size_t>(face.object)].shape;
    if (std::holds_alternative<SphereShape>(shape)) return !face.IsInside();
    const auto* frustum = std::get_if<FrustumShape>(&shape);
    if (frustum == nullptr || face.face() != kLateralFace) return true;
    if (frustum->open || face.IsInside()) return false;
    const Vec3d from = eye_rays_.eye() - frustum->frame.center;
    const double z = linetree::Dot(frustum->frame.object_from_world.row[2], from);
    return z > 0x1p-20 && z < 1 - 0x1p-20;
  }

  HWY_INLINE std::optional<Behind> BehindOf(const VisibleFace& face, const Samples& samples,
                                            const Nearest& nearest) const {
    const Shape& shape = scene_.scene().objects[static_cast<size_t>(face.object)].shape;
    const bool is_frustum = std::holds_alternative<FrustumShape>(shape);
    if (std::holds_alternative<SphereShape>(shape) || (is_frustum && face.face() == kLateralFace)) {
      return std::nullopt;
    }
    // Through a point of it that is off by kPlaneMargin (R + t) along the ray times the slope.
    const Vectors& d = samples.rays.d;
    const Floats& t = nearest.high();
    alignas(64) float point[3][kPacketLanes];
    MulAdd(t, d.x, samples.rays.o.x).Store(point[0]);
    MulAdd(t, d.y, samples.rays.o.y).Store(point[1]);
    MulAdd(t, d.z, samples.rays.o.z).Store(point[2]);
    const float reach = scene_.shapes()[static_cast<size_t>(face.object)].reach;
    const float pad = 4 * kPlaneMargin * (size_ + scene_.reach() + reach);
    Vec3d normal = NormalOf(shape, face);
    const Vec3d eye = eye_rays_.eye() - scene_.reference();
    const Vec3d on = {point[0][0], point[1][0], point[2][0]};
    if (linetree::Dot(normal, eye - on) < 0) normal = -normal;
    Behind behind;
    for (size_t i = 0; i < 3; ++i) behind.normal[i] = static_cast<float>(normal[i]);
    behind.offset = static_cast<float>(linetree::Dot(normal, on)) - pad;
    return behind;
  }

  HWY_INLINE Vec3d NormalOf(const Shape& shape, const VisibleFace& face) const {
    const auto* triangle = std::get_if<TriangleShape>(&shape);
    return triangle != nullptr ? triangle->polygon.plane.normal
                               : scene_.FlatNormal(face.object, face.face());
  }

  // Whether no box but the object's own reaches into the part of the shaft that is not farther than
  // `last` and not behind.
  HWY_INLINE bool IsClear(const Shaft& shaft, float last, int32_t object,
                          const Behind* behind) const {
    int32_t stack[kStackSize];
    int size = 0;
    stack[size++] = 0;
    while (size > 0) {
      const PacketNode& node = scene_.nodes()[static_cast<size_t>(stack[--size])];
      Floats entry;
      LaneMask met = shaft.Meets(node, Floats::All(last), entry);
      if (met != 0 && behind != nullptr) met &= ~LiesBehind(node, *behind);
      for (; met != 0; met &= met - 1) {
        const int32_t child = node.child[std::countr_zero(met)];
        if (child >= 0) {
          stack[size++] = child;
        } else if (scene_.shapes()[static_cast<size_t>(~child)].object != object) {
          return false;
        }
      }
    }
    return true;
  }

  static HWY_INLINE LaneMask LiesBehind(const PacketNode& node, const Behind& behind) {
    Floats most = Floats::All(0);
    for (int i = 0; i < 3; ++i) {
      const float n = behind.normal[i];
      most = MulAdd(Floats::Load(n > 0 ? node.high[i] : node.low[i]), Floats::All(n), most);
    }
    return BitsOf(most < Floats::All(behind.offset));
  }

  const PacketScene& scene_;
  const EyeRays& eye_rays_;
  const EyeGrid& grid_;
  Bounds eye_;
  float size_;
};

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
