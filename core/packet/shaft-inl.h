// All rays of a packet at once against sixteen boxes.
#if defined(LINETREE_CORE_PACKET_SHAFT_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_SHAFT_INL_H_
#undef LINETREE_CORE_PACKET_SHAFT_INL_H_
#else
#define LINETREE_CORE_PACKET_SHAFT_INL_H_
#endif

#include <algorithm>

#include "core/packet/lanes-inl.h"
#include "core/packet/margins.h"
#include "core/packet/packet_scene.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// Per axis, what lies between two numbers.
struct Bounds {
  float low[3], high[3];
};

HWY_INLINE Bounds BoundsOf(const Vectors& v) {
  return {{Smallest(v.x), Smallest(v.y), Smallest(v.z)},
          {Largest(v.x), Largest(v.y), Largest(v.z)}};
}

// The largest |x| + |y| + |z| that the bounds allow.
HWY_INLINE float SizeOf(const Bounds& b) {
  float size = 0;
  for (int i = 0; i < 3; ++i) size += std::max(std::abs(b.low[i]), std::abs(b.high[i]));
  return size;
}

// Every segment o + t d, 0 <= t <= t_max, with o and d within bounds. A box that one of them meets
// has, on every axis, o_high + t d_high >= low and o_low + t d_low <= high: two bounds of t.
class Shaft {
 public:
  // `pad`: how far origins, and boxes' planes, may be off. Directions are off by less than
  // direction_pad.
  HWY_INLINE Shaft(const Bounds& o, const Bounds& d, float pad, float direction_pad, float t_max)
      : t_max_(t_max) {
    float wide = 0, length = 0;
    for (int i = 0; i < 3; ++i) {
      wide = std::max(wide, d.high[i] - d.low[i]);
      length = std::max({length, std::abs(d.low[i]), std::abs(d.high[i])});
      const auto away_from_zero = [](float x) HWY_ATTR {
        return std::abs(x) < kLeastSlope ? std::copysign(kLeastSlope, x) : x;
      };
      const float rising = away_from_zero(d.high[i] + direction_pad);
      const float falling = away_from_zero(d.low[i] - direction_pad);
      origin_high_[i] = o.high[i] + pad;
      origin_low_[i] = o.low[i] - pad;
      low_slope_[i] = 1 / rising;
      high_slope_[i] = 1 / falling;
    }
    loose_ = wide > kLooseShare * length;
  }

  // The boxes that some ray may meet, and from where on (not later than any of them).
  HWY_INLINE LaneMask Meets(const PacketNode& node, const Floats& t_max, Floats& entry) const {
    Floats first = Floats::All(0), last = t_max;
    for (int i = 0; i < 3; ++i) {
      const Floats a =
          (Floats::Load(node.low[i]) - Floats::All(origin_high_[i])) * Floats::All(low_slope_[i]);
      if (low_slope_[i] > 0) {
        first = Max(first, a);
      } else {
        last = Min(last, a);
      }
      const Floats b =
          (Floats::Load(node.high[i]) - Floats::All(origin_low_[i])) * Floats::All(high_slope_[i]);
      if (high_slope_[i] < 0) {
        first = Max(first, b);
      } else {
        last = Min(last, b);
      }
    }
    entry = first;
    return BitsOf(first <= last * Floats::All(kShaftSlack));
  }

  float t_max() const { return t_max_; }
  // Whether its rays part so much that most boxes are met by few of them.
  bool loose() const { return loose_; }

 private:
  static constexpr float kLooseShare = 0.15f;

  bool loose_;
  float origin_high_[3], origin_low_[3];
  float low_slope_[3], high_slope_[3];
  float t_max_;
};

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
