// Books which blocks of a store are used, frame by frame, and evicts those that a policy picks.
//
// A block is the children of one cell, or the roots of one tree. Blocks go leaf-first: one goes
// when nothing below it is left. What is used by frames under way or was by the last one stays, as
// far as the budget permits. A ledger starts when its store is nearly full, and is empty before;
// its bytes count in the budget, of which it never takes more than half: in so small a one there is
// no policy.
//
// Thread safety: one thread at a time, which is then the one that evicts; readers and builders of
// the store may go on.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "core/cache/block_id.h"
#include "core/cache/build_costs.h"
#include "core/cache/tree_store.h"
#include "core/policy/policies.h"
#include "core/policy/trace_recorder.h"

namespace linetree {

// A frame that has ended, for those who record it.
struct FrameMark {
  TraceRecorder* recorder = nullptr;  // null: nobody
  uint32_t frame = 0;
  uint64_t salt = 0;  // tells the blocks of scenes apart
};

// From this share of its budget on a store is nearly full.
inline constexpr double kNearlyFull = 0.75;

template <class Tree>
class BlockLedger {
 public:
  using Node = typename Tree::Node;
  using Store = TreeStore<Tree>;

  // `kind` tells stores apart. Keeps a reference to the costs.
  BlockLedger(uint64_t kind, const BuildCosts& costs) : kind_(kind), costs_(costs) {}

  // The policy to go by, from AllPolicies; empty: the store's own order, least recently used first.
  void SetPolicy(std::string_view name) {
    policy_name_ = std::string(name);
    Reset();
  }
  // To be called when the store has changed in other ways than by growing or Evict.
  void Reset() {
    held_ = {};
    policy_.reset();
  }

  // Books what has been used at `since` or later, when the store is nearly full for the budget that
  // it shares with the ledger, or somebody records.
  void EndFrame(const Store& store, uint32_t since, uint64_t budget, const FrameMark& mark) {
    const auto bytes = static_cast<double>(store.byte_size() + ByteSize());
    const bool nearly_full = bytes > kNearlyFull * static_cast<double>(budget);
    if (!nearly_full || policy_name_.empty()) Reset();
    if (!policy_ && mark.recorder == nullptr) {
      if (nearly_full && !policy_name_.empty()) Start(store, budget);
      return;
    }
    std::vector<PolicyItem> items;
    ForEachBlock(store, [&](const Block& block, uint32_t used) {
      if (used < since) return;
      PolicyItem item = ItemOf(store, block);
      if (policy_) Use(block, item);
      item.id ^= mark.salt;
      if (mark.recorder != nullptr) items.push_back(item);
    });
    if (policy_) policy_->NextFrame();
    KeepWithin(budget / 2);
    if (mark.recorder != nullptr) mark.recorder->Add(mark.frame, items);
  }

  // Until store and ledger hold at most `target` bytes. What was used at `pinned` or later stays as
  // long as there is anything else, what builders own in any case.
  void Evict(Store& store, uint64_t target, uint32_t pinned) {
    if (store.byte_size() + ByteSize() <= target) return;
    if (!policy_ && !policy_name_.empty()) Start(store, target);
    if (policy_) {
      typename Store::Removed removed;
      TakeVictims(store, target, pinned, removed);
      store.Dispose(removed);
    }
    if (store.byte_size() + ByteSize() <= target) return;
    Reset();
    store.Evict(target);
  }

  const std::string& policy_name() const { return policy_name_; }
  uint64_t ByteSize() const {
    return held_.capacity() * (sizeof(typename Held::value_type) + 1) +
           (policy_ ? policy_->ByteSize() : 0);
  }

 private:
  // A policy may have to be told so often that an item stays until it picks others.
  static constexpr size_t kMostSpared = 4;

  struct Block {
    Node* parent = nullptr;  // null: the roots of the object's tree
    size_t object = 0;
    uint64_t bytes = 0;  // as the policy knows them
  };
  using Held = absl::flat_hash_map<uint64_t, Block>;

  uint64_t IdOf(const Block& block) const {
    return block.parent == nullptr
               ? TreeId(kind_, block.object)
               : BlockId(kind_, block.object, block.parent->root, block.parent->cell);
  }
  // visit(Node&) for the cells of a block.
  template <class Fn>
  static void ForEachCell(const Store& store, const Block& block, Fn&& visit) {
    if (block.parent == nullptr) {
      store.Get(block.object)->cells().ForEachRoot(visit);
    } else if (auto* children = block.parent->children.get()) {
      for (Node& child : *children) visit(child);
    }
  }
  PolicyItem ItemOf(const Store& store, const Block& block) const {
    uint64_t bytes = block.parent == nullptr ? store.Get(block.object)->OwnBytes()
                                             : sizeof(typename Node::Children);
    uint64_t cells = 0;
    ForEachCell(store, block, [&](const Node& cell) {
      bytes += Node::BytesOf(cell.payload.get());
      cells += cell.payload ? 1 : 0;
    });
    const float ns = static_cast<float>(cells) * costs_.NsPerCell(block.object);
    return {IdOf(block), bytes, std::max(1.0f, ns)};
  }

  // visit(const Block&, used) for all blocks, those below others first; `used` is when any cell in
  // or below the block was used last.
  template <class Fn>
  static void ForEachBlock(const Store& store, Fn&& visit) {
    store.ForEachTree([&](size_t object, Tree& tree) {
      uint32_t used = 0;
      tree.cells().ForEachRoot(
          [&](Node& root) { used = std::max(used, VisitBelow(object, root, visit)); });
      visit(Block{.object = object}, used);
    });
  }
  template <class Fn>
  static uint32_t VisitBelow(size_t object, Node& node, Fn& visit) {
    const uint32_t own = node.last_used.load(std::memory_order_relaxed);
    auto* children = node.children.get();
    if (children == nullptr) return own;
    uint32_t used = 0;
    for (Node& child : *children) used = std::max(used, VisitBelow(object, child, visit));
    visit(Block{&node, object}, used);
    return std::max(own, used);
  }

  void Use(Block block, const PolicyItem& item) {
    block.bytes = item.bytes;
    const auto [found, is_new] = held_.try_emplace(item.id, block);
    if (is_new) return policy_->Insert(item);
    if (std::exchange(found->second.bytes, item.bytes) != item.bytes) policy_->Change(item);
    policy_->Access(item.id);
  }

  void KeepWithin(uint64_t bytes) {
    if (ByteSize() > bytes) Reset();
  }
  // With all blocks that there are, from the one that was used longest ago on.
  void Start(const Store& store, uint64_t budget) {
    policy_ = *MakePolicy(policy_name_, budget);
    std::vector<std::pair<uint32_t, Block>> blocks;
    ForEachBlock(store,
                 [&](const Block& block, uint32_t used) { blocks.emplace_back(used, block); });
    std::stable_sort(blocks.begin(), blocks.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [used, block] : blocks) Use(block, ItemOf(store, block));
    policy_->NextFrame();
    KeepWithin(budget / 2);
  }

  static bool IsLeaf(const Store& store, const Block& block) {
    bool is_leaf = true;
    ForEachCell(store, block, [&](const Node& cell) { is_leaf = is_leaf && cell.IsLeaf(); });
    return is_leaf;
  }
  static uint32_t UsedOf(const Store& store, const Block& block) {
    uint32_t used = 0;
    ForEachCell(store, block, [&](const Node& cell) {
      used = std::max(used, cell.last_used.load(std::memory_order_relaxed));
    });
    return used;
  }
  // A block without others below it, at or below this one.
  static Block LeafOf(const Store& store, Block block) {
    while (!IsLeaf(store, block)) {
      Node* next = nullptr;
      ForEachCell(store, block, [&](Node& cell) { next = cell.IsLeaf() ? next : &cell; });
      block.parent = next;
    }
    return block;
  }

  // Takes blocks away, and tells the policy that they went.
  void TakeVictims(Store& store, uint64_t target, uint32_t pinned,
                   typename Store::Removed& removed) {
    // Those that were not taken for being in use or no leaf; in the end, none is any more.
    size_t spared = 0;
    while (store.byte_size() - removed.bytes() + ByteSize() > target && !held_.empty()) {
      const uint64_t picked = policy_->PickVictim();
      Block block = held_.at(picked);
      const bool may_spare = spared <= kMostSpared * held_.size();
      if (may_spare && (!IsLeaf(store, block) || UsedOf(store, block) >= pinned)) {
        policy_->Spare(picked);
        ++spared;
        continue;
      }
      block = LeafOf(store, block);
      const uint64_t id = IdOf(block);
      const bool taken = block.parent != nullptr
                             ? store.TryTakeChildren(block.object, *block.parent, removed)
                             : store.TryTakeTree(block.object, removed);
      if (!taken && !may_spare) return;  // builders own what is left
      if (!taken) {
        policy_->Spare(picked);
        ++spared;
        continue;
      }
      // A block that was never booked is no item of the policy.
      if (held_.erase(id) > 0) policy_->Evict(id);
    }
  }

  const uint64_t kind_;
  const BuildCosts& costs_;
  std::string policy_name_;
  std::unique_ptr<EvictionPolicy> policy_;  // null: not started
  Held held_;                               // by id
};

}  // namespace linetree
