#include "core/scene/scene_change.h"

#include <algorithm>
#include <tuple>

namespace linetree {
namespace {

struct Pair {
  int32_t former, now;
};

auto KeyOf(const Box3& box) {
  return std::tuple(box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z);
}

std::vector<int32_t> SortedByBounds(const std::vector<Object>& objects) {
  std::vector<int32_t> order(objects.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = static_cast<int32_t>(i);
  std::stable_sort(order.begin(), order.end(), [&](int32_t a, int32_t b) {
    return KeyOf(objects[static_cast<size_t>(a)].bounds) <
           KeyOf(objects[static_cast<size_t>(b)].bounds);
  });
  return order;
}

// Objects of equal shapes: the first with the first, the second with the second. By index now.
std::vector<Pair> EqualShapes(const Scene& former, const Scene& now) {
  const std::vector<int32_t> a = SortedByBounds(former.objects), b = SortedByBounds(now.objects);
  std::vector<Pair> pairs;
  for (size_t i = 0, j = 0; i < a.size() && j < b.size();) {
    const Object& before = former.objects[static_cast<size_t>(a[i])];
    const Object& after = now.objects[static_cast<size_t>(b[j])];
    if (KeyOf(before.bounds) < KeyOf(after.bounds)) {
      ++i;
    } else if (KeyOf(after.bounds) < KeyOf(before.bounds)) {
      ++j;
    } else {
      if (before.shape == after.shape) pairs.push_back({a[i], b[j]});
      ++i, ++j;
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](Pair x, Pair y) { return x.now < y.now; });
  return pairs;
}

// The longest part whose former indices ascend as well.
std::vector<Pair> InOrder(const std::vector<Pair>& pairs) {
  std::vector<size_t> last;  // of the runs of length k + 1, the pair at which the lowest one ends
  std::vector<size_t> before(pairs.size());
  for (size_t i = 0; i < pairs.size(); ++i) {
    const auto at =
        std::lower_bound(last.begin(), last.end(), pairs[i].former,
                         [&](size_t pair, int32_t former) { return pairs[pair].former < former; });
    if (at != last.begin()) before[i] = *(at - 1);
    if (at == last.end()) {
      last.push_back(i);
    } else {
      *at = i;
    }
  }
  std::vector<Pair> kept(last.size());
  size_t i = last.empty() ? 0 : last.back();
  for (auto it = kept.rbegin(); it != kept.rend(); ++it, i = before[i]) *it = pairs[i];
  return kept;
}

// Whether rays through the object are another matter with the one material than with the other.
bool LetsOtherLightThrough(const Material& a, const Material& b) {
  return a.transmit != b.transmit || (!IsBlack(a.transmit) && a.ior != b.ior);
}

}  // namespace

SceneChange ChangeBetween(const Scene& former, const Scene& now) {
  SceneChange change;
  change.now.assign(former.objects.size(), SceneChange::kGone);
  change.altered.assign(former.objects.size(), false);
  std::vector<bool> is_old(now.objects.size(), false);
  for (const Pair& pair : InOrder(EqualShapes(former, now))) {
    const auto i = static_cast<size_t>(pair.former);
    change.now[i] = pair.now;
    is_old[static_cast<size_t>(pair.now)] = true;
    const Material& before = former.MaterialOf(pair.former);
    Material after = now.MaterialOf(pair.now);
    after.name = before.name;
    change.altered[i] = before != after;
    if (LetsOtherLightThrough(before, after)) change.places.push_back(former.objects[i].bounds);
  }
  for (size_t i = 0; i < change.now.size(); ++i) {
    const bool is_gone = change.now[i] == SceneChange::kGone;
    if (is_gone) change.places.push_back(former.objects[i].bounds);
    if (is_gone ? i >= now.objects.size() : change.now[i] != static_cast<int32_t>(i)) {
      change.keeps_indices = false;
    }
  }
  for (size_t i = 0; i < is_old.size(); ++i) {
    if (!is_old[i]) change.places.push_back(now.objects[i].bounds);
  }
  change.lights = former.lights != now.lights;
  change.radiance = change.lights || former.background != now.background ||
                    former.ambient != now.ambient || former.white != now.white;
  return change;
}

}  // namespace linetree
