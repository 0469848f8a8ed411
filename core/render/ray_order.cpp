#include "core/render/ray_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace linetree {
namespace {

constexpr size_t kGroup = 16;  // a packet
// A group keeps together when no component of its directions, and no coordinate of its origins by
// the largest extent of the scene, differs by more from those of its first ray.
constexpr double kMostTurn = 0.25, kMostApart = 1.0 / 8;

constexpr int kPartBits = 6, kCellBits = 4;

struct Keyed {
  uint64_t key;
  uint32_t index;
};

// Sorts by key, 11 bits at a time from the lowest; digits that all have in common cost nothing.
std::vector<uint32_t> RadixSorted(std::vector<Keyed> items) {
  constexpr int kDigitBits = 11;
  constexpr uint64_t kDigit = (1 << kDigitBits) - 1;
  uint64_t varying = 0;
  for (const Keyed& item : items) varying |= item.key ^ items[0].key;
  std::vector<Keyed> sorted(items.size());
  for (int shift = 0; shift < 64; shift += kDigitBits) {
    if ((varying >> shift & kDigit) == 0) continue;
    std::array<uint32_t, kDigit + 1> next{};
    for (const Keyed& item : items) ++next[item.key >> shift & kDigit];
    uint32_t sum = 0;
    for (uint32_t& n : next) {
      const uint32_t count = n;
      n = sum;
      sum += count;
    }
    for (const Keyed& item : items) sorted[next[item.key >> shift & kDigit]++] = item;
    items.swap(sorted);
  }
  std::vector<uint32_t> order(items.size());
  for (size_t i = 0; i < items.size(); ++i) order[i] = items[i].index;
  return order;
}

// Numbers below 2^bits with kAxes - 1 zeros after every bit.
template <int kBits, int kAxes>
constexpr std::array<uint32_t, 1 << kBits> SpreadBits() {
  std::array<uint32_t, 1 << kBits> spread{};
  for (uint32_t value = 0; value < spread.size(); ++value) {
    for (int bit = 0; bit < kBits; ++bit) spread[value] |= (value >> bit & 1) << (bit * kAxes);
  }
  return spread;
}

// Parts of boxes, 2^bits on every axis.
class Parts {
 public:
  Parts(const Box3& box, int bits) : low_(box.min), last_((1 << bits) - 1) {
    const Vec3d extent = box.Extent();
    for (int i = 0; i < 3; ++i) {
      scale_[i] = extent[i] > 0 && extent[i] < Box3::kInf ? std::ldexp(1.0, bits) / extent[i] : 0;
    }
  }
  // Outside the box: the nearest part.
  size_t Of(const Vec3d& point, int axis) const {
    const double part = (point[axis] - low_[axis]) * scale_[axis];
    return part > 0 ? static_cast<size_t>(std::min(part, last_)) : 0;
  }

 private:
  Vec3d low_, scale_;
  double last_;
};

// Of [-1, 1].
size_t PartOfUnit(double x) {
  constexpr double kHalf = 1 << (kPartBits - 1);
  return static_cast<size_t>(std::clamp((x + 1) * kHalf, 0.0, 2 * kHalf - 1));
}

// The octahedron, unfolded to [-1, 1]^2.
struct Unfolded {
  double u, v;
};
Unfolded Unfold(const Vec3d& d) {
  const double size = std::abs(d.x) + std::abs(d.y) + std::abs(d.z);
  const double u = d.x / size, v = d.y / size;
  if (d.z >= 0) return {u, v};
  return {std::copysign(1 - std::abs(v), u), std::copysign(1 - std::abs(u), v)};
}

bool KeepTogether(std::span<const Ray> group, double most_apart) {
  const Ray& first = group[0];
  return std::all_of(group.begin(), group.end(), [&](const Ray& ray) {
    for (int i = 0; i < 3; ++i) {
      if (!(std::abs(ray.direction[i] - first.direction[i]) <= kMostTurn)) return false;
      if (!(std::abs(ray.origin[i] - first.origin[i]) <= most_apart)) return false;
    }
    return true;
  });
}

}  // namespace

bool KeepTogether(std::span<const Ray> rays, const Box3& bounds) {
  const size_t groups = rays.size() / kGroup;
  if (groups == 0) return true;
  const Vec3d extent = bounds.Extent();
  const double most_apart = kMostApart * std::max({extent.x, extent.y, extent.z});
  const size_t judged = std::min(groups, kJudgedGroups);
  size_t together = 0;
  for (size_t i = 0; i < judged; ++i) {
    const size_t group = i * groups / judged;
    together += KeepTogether(rays.subspan(group * kGroup, kGroup), most_apart) ? 1 : 0;
  }
  return 2 * together >= judged;
}

std::vector<uint32_t> SortedRays(std::span<const Ray> rays, const Box3& bounds) {
  static constexpr auto kSpread = SpreadBits<kPartBits, 5>();
  const Parts parts(bounds, kPartBits);
  std::vector<Keyed> keyed(rays.size());
  for (size_t i = 0; i < rays.size(); ++i) {
    const Unfolded d = Unfold(rays[i].direction);
    uint64_t key = kSpread[PartOfUnit(d.u)] | kSpread[PartOfUnit(d.v)] << 1;
    for (int axis = 0; axis < 3; ++axis) {
      key |= uint64_t{kSpread[parts.Of(rays[i].origin, axis)]} << (axis + 2);
    }
    keyed[i] = {key, static_cast<uint32_t>(i)};
  }
  return RadixSorted(std::move(keyed));
}

std::vector<uint32_t> BinnedHits(const Scene& scene, std::span<const Hit> hits) {
  static constexpr auto kSpread = SpreadBits<kCellBits, 3>();
  constexpr int kFaceBits = 8;  // more faces share bins
  std::vector<Keyed> keyed;
  keyed.reserve(hits.size());
  for (size_t i = 0; i < hits.size(); ++i) {
    const Hit& hit = hits[i];
    if (!hit.IsHit()) continue;
    const Parts parts(scene.objects[static_cast<size_t>(hit.object)].bounds, kCellBits);
    uint64_t key = static_cast<uint64_t>(hit.object) << kFaceBits |
                   (static_cast<uint64_t>(hit.face) & ((1 << kFaceBits) - 1));
    key <<= 3 * kCellBits;
    for (int axis = 0; axis < 3; ++axis) key |= kSpread[parts.Of(hit.point, axis)] << axis;
    keyed.push_back({key, static_cast<uint32_t>(i)});
  }
  return RadixSorted(std::move(keyed));
}

}  // namespace linetree
