#include "peers/peer_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace linetree {
namespace {

using testing::ElementsAre;

// What fake peers did, in order.
using Diary = std::vector<std::string>;

// Paints every pixel in one grey, takes as long as it is told, and fails in its n-th picture.
class FakePeer : public Peer {
 public:
  FakePeer(std::string name, float grey, int fails_at, Diary& diary)
      : name_(std::move(name)), grey_(grey), fails_at_(fails_at), diary_(diary) {}
  std::string Version() const override { return "1"; }
  std::string Timed() const override { return "nothing"; }
  absl::StatusOr<PeerPicture> Render(const Camera& /*camera*/, int width, int height) override {
    diary_.push_back(name_);
    if (++pictures_ == fails_at_) return absl::UnknownError(name_ + " broke");
    PeerPicture picture;
    picture.seconds = pictures_;
    picture.radiance.assign(3 * static_cast<size_t>(width * height), grey_);
    return picture;
  }

 private:
  const std::string name_;
  const float grey_;
  const int fails_at_;
  Diary& diary_;
  int pictures_ = 0;
};

PeerKind Fake(const std::string& name, float grey, int fails_at, Diary& diary) {
  return {name, [=, &diary](const PeerSetup& setup) -> absl::StatusOr<std::unique_ptr<Peer>> {
            return std::make_unique<FakePeer>(name + std::to_string(setup.threads), grey, fails_at,
                                              diary);
          }};
}

PeerStudyOptions Options() {
  PeerStudyOptions options;
  options.width = 2;
  options.height = 2;
  options.repeats = 3;
  return options;
}

TEST(StudyPeers, TakesTurnsAndComparesWithTheFirst) {
  Diary diary;
  PeerStudyOptions options = Options();
  options.thread_counts = {1, 2};
  std::vector<double> shares;
  const auto rows =
      StudyPeers({Fake("a", 0.5F, 0, diary), Fake("b", 0.75F, 0, diary)}, std::make_shared<Scene>(),
                 options, [&](double share) { shares.push_back(share); });
  EXPECT_THAT(diary,
              ElementsAre("a1", "a2", "b1", "b2", "a1", "a2", "b1", "b2", "a1", "a2", "b1", "b2"));
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[3].peer, "b");
  EXPECT_EQ(rows[3].threads, 2);
  EXPECT_THAT(rows[3].seconds, ElementsAre(1, 2, 3));
  EXPECT_EQ(rows[1].difference.largest, 0);
  EXPECT_EQ(rows[3].difference.largest, 0.25);
  EXPECT_EQ(shares.size(), 12u);
  EXPECT_EQ(shares.back(), 1);
}

TEST(StudyPeers, AFailureIsARowAndStopsNobodyElse) {
  Diary diary;
  const PeerKind absent{"absent", [](const PeerSetup&) -> absl::StatusOr<std::unique_ptr<Peer>> {
                          return absl::UnavailableError("not installed");
                        }};
  const auto rows = StudyPeers({Fake("a", 0.5F, 0, diary), Fake("b", 0.5F, 2, diary), absent},
                               std::make_shared<Scene>(), Options(), nullptr);
  EXPECT_THAT(diary, ElementsAre("a1", "b1", "a1", "b1", "a1"));
  EXPECT_EQ(rows[1].status.message(), "b1 broke");
  EXPECT_TRUE(rows[1].Failed());
  EXPECT_TRUE(rows[1].seconds.empty());
  EXPECT_EQ(rows[2].status.message(), "not installed");
  EXPECT_FALSE(rows[2].Failed());
  EXPECT_FALSE(rows[0].Failed());
}

TEST(PixelTime, IsTheMedianAndTheSpread) {
  const PixelTime odd = PixelTimeOf({3e-6, 1e-6, 8e-6}, 10, 10);
  EXPECT_DOUBLE_EQ(odd.median_ns, 30);
  EXPECT_DOUBLE_EQ(odd.min_ns, 10);
  EXPECT_DOUBLE_EQ(odd.max_ns, 80);
  EXPECT_DOUBLE_EQ(PixelTimeOf({4e-6, 2e-6}, 10, 10).median_ns, 30);
}

}  // namespace
}  // namespace linetree
