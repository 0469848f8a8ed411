// Trees of a scene: who owns a cell keeps it, and what is counted is what is there.
#include "core/cache/tree_store.h"

#include <gtest/gtest.h>

#include "core/cache/owned_node.h"
#include "core/tree/surface_tree.h"
#include "tests/support/demo_scenes.h"

namespace linetree {
namespace {

constexpr uint64_t kPlenty = 10'000'000;
using Store = TreeStore<SurfaceTree>;

class TreeStoreTest : public testing::Test {
 protected:
  TreeStoreTest() : scene_(test::BallsOnFloor(3, 90)), store_(*scene_, kPlenty, evicted_) {
    store_.Want(0);
    store_.PlantWanted(/*now=*/1, kPlenty, [](size_t) { return true; });
  }

  SurfaceNode& Root() { return store_.Get(0)->cells().Root(0); }
  SurfaceNode& Child(SurfaceNode& node, size_t c) { return (*node.children)[c]; }
  void Publish(SurfaceNode& node) {
    std::unique_ptr<const CellLights> lights = std::make_unique<CellLights>();
    ASSERT_TRUE(store_.Publish(0, node, std::move(lights), kPlenty));
  }
  void Divide(SurfaceNode& node) { ASSERT_TRUE(store_.Divide(0, node, 1, kPlenty)); }
  void ExpectExactCounts() {
    EXPECT_EQ(store_.byte_size(), store_.CountBytes());
    store_.ForEachTree([](size_t, SurfaceTree& tree) {
      EXPECT_EQ(tree.cells().counts().cells, tree.cells().Recount().cells);
      EXPECT_EQ(tree.cells().counts().bytes, tree.cells().Recount().bytes);
    });
  }

  const std::shared_ptr<const Scene> scene_;
  EvictedCounter evicted_;
  Store store_;
};

TEST_F(TreeStoreTest, CountsWhatComesAndGoes) {
  Publish(Root());
  Divide(Root());
  for (size_t c = 0; c < 4; ++c) Publish(Child(Root(), c));
  ExpectExactCounts();
  EXPECT_EQ(store_.cell_count(), 5u);
  const uint64_t before = store_.byte_size();
  Store::Removed removed;
  ASSERT_TRUE(store_.TryTakeChildren(0, Root(), removed));
  EXPECT_TRUE(Root().IsLeaf());
  EXPECT_EQ(store_.byte_size(), before) << "readers may still look at it";
  store_.Dispose(removed);
  ExpectExactCounts();
  EXPECT_EQ(store_.cell_count(), 1u);
  EXPECT_EQ(evicted_.now().cells, 4u);
  EXPECT_EQ(evicted_.now().bytes, before - store_.byte_size());
}

TEST_F(TreeStoreTest, WhatSomebodyOwnsStays) {
  Divide(Root());
  Store::Removed removed;
  {
    const OwnedNode<SurfaceNode> owned(Child(Root(), 2));
    ASSERT_TRUE(owned);
    EXPECT_FALSE(store_.TryTakeChildren(0, Root(), removed));
    EXPECT_FALSE(OwnedNode<SurfaceNode>(Child(Root(), 2))) << "one owner at a time";
    store_.Evict(0);
    EXPECT_NE(store_.Get(0), nullptr);
    EXPECT_FALSE(Root().IsLeaf());
  }
  for (size_t c = 0; c < 4; ++c) {
    EXPECT_FALSE(Child(Root(), c).claimed) << "given back by those who failed";
  }
  EXPECT_TRUE(store_.TryTakeChildren(0, Root(), removed));
  store_.Dispose(removed);
  ExpectExactCounts();
}

TEST_F(TreeStoreTest, BlocksGoLeafFirst) {
  Divide(Root());
  Divide(Child(Root(), 1));
  Store::Removed removed;
  EXPECT_FALSE(store_.TryTakeChildren(0, Root(), removed));
  EXPECT_FALSE(store_.TryTakeTree(0, removed));
  EXPECT_TRUE(store_.TryTakeChildren(0, Child(Root(), 1), removed));
  EXPECT_TRUE(store_.TryTakeChildren(0, Root(), removed));
  EXPECT_TRUE(store_.TryTakeTree(0, removed));
  EXPECT_EQ(store_.Get(0), nullptr);
  store_.Dispose(removed);
  ExpectExactCounts();
}

TEST_F(TreeStoreTest, WhatIsDividedIsNobodysToOwn) {
  Divide(Root());
  EXPECT_FALSE(OwnedNode<SurfaceNode>(Root()));
  EXPECT_FALSE(Root().claimed);
}

TEST_F(TreeStoreTest, TakesNoMoreThanThereIsRoomFor) {
  const uint64_t held = store_.byte_size();
  EXPECT_FALSE(store_.Divide(0, Root(), 1, held + sizeof(Store::Children) - 1));
  std::unique_ptr<const CellLights> lights = std::make_unique<CellLights>();
  EXPECT_FALSE(store_.Publish(0, Root(), std::move(lights), held + sizeof(CellLights) - 1));
  ExpectExactCounts();
  EXPECT_EQ(store_.byte_size(), held);
}

}  // namespace
}  // namespace linetree
