#include "core/render/worker_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

namespace linetree {
namespace {

TEST(WorkerPoolTest, RunsEveryIterationOnce) {
  for (const int threads : {1, 2, 5}) {
    WorkerPool pool(threads);
    for (const size_t count : {size_t{0}, size_t{1}, size_t{7}, size_t{1000}}) {
      std::vector<std::atomic<int>> runs(count);
      pool.ParallelFor(count, [&](size_t i) { ++runs[i]; });
      for (const auto& n : runs) ASSERT_EQ(n, 1);
    }
  }
}

TEST(WorkerPoolTest, CallsFromManyThreadsShareThePool) {
  WorkerPool pool(3);
  std::vector<std::thread> callers;
  std::atomic<size_t> sum = 0;
  for (int c = 0; c < 6; ++c) {
    callers.emplace_back([&] {
      for (int repeat = 0; repeat < 50; ++repeat) {
        std::vector<size_t> results(97);
        pool.ParallelFor(results.size(), [&](size_t i) { results[i] = i; });
        for (const size_t r : results) sum += r;
      }
    });
  }
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(sum, size_t{6} * 50 * 96 * 97 / 2);
}

TEST(WorkerPoolTest, CountsCpuTime) {
  WorkerPool pool(2);
  double cpu_ms = 0;
  std::atomic<double> sink = 0;
  pool.ParallelFor(
      64,
      [&](size_t i) {
        double x = static_cast<double>(i);
        for (int k = 0; k < 20000; ++k) x = x * 0.999 + 1;
        sink = x;
      },
      &cpu_ms);
  EXPECT_GT(cpu_ms, 0);
}

TEST(WorkerPoolTest, ZeroMeansTheHardwaresThreads) { EXPECT_GE(WorkerPool(0).threads(), 1); }

}  // namespace
}  // namespace linetree
