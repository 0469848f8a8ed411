// What the rays of a packet meet first, and which of them reach a light: the search in float.
#if defined(LINETREE_CORE_PACKET_SEARCH_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_SEARCH_INL_H_
#undef LINETREE_CORE_PACKET_SEARCH_INL_H_
#else
#define LINETREE_CORE_PACKET_SEARCH_INL_H_
#endif

#include <bit>

#include "core/packet/frustum-inl.h"
#include "core/packet/planes-inl.h"
#include "core/packet/shaft-inl.h"
#include "core/packet/shapes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

inline constexpr float kFarAway = 1e30f;

// The crossings of one shape with t in about [0, last]; false when there are none in `lanes`.
template <bool kFaces>
HWY_INLINE bool Meet(const PacketScene& scene, const PacketShape& shape, FloatRays& rays,
                     const Floats& last, const Mask& lanes, LaneCrossings& c) {
  const FloatPlane* planes = scene.planes().data() + shape.first;
  switch (shape.kind) {
    case PacketKind::kSphere:
      return MeetSphere(shape, rays, lanes, c);
    case PacketKind::kEllipsoid:
      return MeetEllipsoid(shape, rays, lanes, c);
    case PacketKind::kBox:
      return MeetBox<kFaces>(shape, rays, lanes, c);
    case PacketKind::kSlab:
      return MeetSlabShape<kFaces>(shape, rays, lanes, c);
    case PacketKind::kFrustum:
      return MeetFrustum<kFaces>(shape, rays, lanes, c);
    case PacketKind::kPolygon:
      return MeetPolygon(shape, planes, rays, last, lanes, c);
    case PacketKind::kDisc:
      return MeetDisc(shape, rays, last, lanes, c);
    case PacketKind::kPolyhedron:
      return MeetPolyhedron<kFaces>(shape, planes, rays, lanes, c);
  }
  return false;
}

// Nodes and shapes of the hierarchy that a packet may meet.
struct Pending {
  float entry;
  int32_t child;
};
// Sixteen children for each of the levels of the binary hierarchy is more than enough.
inline constexpr int kStackSize = kPacketLanes * Bvh::kMaxDepth;

// Nearest crossings so far: where one is certain it lies in [low, high], and `rival` bounds all
// others from below.
class Nearest {
 public:
  // Of a crossing: the face, the side and whether it is the first of the whole line.
  static constexpr int kInside = 2, kFirst = 1, kFaceShift = 2;

  HWY_INLINE Nearest()
      : high_(Floats::All(kFarAway)),
        low_(Floats::All(kFarAway)),
        rival_(Floats::All(2 * kFarAway)),
        object_(Ints::All(kNoObject)),
        code_(Ints::All(0)) {}

  HWY_INLINE const Floats& high() const { return high_; }
  HWY_INLINE const Ints& object() const { return object_; }
  HWY_INLINE const Ints& code() const { return code_; }

  // Lanes for which something else than what was found may be nearest.
  HWY_INLINE Mask Open() const { return rival_ <= high_; }

  HWY_INLINE void Add(const LaneCrossings& c, int32_t object) {
    const Floats zero = Floats::All(0);
    Mask maybe = c.in.maybe, sure = c.in.sure & (c.in.low > zero);
    Floats low = c.in.low, high = c.in.high;
    Ints code = Coded(c.in_face, kFirst);
    if (Any(Without(c.out.maybe, c.in.maybe & (c.in.low > zero)) | (maybe & (high < zero)))) {
      // Where the first crossing is not ahead for certain the second one counts.
      const Mask in_ahead = c.in.maybe & (c.in.high >= zero);
      maybe = in_ahead | (c.out.maybe & (c.out.high >= zero));
      const Mask second = Without(maybe, in_ahead);
      sure = Without(sure, second) | (second & c.out.sure & (c.out.low > zero));
      low = Select(second, c.out.low, low);
      high = Select(second, c.out.high, high);
      const Ints out_code =
          Select(c.out_first, Coded(c.out_face, kInside | kFirst), Coded(c.out_face, kInside));
      code = Select(second, out_code, code);
    }
    Enter(maybe, sure & maybe, low, high, Ints::All(object), code);
  }

  static HWY_INLINE Ints FaceOf(const Ints& code) {
    Ints r;
    for (size_t i = 0; i < LanesOf<int32_t>::kVectors; ++i) {
      r.v[i] = hn::ShiftRight<kFaceShift>(code.v[i]);
    }
    return r;
  }

  HWY_INLINE void Enter(const Mask& maybe, const Mask& sure, const Floats& low, const Floats& high,
                        const Ints& object, const Ints& code) {
    const Mask nearer = sure & (high < high_);
    const Floats loser = Select(nearer, low_, Select(maybe, low, Floats::All(2 * kFarAway)));
    rival_ = Min(rival_, loser);
    high_ = Select(nearer, high, high_);
    low_ = Select(nearer, low, low_);
    object_ = Select(nearer, object, object_);
    code_ = Select(nearer, code, code_);
  }

 private:
  static HWY_INLINE Ints Coded(const Ints& face, int flags) {
    Ints r;
    for (size_t i = 0; i < LanesOf<int32_t>::kVectors; ++i) {
      r.v[i] = hn::Or(hn::ShiftLeft<kFaceShift>(face.v[i]), hn::Set(Ints::Tag(), flags));
    }
    return r;
  }

  Floats high_, low_, rival_;
  Ints object_, code_;
};

// Of the lanes, those whose ray may meet child i of the node with t in [0, last], and from where
// on.
HWY_INLINE Mask MeetsChild(const PacketNode& node, int i, const FloatRays& rays, float margin,
                           const Floats& last, const Mask& lanes, Floats& entry) {
  Floats near = Floats::All(0), far = last;
  const auto slab = [&](int axis, const Floats& inverse, const Floats& start) HWY_ATTR {
    const Floats a = MulAdd(Floats::All(node.low[axis][i] - margin), inverse, start);
    const Floats b = MulAdd(Floats::All(node.high[axis][i] + margin), inverse, start);
    near = Max(near, Min(a, b));
    far = Min(far, Max(a, b));
  };
  slab(0, rays.inverse.x, rays.start.x);
  slab(1, rays.inverse.y, rays.start.y);
  slab(2, rays.inverse.z, rays.start.z);
  entry = near;
  return lanes & (near <= far * Floats::All(kShaftSlack));
}

// Lanes that do not start on the object.
HWY_INLINE Mask NotFrom(const Ints& start_object, int32_t object, const Mask& lanes) {
  return Without(lanes, OfFloats(start_object == Ints::All(object)));
}

inline HWY_NOINLINE void FindNearest(const PacketScene& scene, FloatRays& rays,
                                     const Ints& start_object, const Mask& lanes,
                                     const Shaft& shaft, Nearest& nearest) {
  Pending stack[kStackSize];
  int size = 0;
  stack[size++] = {0, 0};
  const auto limit = [&]() HWY_ATTR {
    return Largest(Select(lanes, nearest.high(), Floats::All(0)));
  };
  float last = limit();
  const float margin = kSlabMargin * (rays.size + scene.reach());
  if (shaft.loose()) rays.NeedInverse();
  while (size > 0) {
    const Pending next = stack[--size];
    if (next.entry > last * kShaftSlack) continue;
    const PacketNode& node = scene.nodes()[static_cast<size_t>(next.child)];
    Floats entry;
    LaneMask left = shaft.Meets(node, Floats::All(last), entry);
    alignas(64) float entries[kPacketLanes];
    entry.Store(entries);
    // Children in the order of their entries: few, so by insertion.
    Pending met[kPacketLanes];
    int count = 0;
    for (; left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      Pending child = {entries[i], node.child[i]};
      if (shaft.loose()) {
        Floats near;
        const Mask meets = MeetsChild(node, i, rays, margin, nearest.high(), lanes, near);
        if (!Any(meets)) continue;
        child.entry = Smallest(Select(meets, near, Floats::All(kFarAway)));
      }
      int at = count++;
      for (; at > 0 && met[at - 1].entry > child.entry; --at) met[at] = met[at - 1];
      met[at] = child;
    }
    bool changed = false;
    for (int i = 0; i < count; ++i) {
      if (met[i].child >= 0) continue;
      if (changed) {
        last = limit();
        changed = false;
      }
      if (met[i].entry > last * kShaftSlack) break;
      const PacketShape& shape = scene.shapes()[static_cast<size_t>(~met[i].child)];
      const Mask own = NotFrom(start_object, shape.object, lanes);
      LaneCrossings c;
      if (!Any(own) || !Meet<true>(scene, shape, rays, nearest.high(), own, c)) continue;
      nearest.Add(c, shape.object);
      changed = true;
    }
    if (changed) last = limit();
    for (int i = count - 1; i >= 0; --i) {
      if (met[i].child >= 0) stack[size++] = met[i];
    }
  }
}

// What lies between sixteen points and a light.
struct Between {
  Mask open;      // lanes that nothing blocks for certain
  Mask doubt;     // lanes that something may cross or not
  Mask filtered;  // lanes that something transparent crosses
  Floats filter[3];

  HWY_INLINE explicit Between(const Mask& lanes) : open(lanes), doubt(None()), filtered(None()) {
    for (Floats& f : filter) f = Floats::All(1);
  }
  // Surfaces of an object are crossed: one in the lanes of `once`, two in those of `twice`.
  // Products of several objects' coefficients depend on their order, so these lanes are left in
  // doubt: what becomes of a lane must not depend on the way it is decided.
  HWY_INLINE void Filter(const PacketScene& scene, int32_t object, const Mask& once,
                         const Mask& twice) {
    const Mask lanes = once | twice;
    doubt = doubt | (filtered & lanes);
    filtered = filtered | lanes;
    const Rgb& transmit = scene.scene().MaterialOf(object).transmit;
    for (int c = 0; c < 3; ++c) {
      const Floats one = Floats::All(static_cast<float>(transmit[c]));
      const Floats two = Floats::All(static_cast<float>(transmit[c] * transmit[c]));
      filter[c] = Select(twice, two, Select(once, one, filter[c]));
    }
  }
};

// Takes one shape into account that rays in `lanes` may meet.
HWY_INLINE void AddBlocker(const PacketScene& scene, const PacketShape& shape, FloatRays& rays,
                           const Ints& start_object, const Floats& t_max, const Mask& lanes,
                           Between& between) {
  const Mask own = NotFrom(start_object, shape.object, lanes & between.open);
  LaneCrossings c;
  if (!Any(own) || !Meet<false>(scene, shape, rays, t_max, own, c)) return;
  const Floats zero = Floats::All(0);
  const auto between_ends = [&](const LaneCrossing& x)
                                HWY_ATTR { return x.sure & (x.low > zero) & (x.high < t_max); };
  const auto may_be = [&](const LaneCrossing& x)
                          HWY_ATTR { return x.maybe & (x.high >= zero) & (x.low <= t_max); };
  const Mask in = between_ends(c.in), out = between_ends(c.out);
  between.doubt = between.doubt | Without(may_be(c.in), in) | Without(may_be(c.out), out);
  if (shape.opaque) {
    between.open = Without(between.open, in | out);
  } else {
    between.Filter(scene, shape.object, Without(in, out) | Without(out, in), in & out);
  }
}

// Returns the nodes and shapes that were tested. What becomes of a lane does not depend on the
// other lanes, nor on what was in between last, but for whether it is left in doubt.
inline HWY_NOINLINE uint32_t FindBlockers(const PacketScene& scene, FloatRays& rays,
                                          const Ints& start_object, const Floats& t_max,
                                          const Shaft& shaft, int32_t& last_blocker,
                                          Between& between) {
  uint32_t tests = 0;
  if (last_blocker >= 0) {
    // It may only close lanes: for what else it does to them it waits for its turn.
    Between blocked(between.open);
    AddBlocker(scene, scene.shapes()[static_cast<size_t>(last_blocker)], rays, start_object, t_max,
               between.open, blocked);
    ++tests;
    between.open = blocked.open;
    if (!Any(between.open)) return tests;
  }
  int32_t stack[kStackSize];
  int size = 0;
  stack[size++] = 0;
  const Floats shaft_end = Floats::All(shaft.t_max());
  const float margin = kSlabMargin * (rays.size + scene.reach());
  while (size > 0) {
    const PacketNode& node = scene.nodes()[static_cast<size_t>(stack[--size])];
    ++tests;
    Floats entry;
    for (LaneMask left = shaft.Meets(node, shaft_end, entry); left != 0; left &= left - 1) {
      const int i = std::countr_zero(left);
      const int32_t child = node.child[i];
      Mask lanes = between.open;
      if (child >= 0 || shaft.loose()) {
        rays.NeedInverse();
        Floats near;
        lanes = MeetsChild(node, i, rays, margin, t_max, between.open, near);
        if (!Any(lanes)) continue;
      }
      if (child >= 0) {
        stack[size++] = child;
        continue;
      }
      const LaneMask before = BitsOf(between.open);
      ++tests;
      AddBlocker(scene, scene.shapes()[static_cast<size_t>(~child)], rays, start_object, t_max,
                 lanes, between);
      const LaneMask after = BitsOf(between.open);
      if (after == before) continue;
      last_blocker = ~child;
      if (after == 0) return tests;
    }
  }
  return tests;
}

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
