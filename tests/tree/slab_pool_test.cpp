#include "core/tree/slab_pool.h"

#include <gtest/gtest.h>

#include <vector>

namespace linetree {
namespace {

TEST(SlabPoolTest, RecordsDoNotMoveAndAreUsedAgain) {
  SlabPool<int> pool;
  const uint32_t first = pool.Allocate();
  int* address = &pool[first];
  *address = 7;
  std::vector<uint32_t> handles;
  for (uint32_t i = 0; i < 3 * SlabPool<int>::kSlabRecords; ++i) handles.push_back(pool.Allocate());
  EXPECT_EQ(address, &pool[first]);
  EXPECT_EQ(pool[first], 7);
  EXPECT_EQ(pool.in_use(), handles.size() + 1);
  pool[handles[10]] = 3;
  pool.Free(handles[10]);
  const uint32_t again = pool.Allocate();
  EXPECT_EQ(again, handles[10]);
  EXPECT_EQ(pool[again], 0);
}

TEST(SlabPoolDeathTest, AHandleThatWasNeverGivenOutIsABug) {
  SlabPool<int> pool;
  EXPECT_DEATH(pool.Free(1), "check failed");
}

}  // namespace
}  // namespace linetree
