// The bytes that are reported are those that are allocated: this program counts them itself.
#include "core/render/scene_memory.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>
#include <optional>
#include <thread>

#include "core/render/scene_host.h"
#include "tests/support/demo_scenes.h"

namespace {

std::atomic<uint64_t> live_bytes{0};

// In front of what is handed out, as large as any alignment in use.
constexpr size_t kHeader = 64;

void* Allocate(size_t size) {
  void* block = std::aligned_alloc(kHeader, (size + 2 * kHeader - 1) / kHeader * kHeader);
  if (block == nullptr) throw std::bad_alloc();
  *static_cast<size_t*>(block) = size;
  live_bytes += size;
  return static_cast<char*>(block) + kHeader;
}

void Release(void* memory) {
  if (memory == nullptr) return;
  void* block = static_cast<char*>(memory) - kHeader;
  live_bytes -= *static_cast<size_t*>(block);
  std::free(block);
}

}  // namespace

void* operator new(size_t size) { return Allocate(size); }
void* operator new(size_t size, std::align_val_t) { return Allocate(size); }
void operator delete(void* memory) noexcept { Release(memory); }
void operator delete(void* memory, size_t) noexcept { Release(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { Release(memory); }
void operator delete(void* memory, size_t, std::align_val_t) noexcept { Release(memory); }

namespace linetree {
namespace {

// By a thread that ends with it: what threads keep to work with is no part of a cache.
const ParallelLoop kByAnother = [](size_t count, const std::function<void(size_t)>& body) {
  std::thread([&] {
    for (size_t i = 0; i < count; ++i) body(i);
  }).join();
};

TEST(SceneMemoryTest, PacketsAreCountedExactly) {
  const auto scene = test::BallsOnFloor(40, 90);
  const Tracer tracer(*scene);
  const uint64_t before = live_bytes;
  const auto packets = std::make_unique<const PacketTracer>(tracer);
  EXPECT_EQ(live_bytes - before, packets->ByteSize());
}

TEST(SceneMemoryTest, ThePlannerIsCountedExactly) {
  const uint64_t before = live_bytes;
  const auto plan = std::make_unique<const FramePlan>(100);
  EXPECT_EQ(live_bytes - before, plan->ByteSize());
}

// What grows with the trees is all in their bytes.
TEST(SceneMemoryTest, SurfaceTreesAreCountedExactly) {
  const auto scene = test::BallsOnFloor(20, 90);
  const Tracer tracer(*scene);
  SurfaceCache cache(tracer, 100'000'000, /*min_uses=*/4);
  const EyeRays rays(scene->cameras[0], 64, 64);
  const auto ask = [&] {
    const SurfaceCache::Reader reader(cache);
    for (int p = 0; p < 64 * 64; ++p) {
      const Ray ray = rays.ThroughPixel(p % 64, p / 64);
      const Hit hit = tracer.Intersect(ray.origin, ray.direction, {});
      if (hit.IsHit()) reader.Find(hit);
    }
  };
  const uint64_t before = live_bytes - cache.ByteSize();
  for (int i = 0; i < 4; ++i) {
    ask();
    cache.Refine(1, kByAnother);
    EXPECT_EQ(live_bytes - before, cache.ByteSize());
  }
  EXPECT_GT(cache.CellCount(), 100u);
}

TEST(SceneMemoryTest, CellsHaveAPrice) {
  EXPECT_EQ((MemoryPart{"", 100, 0, true}.BytesPerCell()), 0);
  EXPECT_EQ((MemoryPart{"", 100, 4, true}.BytesPerCell()), 25);
  EXPECT_EQ(BytesOf({{"a", 3}, {"b", 4, 2, true}}), 7u);
  EXPECT_EQ(CellsOf({{"a", 3}, {"b", 4, 2, true}}), 2u);
}

}  // namespace
}  // namespace linetree
