#include "server/limit_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <utility>

namespace linetree {
namespace {

// Counts the members of an aggregate: how many values it can be made of, at most.
struct Any {
  template <class T>
  operator T() const;  // NOLINT(google-explicit-constructor): that is what it is for
};
template <class T, class... Members>
consteval size_t MemberCount() {
  if constexpr (requires { T{Members{}..., Any{}}; }) {
    return MemberCount<T, Members..., Any>();
  } else {
    return sizeof...(Members);
  }
}

TEST(LimitListTest, EveryLimitIsListedOnce) {
  const auto list = ListLimits({});
  // Two of the members are groups.
  EXPECT_EQ(list.size(), MemberCount<ServerLimits>() - 2 + MemberCount<RenderLimits>() +
                             MemberCount<SceneLimits>());
  std::set<std::string_view> names;
  for (const NamedLimit& limit : list) {
    EXPECT_TRUE(names.insert(limit.name).second) << limit.name;
    EXPECT_GT(limit.bounds.size(), 8u) << limit.name;
    EXPECT_GT(limit.value, 0u) << limit.name;
  }
}

TEST(LimitListTest, ValuesAreThoseThatHold) {
  ServerLimits limits;
  limits.max_scenes = 3;
  limits.scene.max_lights = 5;
  limits.render.max_rays = 7;
  limits.retry_after_ms = std::chrono::milliseconds(11);
  std::set<std::pair<std::string_view, uint64_t>> found;
  for (const NamedLimit& limit : ListLimits(limits)) found.insert({limit.name, limit.value});
  EXPECT_TRUE(found.contains({"max_scenes", 3}));
  EXPECT_TRUE(found.contains({"scene.max_lights", 5}));
  EXPECT_TRUE(found.contains({"render.max_rays", 7}));
  EXPECT_TRUE(found.contains({"retry_after_ms", 11}));
}

}  // namespace
}  // namespace linetree
