#include "core/tree/linetree.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <vector>

#include "core/math/check.h"

namespace linetree {
namespace {

// Whoever finds a cell tried, or children, finds what was stored before.
uint32_t LoadState(CellNode& node) {
  return std::atomic_ref<uint32_t>(node.state).load(std::memory_order_acquire);
}
void StoreState(CellNode& node, uint32_t state) {
  std::atomic_ref<uint32_t>(node.state).store(state, std::memory_order_release);
}
uint32_t LoadChildren(CellNode& node) {
  return std::atomic_ref<uint32_t>(node.children).load(std::memory_order_acquire);
}
void StoreChildren(CellNode& node, uint32_t children) {
  std::atomic_ref<uint32_t>(node.children).store(children, std::memory_order_release);
}
// Changes `word` where it is `expected`, which otherwise becomes what it is.
bool Exchange(uint32_t& word, uint32_t& expected, uint32_t wanted) {
  return std::atomic_ref<uint32_t>(word).compare_exchange_strong(expected, wanted,
                                                                 std::memory_order_acq_rel);
}
Verdict VerdictOf(uint32_t state) { return static_cast<Verdict>(state & 15); }
bool IsTried(CellNode& node) { return VerdictOf(LoadState(node)) != Verdict::kUntried; }
uint32_t StateOf(Verdict verdict, uint32_t now) {
  return static_cast<uint32_t>(verdict) | (now & kStampMask) << 4;
}

// Of an untried cell that somebody is about to publish.
const uint32_t kClaimed = StateOf(Verdict::kUntried, 1);

// The verdict shares the word: a cell that has been evicted meanwhile stays so.
void Touch(CellNode& node, uint32_t state, uint32_t now) {
  const uint32_t fresh = StateOf(VerdictOf(state), now);
  if (fresh == state) return;
  std::atomic_ref<uint32_t>(node.state)
      .compare_exchange_strong(state, fresh, std::memory_order_relaxed);
}

}  // namespace

Lookup Linetree::Find(const RayCoords& coords, double epsilon, int max_depth, uint32_t now) const {
  Lookup found;
  const CellId deepest = CellAt(coords, max_depth);
  CellNode* node = &root_;
  for (int depth = 0;; ++depth) {
    const uint32_t state = LoadState(*node);
    const Verdict verdict = VerdictOf(state);
    if (verdict == Verdict::kUntried) {
      found.kind = Lookup::Kind::kUnbuilt;
      found.cell = CellAt(coords, depth);
      return found;
    }
    const bool meets = static_cast<double>(node->spread) <= epsilon;
    found.verdict = verdict == Verdict::kCertified && !meets ? Verdict::kEpsilon : verdict;
    if (found.verdict == Verdict::kCertified) {
      found.kind = Lookup::Kind::kAnswer;
      found.cell = CellAt(coords, depth);
      found.interpolant = &pools_->interpolants[node->interpolant];
      Touch(*node, state, now);
      return found;
    }
    const uint32_t children = LoadChildren(*node);
    if (depth == max_depth || children == 0) Touch(*node, state, now);
    if (depth == max_depth) return found;
    if (children == 0) {
      found.kind = Lookup::Kind::kUnbuilt;
      found.cell = CellAt(coords, depth + 1);
      return found;
    }
    node = &pools_->blocks[children].child[static_cast<size_t>(deepest.ChildAt(depth))];
  }
}

bool Linetree::Publish(const CellId& cell, const Judgement& judgement, uint32_t now) {
  LT_CHECK(judgement.verdict != Verdict::kUntried);
  CellHandle at;
  for (int depth = 0; depth < cell.depth; ++depth) {
    CellNode& parent = At(at);
    if (!IsTried(parent)) return false;
    // Evicted further up: a block that nothing comes into is never one of leaves.
    if (depth + 1 < cell.depth && LoadChildren(parent) == 0) return false;
    at = {ChildrenOf(at), static_cast<uint32_t>(cell.ChildAt(depth))};
  }
  CellNode& node = At(at);
  uint32_t unclaimed = StateOf(Verdict::kUntried, 0);
  if (!Exchange(node.state, unclaimed, kClaimed)) return false;
  if (judgement.verdict == Verdict::kCertified) {
    node.spread = std::nextafter(static_cast<float>(judgement.spread),
                                 std::numeric_limits<float>::infinity());
    node.interpolant = pools_->interpolants.Allocate();
    pools_->interpolants[node.interpolant] = judgement.interpolant;
  }
  StoreState(node, StateOf(judgement.verdict, now));
  ++cell_count_;
  ++verdicts_[static_cast<size_t>(judgement.verdict)];
  return true;
}

uint32_t Linetree::ChildrenOf(CellHandle at) {
  CellNode& parent = At(at);
  uint32_t children = LoadChildren(parent);
  if (children != 0) return children;
  const uint32_t made = pools_->blocks.Allocate();
  CellBlock& block = pools_->blocks[made];
  block.parent_block = at.block;
  block.parent_child = at.child;
  if (Exchange(parent.children, children, made)) return made;
  pools_->blocks.Free(made);  // which nobody has seen
  return children;
}

std::array<uint64_t, kVerdictCount> Linetree::verdicts() const {
  std::array<uint64_t, kVerdictCount> verdicts;
  std::copy(verdicts_.begin(), verdicts_.end(), verdicts.begin());
  return verdicts;
}

bool Linetree::HasTriedChild(const CellNode& node) const {
  if (node.children == 0) return false;
  auto& children = pools_->blocks[node.children].child;
  return std::any_of(children.begin(), children.end(), IsTried);
}

void Linetree::ForEachBlock(const std::function<void(uint32_t block)>& visit) const {
  std::vector<uint32_t> order;
  if (root_.children != 0) order.push_back(root_.children);
  for (size_t i = 0; i < order.size(); ++i) {
    for (const CellNode& node : pools_->blocks[order[i]].child) {
      if (node.children != 0) order.push_back(node.children);
    }
  }
  std::for_each(order.rbegin(), order.rend(), visit);
}

void Linetree::ForEachLeaf(const std::function<void(CellHandle, uint32_t)>& visit) const {
  const auto visit_if_leaf = [&](CellHandle handle) {
    CellNode& node = At(handle);
    if (IsTried(node) && !HasTriedChild(node)) visit(handle, LoadState(node) >> 4);
  };
  visit_if_leaf({});
  ForEachBlock([&](uint32_t block) {
    for (uint32_t i = 0; i < kCellChildren; ++i) visit_if_leaf({block, i});
  });
}

void Linetree::EvictLeaf(CellHandle leaf, RetiredCells& retired) {
  CellNode& node = At(leaf);
  LT_CHECK(IsTried(node) && node.children == 0);
  --cell_count_;
  --verdicts_[static_cast<size_t>(VerdictOf(LoadState(node)))];
  StoreState(node, StateOf(Verdict::kUntried, 0));
  if (node.interpolant != 0) {
    retired.interpolants.push_back(node.interpolant);
    retired.nodes.push_back(&node);
  }
  if (leaf.block == 0) return;
  const CellBlock& block = pools_->blocks[leaf.block];
  CellNode& parent = At({block.parent_block, block.parent_child});
  if (HasTriedChild(parent)) return;
  retired.blocks.push_back(parent.children);
  StoreChildren(parent, 0);
}

void CellPools::Free(const RetiredCells& retired) {
  for (CellNode* node : retired.nodes) {
    node->interpolant = 0;
    node->spread = 0;
  }
  for (const uint32_t interpolant : retired.interpolants) interpolants.Free(interpolant);
  for (const uint32_t block : retired.blocks) blocks.Free(block);
}

void Linetree::Clear() {
  const auto release = [&](CellNode& node) {
    if (node.interpolant != 0) pools_->interpolants.Free(node.interpolant);
    node = CellNode{};
  };
  ForEachBlock([&](uint32_t block) {
    for (CellNode& node : pools_->blocks[block].child) release(node);
    pools_->blocks.Free(block);
  });
  release(root_);
  cell_count_ = 0;
  for (auto& count : verdicts_) count = 0;
}

uint64_t Linetree::CountBytes() const {
  uint64_t bytes = root_.interpolant != 0 ? sizeof(Interpolant) : 0;
  ForEachBlock([&](uint32_t block) {
    bytes += sizeof(CellBlock);
    for (const CellNode& node : pools_->blocks[block].child) {
      if (node.interpolant != 0) bytes += sizeof(Interpolant);
    }
  });
  return bytes;
}

}  // namespace linetree
