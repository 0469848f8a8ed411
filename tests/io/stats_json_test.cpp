#include "core/io/stats_json.h"

#include <gtest/gtest.h>

#include <limits>

namespace linetree {
namespace {

FrameStats MakeStats() {
  FrameStats stats;
  stats.pixels = 100;
  stats.interpolated = 60;
  stats.traced = 20;
  stats.background = 20;
  stats.base = {
      .eye = 100, .reflected = 11, .refracted = 12, .shadow = 13, .intersect = 14, .shade = 15};
  stats.ip = {.eye = 1, .reflected = 2, .refracted = 3, .shadow = 4, .intersect = 5, .shade = 6};
  for (size_t i = 0; i < stats.verdicts.size(); ++i) stats.verdicts[i] = i * i;
  stats.cells_tried = 31;
  stats.cells_accepted = 32;
  stats.cells_evicted = 33;
  stats.cache_bytes = 34;
  stats.wall_ms = 1.5;
  stats.cpu_ms = 2.5;
  return stats;
}

// The keys that scripts rely on; a new one is welcome, a missing one is not.
TEST(StatsJson, HasEveryKeyOfTheContract) {
  const nlohmann::json json = StatsJson(MakeStats(), 10, 10);
  for (const char* key :
       {"width",          "height",       "pixels",      "eye_rays",       "reflected_rays",
        "refracted_rays", "shadow_rays",  "intersect",   "shade",          "base_intersect",
        "base_shade",     "ip_intersect", "ip_shade",    "interpolated",   "traced",
        "background",     "verdicts",     "cells_tried", "cells_accepted", "cells_evicted",
        "cache_bytes",    "wall_ms",      "cpu_ms"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
  EXPECT_EQ(json["verdicts"].size(), static_cast<size_t>(kVerdictCount));
  EXPECT_EQ(json["verdicts"]["self_shadow"], 9);
}

TEST(StatsJson, AddsUp) {
  const nlohmann::json json = StatsJson(MakeStats(), 10, 10);
  EXPECT_EQ(
      json["interpolated"].get<int>() + json["traced"].get<int>() + json["background"].get<int>(),
      json["pixels"].get<int>());
  EXPECT_EQ(json["intersect"], 19);
  EXPECT_EQ(json["shade"], 21);
  EXPECT_EQ(json["base_intersect"], 14);
  EXPECT_EQ(json["ip_shade"], 6);
  EXPECT_EQ(json["eye_rays"], 101);
  EXPECT_EQ(json["shadow_rays"], 17);
  EXPECT_EQ(json["cache_bytes"], 34);
  EXPECT_EQ(json["wall_ms"], 1.5);
}

TEST(StatsJson, HitRateLeavesTheBackgroundOut) {
  EXPECT_EQ(HitRate(MakeStats()), 0.75);
  EXPECT_EQ(HitRate(FrameStats{}), 0);
}

TEST(StatsJson, InfinityIsNull) {
  EXPECT_TRUE(JsonNumber(std::numeric_limits<double>::infinity()).is_null());
  EXPECT_EQ(JsonNumber(2.5), 2.5);
}

}  // namespace
}  // namespace linetree
