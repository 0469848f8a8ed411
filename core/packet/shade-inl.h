// What lights add at the hits of a packet: which way they lie, in double; how much, in float.
#if defined(LINETREE_CORE_PACKET_SHADE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_SHADE_INL_H_
#undef LINETREE_CORE_PACKET_SHADE_INL_H_
#else
#define LINETREE_CORE_PACKET_SHADE_INL_H_
#endif

#include <bit>

#include "core/packet/power-inl.h"
#include "core/packet/search-inl.h"
#include "core/trace/shade.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// The hits of a packet as origins of shadow rays.
struct HitPoints {
  WideVectors point, normal;
  // What only those need who search.
  mutable Vectors from;  // relative to the reference
  mutable Bounds bounds;
  mutable float size = 0;  // as FloatRays::size
  mutable bool has_bounds = false;
  Ints object;
  LaneMask hit = 0;
};

// Lanes without a hit take the place of the first one with, so that they stretch no bounds.
HWY_INLINE Floats Filled(const Floats& v, LaneMask lanes) {
  if (lanes == kAllLanes || lanes == 0) return v;
  alignas(64) float values[kPacketLanes];
  v.Store(values);
  return Select(MaskOf(lanes), v, Floats::All(values[std::countr_zero(lanes)]));
}
HWY_INLINE Vectors Filled(const Vectors& v, LaneMask lanes) {
  return {Filled(v.x, lanes), Filled(v.y, lanes), Filled(v.z, lanes)};
}

inline HWY_NOINLINE void NeedBounds(const PacketScene& scene, const HitPoints& at) {
  if (at.has_bounds) return;
  at.has_bounds = true;
  at.from = Filled(Demoted(at.point - Spread(scene.reference())), at.hit);
  at.bounds = BoundsOf(at.from);
  at.size = SizeOf(at.bounds) + scene.least_length();
}

HWY_INLINE HitPoints PointsOf(const PacketHits& hits) {
  HitPoints at;
  at.point = Load(hits.point);
  at.normal = Load(hits.normal);
  at.object = Ints::Load(hits.object);
  at.hit = hits.hit;
  return at;
}

// A light as seen from the hits of a packet.
struct LaneLight {
  Vectors to_light;  // unit
  Floats cosine;     // n.l, with a relative error
  Floats distance;
  LaneMask facing = 0;
  LaneMask odd = 0;  // at a distance that float cannot tell
};

// 1 / sqrt(x), off by less than 8 u: one step of Newton's method from 11 bits.
HWY_INLINE Floats InverseSqrt(const Floats& x) {
  const Floats y = NearInverseSqrt(x);
  const Floats half = x * Floats::All(0.5f);
  return y * NegMulAdd(half * y, y, Floats::All(1.5f));
}

HWY_INLINE bool FacesScalar(const Light& light, const PacketHits& hits, int lane) {
  return Dot(hits.normal.At(lane), ViewOf(light, hits.point.At(lane)).to_light) > 0;
}

inline HWY_NOINLINE LaneLight LightAt(const PacketScene& scene, size_t index,
                                      const PacketHits& hits, const HitPoints& at, LaneMask lanes,
                                      uint64_t& again) {
  const Light& light = scene.scene().lights[index];
  LaneLight seen;
  if (light.kind == LightKind::kDirectional) {
    const WideVectors to_light = Spread(light.to_light);
    const Doubles cosine = Dot(at.normal, to_light);
    seen.to_light = Demoted(to_light);
    seen.cosine = Demoted(cosine);
    seen.distance = Floats::All(kFarAway);
    seen.facing = BitsOf(cosine > Doubles::All(0)) & lanes;
    return seen;
  }
  const WideVectors segment = Spread(light.position) - at.point;
  const Vectors way = Demoted(segment);
  const Floats square = Dot(way, way);
  const Floats inverse = InverseSqrt(square);
  seen.to_light = way * inverse;
  seen.distance = square * inverse;
  seen.cosine = Demoted(Dot(at.normal, segment)) * inverse;
  const Mask fits = (square > Floats::All(1e-30f)) & (square < Floats::All(1e30f));
  seen.odd = lanes & ~BitsOf(fits);
  seen.facing = BitsOf(seen.cosine > Floats::All(0)) & lanes;
  const LaneMask sure = BitsOf(Abs(seen.cosine) > Floats::All(kSureCosine)) & ~seen.odd;
  for (LaneMask left = lanes & ~sure; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    const LaneMask bit = LaneMask{1} << lane;
    seen.facing = FacesScalar(light, hits, lane) ? seen.facing | bit : seen.facing & ~bit;
    // So near the horizon the cosine's relative error is not small in double either.
    seen.odd |= bit;
    ++again;
  }
  return seen;
}

HWY_INLINE Shaft ShaftTo(const PacketScene& scene, const Light& light, const HitPoints& at) {
  if (light.kind == LightKind::kDirectional) {
    Bounds along;
    for (int i = 0; i < 3; ++i) {
      along.low[i] = along.high[i] = static_cast<float>(light.to_light[i]);
    }
    return {at.bounds, along, kShaftPad * at.size, kShaftPad, kFarAway};
  }
  // From the light to the points: one origin.
  Bounds origin, way;
  for (int i = 0; i < 3; ++i) {
    const auto x = static_cast<float>(light.position[i] - scene.reference()[i]);
    origin.low[i] = origin.high[i] = x;
    way.low[i] = at.bounds.low[i] - x;
    way.high[i] = at.bounds.high[i] - x;
  }
  const float pad = kShaftPad * (at.size + SizeOf(origin));
  return {origin, way, pad, pad, 1};
}

HWY_INLINE void SetShadow(int lane, const Tracer::Shadow& cast, PacketShadow& shadow) {
  if (cast.term.state != LightState::kLit) return;
  const LaneMask bit = LaneMask{1} << lane;
  shadow.lit |= bit;
  if (cast.term.crossings == 0) return;
  shadow.filtered |= bit;
  for (int c = 0; c < 3; ++c) shadow.filter[c][lane] = static_cast<float>(cast.filter[c]);
}

inline HWY_NOINLINE void CastAgain(const Tracer& tracer, const PacketHits& hits, int light,
                                   LaneMask lanes, PacketShadow& shadow) {
  for (LaneMask left = lanes; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    const LaneMask bit = LaneMask{1} << lane;
    const RayStart start{hits.object[lane], hits.face[lane],
                         (hits.inside & bit) != 0 ? Side::kInside : Side::kOutside};
    SetShadow(lane, tracer.CastShadow(hits.point.At(lane), light, start), shadow);
  }
}

// Rays that leave into a closed solid leave it again, before the light where that lies outside. The
// lanes of `lanes` for which this is not certain.
HWY_INLINE LaneMask AddOwnExits(const PacketScene& scene, const PacketHits& hits,
                                const Light& light, LaneMask lanes, Between& between) {
  LaneMask open = 0;
  for (LaneMask left = lanes; left != 0;) {
    const int32_t object = hits.object[std::countr_zero(left)];
    const LaneMask same = BitsOf(Ints::Load(hits.object) == Ints::All(object)) & left;
    left &= ~same;
    const Object& own = scene.scene().objects[static_cast<size_t>(object)];
    const bool outside = light.kind == LightKind::kDirectional || IsClearOf(own, light.position);
    if (!IsSolid(own.shape) || !outside) {
      open |= same;
    } else if (scene.shapes()[static_cast<size_t>(object)].opaque) {
      between.open = Without(between.open, MaskOf(same));
    } else {
      between.Filter(scene, object, MaskOf(same), None());
    }
  }
  return open;
}

inline HWY_NOINLINE void CastAt(const PacketScene& scene, const PacketHits& hits,
                                const HitPoints& at, const LaneLight& seen, int light,
                                int32_t& last_blocker, PacketShadow& shadow, PacketCounts& counts) {
  shadow.facing = seen.facing;
  shadow.lit = shadow.filtered = 0;
  if (seen.facing == 0) return;
  const auto rays_cast = static_cast<uint64_t>(std::popcount(seen.facing));
  counts.rays.shadow += rays_cast;
  counts.rays.intersect += rays_cast;
  ++counts.shadow_packets;
  NeedBounds(scene, at);
  LaneMask again = seen.facing & seen.odd;
  if (!(at.size < PacketScene::kMostOfFloat)) again = seen.facing;
  const Light& from = scene.scene().lights[static_cast<size_t>(light)];
  Between between(MaskOf(seen.facing));
  const LaneMask inside = seen.facing & hits.inside & ~again;
  if (inside != 0) again |= AddOwnExits(scene, hits, from, inside, between);
  between.open = Without(between.open, MaskOf(again));
  if (Any(between.open)) {
    FloatRays rays;
    rays.o = at.from;
    rays.d = seen.to_light;
    rays.size = at.size;
    counts.shadow_tests += FindBlockers(scene, rays, at.object, seen.distance,
                                        ShaftTo(scene, from, at), last_blocker, between);
    const LaneMask doubt = BitsOf(between.open & between.doubt);
    shadow.lit = BitsOf(between.open) & ~doubt;
    again |= doubt;
    shadow.filtered = BitsOf(between.filtered) & shadow.lit;
    if (shadow.filtered != 0) {
      for (int c = 0; c < 3; ++c) between.filter[c].Store(shadow.filter[c]);
    }
  }
  if (again == 0) return;
  counts.shadows_again += static_cast<uint64_t>(std::popcount(again));
  CastAgain(scene.tracer(), hits, light, again, shadow);
}

// Coefficients of the materials that were hit, in a packet of few or many.
struct LaneMaterials {
  Floats ambient[3], diffuse[3], specular[3], exponent;
  LaneMask uses_lights = 0, shines = 0;
  bool spawns = false;  // some reflect or transmit
};

inline HWY_NOINLINE LaneMaterials MaterialsAt(const PacketScene& scene, const PacketHits& hits) {
  const PacketMaterials& table = scene.materials();
  alignas(64) int32_t index[kPacketLanes] = {};
  const auto material_of = [&](int lane) HWY_ATTR {
    return scene.material_of()[static_cast<size_t>(hits.object[lane])];
  };
  const int32_t first = material_of(std::countr_zero(hits.hit));
  bool same = true;
  LaneMaterials at;
  const int32_t object = hits.object[std::countr_zero(hits.hit)];
  LaneMask rest = hits.hit & ~BitsOf(Ints::Load(hits.object) == Ints::All(object));
  if (rest == 0) {
    const auto m = static_cast<size_t>(first);
    at.uses_lights = table.uses_lights[m] != 0 ? hits.hit : 0;
    at.shines = table.shines[m] != 0 ? hits.hit : 0;
    at.spawns = table.spawns[m] != 0;
  } else {
    rest = hits.hit;
  }
  for (LaneMask left = rest; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    const int32_t material = material_of(lane);
    index[lane] = material;
    same = same && material == first;
    const auto m = static_cast<size_t>(material);
    at.uses_lights |= LaneMask{table.uses_lights[m]} << lane;
    at.shines |= LaneMask{table.shines[m]} << lane;
    at.spawns = at.spawns || table.spawns[m] != 0;
  }
  const Ints lanes = Ints::Load(index);
  const auto of = [&](const std::vector<float>& values) HWY_ATTR {
    return same ? Floats::All(values[static_cast<size_t>(first)]) : Gathered(values.data(), lanes);
  };
  for (int c = 0; c < 3; ++c) {
    at.ambient[c] = of(table.ambient[c]);
    at.diffuse[c] = of(table.diffuse[c]);
    at.specular[c] = of(table.specular[c]);
  }
  at.exponent = of(table.exponent);
  return at;
}

// How the rays arrive.
struct LaneView {
  Vectors to_eye;  // unit
  Floats cosine;   // n.v, not negative, with a relative error
};
HWY_INLINE LaneView ViewAt(const PacketRays& rays, const HitPoints& at) {
  const WideVectors direction = Load(rays.direction);
  return {-Demoted(direction), Max(Demoted(-Dot(at.normal, direction)), Floats::All(0))};
}

// Fall-off of a light that has any, at a distance.
HWY_INLINE Floats StrengthAt(const PacketLight& light, const Floats& distance) {
  const Floats ratio = distance * Floats::All(light.inverse_fade_distance);
  const Floats power =
      light.fade_power == 2 ? ratio * ratio : Power(ratio, Floats::All(light.fade_power));
  return Floats::All(2) / (Floats::All(1) + power);
}

// Sums light terms over the lanes of a packet.
class LightSum {
 public:
  HWY_INLINE LightSum(const PacketScene& scene, const PacketRays& rays, const PacketHits& hits,
                      const LaneMaterials& materials, const LaneView& view)
      : scene_(scene), rays_(rays), hits_(hits), materials_(materials), view_(view) {
    const Mask hit = MaskOf(hits.hit);
    const Floats zero = Floats::All(0);
    for (int c = 0; c < 3; ++c) sum_[c] = Select(hit, materials.ambient[c], zero);
  }

  // In the lanes of `summed` the diffuse light is part of the sum already.
  HWY_NOINLINE void Add(size_t index, const LaneLight& seen, const PacketShadow& shadow,
                        LaneMask summed = 0) {
    if (shadow.lit == 0) return;
    const PacketLight& light = scene_.lights()[index];
    const Floats zero = Floats::All(0), one = Floats::All(1);
    LaneMask odd = seen.odd & shadow.lit;
    Floats highlight = zero;
    if ((materials_.shines & shadow.lit) != 0) {
      // n.h = (n.l + n.v) / |l + v|: a sum of what is not negative.
      const Vectors both = seen.to_light + view_.to_eye;
      const Floats square = Dot(both, both);
      odd |= BitsOf(square < Floats::All(kLeastBisector)) & shadow.lit & materials_.shines;
      const Floats half = Min((seen.cosine + view_.cosine) * InverseSqrt(square), one);
      highlight = Power(Max(half, Floats::All(0x1p-100f)), materials_.exponent);
    }
    Floats strength = one;
    if (light.inverse_fade_distance > 0) strength = StrengthAt(light, seen.distance);
    const Mask lit = MaskOf(shadow.lit & ~odd);
    const Floats cosine = summed == 0 ? seen.cosine : Select(MaskOf(summed), zero, seen.cosine);
    for (int c = 0; c < 3; ++c) {
      const Floats reflected =
          MulAdd(materials_.diffuse[c], cosine, materials_.specular[c] * highlight);
      Floats term = strength * Floats::All(light.irradiance[c]) * reflected;
      if (shadow.filtered != 0) {
        term = Select(MaskOf(shadow.filtered), term * Floats::Load(shadow.filter[c]), term);
      }
      sum_[c] = sum_[c] + Select(lit, term, zero);
    }
    if (odd != 0) AddOdd(index, odd, summed, shadow);
  }

  // What another sum for the same hits has come to.
  HWY_INLINE void SetTo(const LightSum& other) {
    for (size_t c = 0; c < 3; ++c) sum_[c] = other.sum_[c];
  }
  // Radiance that is known already.
  HWY_INLINE void AddRadiance(const Floats radiance[3], LaneMask lanes) {
    const Mask which = MaskOf(lanes);
    for (size_t c = 0; c < 3; ++c) {
      sum_[c] = sum_[c] + Select(which, radiance[c], Floats::All(0));
    }
  }

  HWY_INLINE const Floats* sum() const { return sum_; }

 private:
  // Below this |l + v|^2 the sum's own rounding counts.
  static constexpr float kLeastBisector = 0x1p-6f;

  void AddOdd(size_t index, LaneMask lanes, LaneMask summed, const PacketShadow& shadow) {
    const Light& light = scene_.scene().lights[index];
    alignas(64) float sums[3][kPacketLanes];
    for (int c = 0; c < 3; ++c) sum_[c].Store(sums[c]);
    for (LaneMask left = lanes; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      const Vec3d normal = hits_.normal.At(lane);
      const LightView<double> view = ViewOf(light, hits_.point.At(lane));
      const Material& material = scene_.scene().MaterialOf(hits_.object[lane]);
      const Vec3d to_eye = -rays_.direction.At(lane);
      const Rgb term =
          (summed >> lane & 1) != 0
              ? HighlightRadiance(material, light, view, normal, to_eye)
              : LightTermRadiance(material, light, view, linetree::Dot(normal, view.to_light),
                                  normal, to_eye);
      const bool filtered = (shadow.filtered >> lane & 1) != 0;
      for (int c = 0; c < 3; ++c) {
        sums[c][lane] += static_cast<float>(term[c]) * (filtered ? shadow.filter[c][lane] : 1.0f);
      }
    }
    for (int c = 0; c < 3; ++c) sum_[c] = Floats::Load(sums[c]);
  }

  const PacketScene& scene_;
  const PacketRays& rays_;
  const PacketHits& hits_;
  const LaneMaterials& materials_;
  const LaneView& view_;
  Floats sum_[3];
};

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
