#include "core/cache/sample_store.h"

#include <gtest/gtest.h>

namespace linetree {
namespace {

SampleStore::Sample SampleWithNodes(size_t nodes) {
  auto sample = std::make_shared<CornerSample>();
  sample->hits = true;
  sample->tree.nodes.resize(nodes);
  return sample;
}
SampleKey Key(uint64_t grid) { return {grid, 0, 0, 1}; }

TEST(SampleStoreTest, NeverHoldsMoreThanItsLimit) {
  constexpr uint64_t kLimit = 100'000;
  SampleStore store(kLimit);
  for (uint64_t i = 0; i < 5000; ++i) {
    store.Put(Key(i), SampleWithNodes(i % 7));
    ASSERT_LE(store.ByteSize(), kLimit);
    ASSERT_EQ(store.ByteSize(), store.CountBytes());
    if (i % 20 == 19) store.EndRound();
  }
  EXPECT_NE(store.Get(Key(4999)), nullptr) << "room was made for what is new";
  EXPECT_EQ(store.Get(Key(0)), nullptr);
}

TEST(SampleStoreTest, KeepsWhatIsUsed) {
  SampleStore store(100'000);
  store.Put(Key(1'000'000), SampleWithNodes(1));
  for (uint64_t i = 0; i < 2000; ++i) {
    ASSERT_NE(store.Get(Key(1'000'000)), nullptr) << i;
    store.Put(Key(i), SampleWithNodes(2));
    if (i % 10 == 9) store.EndRound();
  }
}

TEST(SampleStoreTest, ForestsGoApart) {
  SampleStore store(1'000'000);
  store.Put({1, 0, 0, 1}, SampleWithNodes(1));
  store.Put({1, 0, 0, 2}, SampleWithNodes(1));
  store.DropForest(1);
  EXPECT_EQ(store.Get({1, 0, 0, 1}), nullptr);
  EXPECT_NE(store.Get({1, 0, 0, 2}), nullptr);
  EXPECT_EQ(store.ByteSize(), store.CountBytes());
}

}  // namespace
}  // namespace linetree
