// The hits of a packet: searched in float, decided again in double where that is not enough, and
// finished in double.
#if defined(LINETREE_CORE_PACKET_HITS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_HITS_INL_H_
#undef LINETREE_CORE_PACKET_HITS_INL_H_
#else
#define LINETREE_CORE_PACKET_HITS_INL_H_
#endif

#include "core/packet/finish-inl.h"
#include "core/packet/search-inl.h"
#include "core/packet/shade-inl.h"
#include "core/trace/intersect.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// Rays that start inside an object meet its far side, if nothing before.
struct LaneExits {
  LaneMask lanes = 0;
  alignas(64) double t[kPacketLanes];
};

inline HWY_NOINLINE void AddExits(const PacketScene& scene, const PacketRays& rays,
                                  LaneExits& exits, Nearest& nearest) {
  alignas(64) float low[kPacketLanes] = {}, high[kPacketLanes] = {};
  alignas(64) int32_t code[kPacketLanes] = {};
  for (LaneMask left = rays.start_inside & rays.active; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    const RayStart start = rays.StartAt(lane);
    const Shape& shape = scene.scene().objects[static_cast<size_t>(start.object)].shape;
    const Crossings<double> crossings = CrossingsFromStart(
        shape, rays.origin.At(lane), rays.direction.At(lane), start.face, start.side);
    exits.t[lane] = 0;
    if (crossings.count == 0) continue;
    const Crossing<double>& exit = crossings.at[0];
    exits.lanes |= LaneMask{1} << lane;
    exits.t[lane] = exit.t;
    low[lane] = RoundedDown(exit.t);
    high[lane] = RoundedUp(exit.t);
    code[lane] = exit.face << Nearest::kFaceShift |
                 (exit.side == Side::kInside ? Nearest::kInside : 0) |
                 (exit.first_on_line ? Nearest::kFirst : 0);
  }
  const Mask which = MaskOf(exits.lanes);
  nearest.Enter(which, which, Floats::Load(low), Floats::Load(high), Ints::Load(rays.start_object),
                Ints::Load(code));
}

inline HWY_NOINLINE void FindAgain(const PacketScene& scene, const PacketRays& rays, LaneMask lanes,
                                   PacketHits& hits, PacketCounts& counts) {
  for (LaneMask left = lanes; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    hits.Set(lane, scene.tracer().Intersect(rays.origin.At(lane), rays.direction.At(lane),
                                            rays.StartAt(lane)));
  }
  counts.hits_again += static_cast<uint64_t>(std::popcount(lanes));
}

// Finishes the hits of `lanes`; returns those that it cannot.
inline HWY_NOINLINE LaneMask FinishHits(const PacketScene& scene, const PacketRays& rays,
                                        const LaneExits& exits, const Nearest& nearest,
                                        LaneMask lanes, PacketHits& hits) {
  const WideVectors origin = Load(rays.origin), direction = Load(rays.direction);
  alignas(64) int32_t codes[kPacketLanes];
  nearest.code().Store(codes);
  nearest.object().Store(hits.object);
  LaneMask bad = 0;
  Doubles t;
  WideVectors point, normal;
  bool first = true;
  for (LaneMask left = lanes; left != 0;) {
    const int lane = std::countr_zero(left);
    const int32_t object = hits.object[lane], code = codes[lane];
    const LaneMask same = BitsOf(OfFloats((nearest.object() == Ints::All(object)) &
                                          (nearest.code() == Ints::All(code)))) &
                          left;
    left &= ~same;
    const bool inside = (code & Nearest::kInside) != 0;
    const int face = code >> Nearest::kFaceShift;
    const LaneMask known = same & exits.lanes & (inside ? kAllLanes : 0) &
                           BitsOf(OfFloats(Ints::Load(rays.start_object) == Ints::All(object)));
    const FinishedHit hit = Finish(scene, object, face, inside, origin, direction,
                                   known != 0 ? exits.t : nullptr, TruthOf<double>(known));
    bad |= same & ~BitsOf(hit.good);
    const WideMask which = TruthOf<double>(same);
    t = first ? hit.t : Select(which, hit.t, t);
    point = first ? hit.point : Select(which, hit.point, point);
    normal = first ? hit.normal : Select(which, hit.normal, normal);
    first = false;
    if (inside) hits.inside |= same;
    if ((code & Nearest::kFirst) != 0) hits.first_on_line |= same;
  }
  Nearest::FaceOf(nearest.code()).Store(hits.face);
  hits.hit |= lanes;
  if (!first) {
    t.Store(hits.t);
    Store(point, hits.point);
    Store(normal, hits.normal);
  }
  return bad;
}

// What a packet's search leaves.
struct HitSearch {
  Nearest nearest;
  LaneExits exits;
  LaneMask again = 0;  // lanes that it leaves to the scalar tracer

  // Written down, because what is implicit is not compiled for this target.
  HWY_INLINE HitSearch() {}
};

inline HWY_NOINLINE void SearchHits(const PacketScene& scene, const PacketRays& rays,
                                    HitSearch& search, PacketCounts& counts) {
  ++counts.packets;
  counts.rays.intersect += static_cast<uint64_t>(std::popcount(rays.active));
  search.again = rays.active;
  if (rays.active == 0) return;
  FloatRays lines;
  lines.o = Filled(Demoted(Load(rays.origin) - Spread(scene.reference())), rays.active);
  lines.d = Filled(Demoted(Load(rays.direction)), rays.active);
  const Bounds origins = BoundsOf(lines.o), directions = BoundsOf(lines.d);
  lines.size = SizeOf(origins) + scene.least_length();
  if (!(lines.size < PacketScene::kMostOfFloat)) return;
  if ((rays.start_inside & rays.active) != 0) AddExits(scene, rays, search.exits, search.nearest);
  const Shaft shaft(origins, directions, kShaftPad * lines.size, kShaftPad, kFarAway);
  FindNearest(scene, lines, Ints::Load(rays.start_object), MaskOf(rays.active), shaft,
              search.nearest);
  search.again = BitsOf(search.nearest.Open()) & rays.active;
}

inline HWY_NOINLINE void CompleteHits(const PacketScene& scene, const PacketRays& rays,
                                      const HitSearch& search, PacketHits& hits,
                                      PacketCounts& counts) {
  hits.hit = hits.inside = hits.first_on_line = 0;
  const LaneMask none = BitsOf(OfFloats(search.nearest.object() == Ints::All(kNoObject)));
  LaneMask again = search.again;
  again |=
      FinishHits(scene, rays, search.exits, search.nearest, rays.active & ~again & ~none, hits);
  if (again != 0) FindAgain(scene, rays, again, hits, counts);
  if (hits.hit == rays.active) return;
  for (LaneMask left = rays.active & ~hits.hit; left != 0; left &= left - 1) {
    hits.object[std::countr_zero(left)] = kNoObject;
  }
}

HWY_INLINE void FindHitsOf(const PacketScene& scene, const PacketRays& rays, PacketHits& hits,
                           PacketCounts& counts) {
  HitSearch search;
  SearchHits(scene, rays, search, counts);
  CompleteHits(scene, rays, search, hits, counts);
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
