#include "client/command/peers_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace linetree {
namespace {

using testing::HasSubstr;
using testing::Not;

ScenePeers Example() {
  PeerRow classical;
  classical.peer = "classical";
  classical.version = "1.2";
  classical.timed = "the frame";
  classical.seconds = {1e-3, 2e-3, 4e-3};
  PeerRow other = classical;
  other.peer = "other";
  other.seconds = {4e-3};
  other.difference = {
      .rms = 0.125, .largest = 0.5, .share_beyond_code = 0.25, .share_beyond_5_percent = 0.0625};
  other.differences = {"no mirrors"};
  PeerRow again = other;
  again.threads = 2;
  PeerRow absent;
  absent.peer = "absent";
  absent.status = absl::UnavailableError("not installed: install the package x");
  return {"room", 100, 10, {classical, other, again, absent}};
}

TEST(PeersReport, TheTableHasARowForEveryPicture) {
  const std::string text = PeersTable(Example());
  EXPECT_THAT(text, testing::ContainsRegex("classical +1.2 +1 +2000 +1000 +4000 +1.00 "));
  EXPECT_THAT(text, testing::ContainsRegex(
                        "other +1.2 +2 +4000 +4000 +4000 +2.00 +0.12500 +25.00 % +6.25 %"));
  EXPECT_THAT(text, Not(HasSubstr("absent")));
}

TEST(PeersReport, NotesSayOnceWhatIsMissingAndWhatDiffers) {
  EXPECT_EQ(PeersNotes(Example()),
            "other differs: no mirrors\nabsent: not installed: install the package x\n");
}

TEST(PeersReport, JsonHoldsAllOfIt) {
  const nlohmann::json json = PeersJson({Example()}, 3);
  EXPECT_EQ(json["repeats"], 3);
  const nlohmann::json& scene = json["scenes"][0];
  EXPECT_EQ(scene["scene"], "room");
  EXPECT_EQ(scene["width"], 100);
  ASSERT_EQ(scene["peers"].size(), 4u);
  const nlohmann::json& first = scene["peers"][0];
  EXPECT_EQ(first["seconds"].size(), 3u);
  EXPECT_DOUBLE_EQ(first["ns_per_pixel"]["median"], 2000);
  EXPECT_DOUBLE_EQ(first["ns_per_pixel"]["min"], 1000);
  EXPECT_DOUBLE_EQ(first["ns_per_pixel"]["max"], 4000);
  EXPECT_EQ(scene["peers"][1]["difference"]["share_beyond_1_255"], 0.25);
  EXPECT_EQ(scene["peers"][1]["difference"]["on_purpose"][0], "no mirrors");
  EXPECT_EQ(scene["peers"][2]["threads"], 2);
  EXPECT_THAT(std::string(scene["peers"][3]["error"]), HasSubstr("install the package x"));
  EXPECT_FALSE(scene["peers"][3].contains("seconds"));
}

}  // namespace
}  // namespace linetree
