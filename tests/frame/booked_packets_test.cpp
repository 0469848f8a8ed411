// Packets that are booked again without being traced: as if they had been rendered again.
#include "core/frame/booked_packets.h"

#include <gtest/gtest.h>

#include <bit>

#include "core/frame/frame_kernels.h"
#include "tests/support/demo_scenes.h"

namespace linetree {
namespace {

constexpr int kSide = 4 * kBlockSide;
constexpr uint64_t kAll = ~uint64_t{0};

// A frame of which all packets are booked, in blocks that are rendered with what the trees know.
class BookedPacketsTest : public testing::Test {
 protected:
  // `used`: what blocks are rendered with, one after the other; null: something new for each.
  std::vector<BookedPackets> Render(FramePlan& plan, uint64_t tiles = kAll,
                                    PacketWorkspace* used = nullptr) {
    const EyeRays eye_rays(scene_->cameras[0], kSide, kSide);
    std::vector<float> radiance(3 * kSide * kSide);
    const PixelTarget target = {radiance.data()};
    std::vector<BookedPackets> booked;
    for (int row = 0; row < kSide; row += kBlockSide) {
      for (int column = 0; column < kSide; column += kBlockSide) {
        PacketWorkspace fresh;
        PacketWorkspace& workspace = used != nullptr ? *used : fresh;
        PacketCounts counts;
        const SurfaceCache::Reader reader(surfaces_, kEpsilon);
        const PacketTracer::Region region = {column, row, kBlockSide, kBlockSide};
        const BlockTask task = {eye_rays, region, limits_, kSide, target, true};
        RenderFrameBlockWide(packets_.scene(), task, reader, plan, Asking::kPlanned,
                             &booked.emplace_back(BookedPackets{tiles}), workspace, counts);
      }
    }
    return booked;
  }
  void BookAgain(const std::vector<BookedPackets>& booked, FramePlan& plan) {
    for (const BookedPackets& block : booked) {
      PacketWorkspace workspace;
      const SurfaceCache::Reader reader(surfaces_, kEpsilon);
      BookAgainWide(packets_.scene(), block, reader, plan, workspace);
    }
  }
  uint64_t Grow() {
    return surfaces_.Refine(1, [](size_t count, const std::function<void(size_t)>& body) {
      for (size_t i = 0; i < count; ++i) body(i);
    });
  }
  // Readers may only look; nobody else is here.
  uint64_t CountUses() {
    const SurfaceCache::Reader reader(surfaces_);
    uint64_t uses = 0;
    for (size_t object = 0; object < scene_->objects.size(); ++object) {
      auto* tree = const_cast<SurfaceTree*>(reader.TreeOf(object));
      if (tree == nullptr) continue;
      tree->cells().ForEach([&](const SurfaceNode& node) { uses += node.uses; });
    }
    return uses;
  }
  FramePlan Plan() const { return FramePlan(scene_->objects.size()); }

  // What both know of the objects; the number of those of which anything is known.
  static size_t CountEqual(FramePlan& a, FramePlan& b) {
    size_t known = 0;
    const FramePlan::Booked one = a.Decide(), other = b.Decide();
    EXPECT_EQ(one.classical, other.classical);
    EXPECT_EQ(one.promised, other.promised);
    EXPECT_EQ(one.saved, other.saved);
    for (size_t object = 0; object < a.objects(); ++object) {
      const FramePlan::Known first = a.KnownOf(object), second = b.KnownOf(object);
      EXPECT_EQ(first.points, second.points) << object;
      EXPECT_EQ(first.asked, second.asked) << object;
      EXPECT_EQ(first.classical, second.classical) << object;
      EXPECT_EQ(a.Pays(object), b.Pays(object)) << object;
      known += first.points > 0 ? 1 : 0;
    }
    return known;
  }

  // Enough lights for trees to pay.
  static std::shared_ptr<const Scene> LitScene() {
    auto scene = std::make_shared<Scene>(*test::BallsOnFloor(12, 80));
    for (int i = 0; i < 12; ++i) scene->lights.push_back(test::PointLight({i - 6.0, 2, 9}));
    return scene;
  }

  static constexpr double kEpsilon = 0.1;
  const std::shared_ptr<const Scene> scene_ = LitScene();
  const Tracer tracer_{*scene_};
  const PacketTracer packets_{tracer_};
  const PathLimits limits_;
  SurfaceCache surfaces_{tracer_, uint64_t{64} << 20};
};

TEST_F(BookedPacketsTest, WithTheSameTreesTheyCostTheSame) {
  FramePlan rendered = Plan(), again = Plan();
  BookAgain(Render(rendered), again);
  EXPECT_GT(CountEqual(rendered, again), 8u);
  for (int i = 0; i < 3; ++i) {
    FramePlan grown = Plan(), grown_again = Plan();
    const std::vector<BookedPackets> booked = Render(grown);
    BookAgain(booked, grown_again);
    EXPECT_GT(CountEqual(grown, grown_again), 8u) << "after " << i;
    Grow();
  }
  EXPECT_GT(surfaces_.CellCount(), 12u);
}

// Threads have done what comes, and remember it.
TEST_F(BookedPacketsTest, TheyCostTheSameWhateverTheThreadHasDone) {
  PacketWorkspace used;
  FramePlan one = Plan(), other = Plan();
  Render(one, kAll, &used);
  Render(other);
  EXPECT_GT(CountEqual(one, other), 8u);
}

// Trees that were planted after the packets had been traced learn from them where cells are wanted.
TEST_F(BookedPacketsTest, TheyAskForCells) {
  FramePlan plan = Plan();
  const std::vector<BookedPackets> booked = Render(plan);
  EXPECT_EQ(Grow(), 0u) << "there was no tree to ask";
  EXPECT_EQ(Grow(), 0u) << "nobody has asked";
  BookAgain(booked, plan);
  EXPECT_GT(Grow(), 12u);
  EXPECT_EQ(Grow(), 0u) << "nobody has asked again";
}

// Once the cells are there, what they save is known.
TEST_F(BookedPacketsTest, WhatWasPromisedIsSeenToBeSaved) {
  FramePlan plan = Plan();
  const std::vector<BookedPackets> booked = Render(plan);
  const FramePlan::Booked first = plan.Decide();
  EXPECT_GT(first.promised, 0);
  EXPECT_EQ(first.saved, 0);
  Grow();
  BookAgain(booked, plan);
  plan.Decide();
  Grow();
  FramePlan after = Plan();
  BookAgain(booked, after);
  const FramePlan::Booked then = after.Decide();
  EXPECT_EQ(then.classical, first.classical);
  EXPECT_GT(then.saved, 0);
  EXPECT_LT(then.promised, first.promised);
}

// One booked packet stands for many: those beside it must not count as well.
TEST_F(BookedPacketsTest, OthersOfTheirBlocksAreNotCounted) {
  FramePlan plan(scene_->objects.size(), /*always=*/true);
  const std::vector<BookedPackets> booked = Render(plan);
  Grow();
  BookAgain(booked, plan);
  Grow();
  ASSERT_GT(surfaces_.CellCount(), 12u);
  EXPECT_EQ(CountUses(), 0u);
  uint64_t lanes = 0;
  for (const BookedPackets& block : Render(plan, /*tiles=*/1)) {
    for (const BookedPacket& packet : block.packets) {
      lanes += static_cast<uint64_t>(std::popcount(packet.lanes));
    }
  }
  EXPECT_GT(CountUses(), 0u);
  EXPECT_LE(CountUses(), lanes);
}

}  // namespace
}  // namespace linetree
