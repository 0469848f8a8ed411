#include "core/render/block_loop.h"

#include <gtest/gtest.h>

#include <atomic>

namespace linetree {
namespace {

TEST(BlockLoopTest, EveryBlockOnceWithOrWithoutProgress) {
  WorkerPool pool(3);
  for (const bool asks : {false, true}) {
    for (const size_t count : {size_t{1}, size_t{255}, size_t{256}, size_t{700}}) {
      std::vector<double> shares;
      const Progress progress = [&](double share) { shares.push_back(share); };
      double cpu_ms = 0;
      const Progress none;
      BlockLoop loop(pool, nullptr, asks ? progress : none, cpu_ms);
      std::vector<std::atomic<int>> runs(count);
      RayCounts rays;
      rays.eye = 5;
      loop.Run(count, 0.25, 0.5, rays, [&](size_t block, PacketWorkspace&, PacketCounts& counts) {
        ++runs[block];
        counts.rays.eye += block;
      });
      for (const auto& n : runs) ASSERT_EQ(n, 1);
      EXPECT_EQ(rays.eye, 5 + count * (count - 1) / 2);
      EXPECT_EQ(shares.size(), asks ? (count + 255) / 256 : 0);
      if (!asks) continue;
      EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
      EXPECT_GT(shares.front(), 0.25);
      EXPECT_DOUBLE_EQ(shares.back(), 0.5);
    }
  }
}

TEST(BlockLoopTest, NoBlockIsBegunOnceItIsCancelled) {
  WorkerPool pool(1);
  CancelToken cancel;
  double cpu_ms = 0;
  const Progress none;
  BlockLoop loop(pool, &cancel, none, cpu_ms);
  RayCounts rays;
  size_t runs = 0;
  const auto body = [&](size_t, PacketWorkspace&, PacketCounts&) {
    if (++runs == 7) cancel.Cancel();
  };
  loop.Run(100, 0, 1, rays, body);
  EXPECT_EQ(runs, 7u);
  EXPECT_TRUE(loop.IsCancelled());
  loop.Run(100, 0, 1, rays, body);
  EXPECT_EQ(runs, 7u);
}

// Two threads never have the same workspace at the same time.
TEST(BlockLoopTest, WorkspacesAreNobodyElses) {
  WorkerPool pool(4);
  double cpu_ms = 0;
  const Progress none;
  BlockLoop loop(pool, nullptr, none, cpu_ms);
  RayCounts rays;
  std::atomic<int> mixed = 0;
  loop.Run(500, 0, 1, rays, [&](size_t block, PacketWorkspace& workspace, PacketCounts&) {
    const auto mine = static_cast<float>(block);
    std::fill_n(workspace.radiance(), kBlockPixels, mine);
    for (int i = 0; i < kBlockPixels; ++i) mixed += workspace.radiance()[i] != mine ? 1 : 0;
  });
  EXPECT_EQ(mixed, 0);
}

}  // namespace
}  // namespace linetree
