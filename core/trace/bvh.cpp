#include "core/trace/bvh.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>

#include "core/math/check.h"

namespace linetree {
namespace {

constexpr int kBins = 16;

struct Bin {
  Box3 box;
  int count = 0;
};

// Objects whose box centres lie in bins [0, bin) of the axis go left.
struct Split {
  int axis = 0;
  int bin = 0;
  double cost = 0;
};

class Builder {
 public:
  Builder(std::span<const Box3> boxes, std::vector<Bvh::Node>& nodes, std::vector<int32_t>& objects)
      : boxes_(boxes), nodes_(nodes), objects_(objects) {}

  // Appends the subtree over objects_[begin, end).
  void Build(int begin, int end, int depth) {
    const size_t index = nodes_.size();
    nodes_.emplace_back();
    Box3 box, centres;
    for (int i = begin; i < end; ++i) {
      box.Add(BoxAt(i));
      centres.Add(BoxAt(i).Center());
    }
    nodes_[index].box = box;
    const int middle = Partition(begin, end, depth, box, centres);
    if (middle == begin) {
      nodes_[index].first = begin;
      nodes_[index].count = end - begin;
      return;
    }
    LT_CHECK(depth + 1 < Bvh::kMaxDepth);
    Build(begin, middle, depth + 1);
    nodes_[index].first = static_cast<int32_t>(nodes_.size());
    Build(middle, end, depth + 1);
  }

 private:
  const Box3& BoxAt(int i) const {
    return boxes_[static_cast<size_t>(objects_[static_cast<size_t>(i)])];
  }

  // Reorders [begin, end) and returns where the right child starts; begin for a leaf.
  int Partition(int begin, int end, int depth, const Box3& box, const Box3& centres) {
    const int count = end - begin;
    if (count == 1) return begin;
    const std::optional<Split> split =
        depth < Bvh::kMaxCostDepth ? CheapestSplit(begin, end, centres) : std::nullopt;
    // One node visit costs about as much as one object's intersection.
    const bool worth_it = split && split->cost + box.HalfArea() < count * box.HalfArea();
    if (count <= Bvh::kMaxLeaf && !worth_it) return begin;
    if (!split) return begin + count / 2;
    const auto first = objects_.begin() + begin;
    const auto right = std::partition(first, objects_.begin() + end, [&](int32_t object) {
      const Vec3d centre = boxes_[static_cast<size_t>(object)].Center();
      return BinOf(centre[split->axis], centres, split->axis) < split->bin;
    });
    return begin + static_cast<int>(right - first);
  }

  static int BinOf(double centre, const Box3& centres, int axis) {
    const double extent = centres.max[axis] - centres.min[axis];
    const int bin = static_cast<int>(kBins * ((centre - centres.min[axis]) / extent));
    return std::clamp(bin, 0, kBins - 1);
  }

  // Nothing when all centres coincide.
  std::optional<Split> CheapestSplit(int begin, int end, const Box3& centres) const {
    std::optional<Split> best;
    for (int axis = 0; axis < 3; ++axis) {
      const double extent = centres.max[axis] - centres.min[axis];
      if (!(extent > 0) || !std::isfinite(extent)) continue;
      std::array<Bin, kBins> bins;
      for (int i = begin; i < end; ++i) {
        Bin& bin = bins[static_cast<size_t>(BinOf(BoxAt(i).Center()[axis], centres, axis))];
        bin.box.Add(BoxAt(i));
        ++bin.count;
      }
      AddSplits(axis, bins, best);
    }
    return best;
  }

  static void AddSplits(int axis, const std::array<Bin, kBins>& bins, std::optional<Split>& best) {
    std::array<double, kBins> right_cost{};
    Bin right;
    for (size_t i = kBins - 1; i > 0; --i) {
      right.box.Add(bins[i].box);
      right.count += bins[i].count;
      right_cost[i] = right.count * right.box.HalfArea();
    }
    Bin left;
    for (size_t i = 1; i < kBins; ++i) {
      left.box.Add(bins[i - 1].box);
      left.count += bins[i - 1].count;
      const double cost = left.count * left.box.HalfArea() + right_cost[i];
      if (!best || cost < best->cost) best = Split{axis, static_cast<int>(i), cost};
    }
  }

  std::span<const Box3> boxes_;
  std::vector<Bvh::Node>& nodes_;
  std::vector<int32_t>& objects_;
};

}  // namespace

Bvh::Bvh(std::span<const Box3> boxes) : objects_(boxes.size()) {
  if (boxes.empty()) return;
  std::iota(objects_.begin(), objects_.end(), 0);
  nodes_.reserve(boxes.size());
  Builder(boxes, nodes_, objects_).Build(0, static_cast<int>(boxes.size()), 0);
  nodes_.shrink_to_fit();
  const Box3& root = nodes_[0].box;
  for (int i = 0; i < 3; ++i) {
    magnitude_ = std::max({magnitude_, std::abs(root.min[i]), std::abs(root.max[i])});
  }
}

}  // namespace linetree
