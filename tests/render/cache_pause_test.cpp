#include "core/render/cache_pause.h"

#include <gtest/gtest.h>

namespace linetree {
namespace {

// Of a cache that has room for none of its cells and knows nothing.
constexpr CacheYield kUseless = {.rays = 10'000, .known = 0, .tried = 100, .unkept = 100};

uint32_t CountPaused(CachePause& pause) {
  uint32_t count = 0;
  while (pause.Take()) ++count;
  return count;
}

TEST(CachePause, IsLongerAndLongerAsLongAsItIsInVain) {
  CachePause pause;
  EXPECT_EQ(CountPaused(pause), 0u);
  for (const uint32_t expected : {15, 31, 63, 127, 255, 255}) {
    pause.Note(kUseless);
    EXPECT_EQ(CountPaused(pause), expected);
  }
  CacheYield pays = kUseless;
  pays.known = 5000;
  pause.Note(pays);
  EXPECT_EQ(CountPaused(pause), 0u);
  pause.Note(kUseless);
  EXPECT_EQ(CountPaused(pause), 15u);
  pause.Note(kUseless);
  pause.Reset(CachePause::kLeastBytes);
  EXPECT_EQ(CountPaused(pause), 0u);
}

TEST(CachePause, HasNoEndForACacheOfNextToNothing) {
  CachePause pause;
  pause.Reset(CachePause::kLeastBytes - 1);
  for (int i = 0; i < 1000; ++i) EXPECT_TRUE(pause.Take());
  pause.Reset(CachePause::kLeastBytes);
  EXPECT_FALSE(pause.Take());
}

TEST(CachePause, NeedsWantOfRoomLittleKnowledgeAndEnoughRays) {
  CachePause pause;
  CacheYield has_room = kUseless;
  has_room.unkept = 50;
  pause.Note(has_room);
  EXPECT_EQ(CountPaused(pause), 0u) << "what is built may pay later";
  pause.Note({.rays = 10'000, .known = 0, .tried = 0, .unkept = 0});
  EXPECT_EQ(CountPaused(pause), 0u) << "nothing was asked for";
  CacheYield few = kUseless;
  few.rays = 1000;
  pause.Note(few);
  EXPECT_EQ(CountPaused(pause), 0u);
}

}  // namespace
}  // namespace linetree
