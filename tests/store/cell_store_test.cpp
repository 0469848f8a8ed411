// What one host has learnt, another one knows, and answers with as the classical tracer does;
// whatever becomes of the disk.
#include "core/store/cell_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/io/temp_dir.h"
#include "tests/store/kept_scene.h"

namespace linetree {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

class Keeping : public testing::Test {
 protected:
  std::unique_ptr<CellStore> Open(uint64_t max_bytes = uint64_t{64} << 20) {
    auto store = CellStore::Open({.folder = folder_.path().string(), .max_bytes = max_bytes},
                                 [this](const std::string& line) { log_.push_back(line); });
    EXPECT_TRUE(store.ok()) << store.status();
    return *std::move(store);
  }
  static std::shared_ptr<ScenePages> Attach(CellStore& store, SceneHost& host) {
    auto pages = store.Attach("scene", test::CachesOf(host));
    host.Keep(pages);
    return pages;
  }
  void ExpectClassical(SceneHost& host) {
    for (const Lanes lanes : {Lanes::kScalar, Lanes::kSimd}) {
      const auto request = [&](Mode mode) { return test::Request(host.scene(), mode, lanes); };
      const Frame cached = test::RenderFrame(host, request(Mode::kCached), pool_);
      const Frame classical = test::RenderFrame(host, request(Mode::kClassical), pool_);
      EXPECT_EQ(cached.radiance, classical.radiance);
    }
  }

  const TempDir folder_;
  std::vector<std::string> log_;
  WorkerPool pool_{2};
};

TEST_F(Keeping, ARestartedHostKnowsWhatTheFormerOneLearnt) {
  for (const uint64_t seed : {1, 2, 3}) {
    const auto scene = test::SceneOf(seed);
    const auto first = test::HostOf(scene);
    const auto second = test::HostOf(scene);
    {
      const auto store = Open();
      const auto pages = Attach(*store, *first);
      test::Learn(*first, pool_);
      store->Flush();
      EXPECT_GE(pages->counts().cells_written, test::CellsOf(*first));
      EXPECT_EQ(pages->counts().cells_restored, 0U);
    }
    const uint64_t learnt = test::CellsOf(*first);
    ASSERT_GT(learnt, 100U);
    const auto store = Open();
    const auto pages = Attach(*store, *second);
    EXPECT_EQ(test::CellsOf(*second), learnt);
    EXPECT_EQ(pages->counts().cells_restored, learnt);
    EXPECT_EQ(second->surfaces().ByteSize(), second->surfaces().CountBytes());
    EXPECT_EQ(second->paths().ByteSize(), second->paths().CountBytes());
    // Of one request, as many searches are saved, but for cells that the first host was about to
    // divide.
    const auto searches = [&](SceneHost& host, Mode mode) {
      const Frame frame = test::RenderFrame(host, test::Request(*scene, mode), pool_);
      return static_cast<double>(frame.stats.base.intersect);
    };
    const double classical = searches(*first, Mode::kClassical);
    const double known = searches(*first, Mode::kCached);
    EXPECT_LT(known, 0.9 * classical);
    EXPECT_NEAR(searches(*second, Mode::kCached), known, 0.01 * classical);
    ExpectClassical(*second);
  }
  EXPECT_THAT(log_, IsEmpty());
}

TEST_F(Keeping, GoesOnWithWhatIsThereAndWritesNothingTwice) {
  const auto scene = test::SceneOf(4);
  uint64_t cells = 0;
  for (int run = 0; run < 3; ++run) {
    const auto store = Open();
    const auto host = test::HostOf(scene);
    const auto pages = Attach(*store, *host);
    EXPECT_EQ(pages->counts().cells_restored, cells);
    for (int i = 0; i <= run; ++i) test::Learn(*host, pool_);
    host->surfaces().Clear();
    test::Learn(*host, pool_);  // cells that are on the disk already
    store->Flush();
    cells += pages->counts().cells_written;
    EXPECT_GT(cells, 100U);
  }
  const auto store = Open();
  const auto host = test::HostOf(scene);
  EXPECT_EQ(Attach(*store, *host)->counts().cells_restored, cells);
  EXPECT_EQ(test::CellsOf(*host), cells);
  // A cache that knows them already stays as it is.
  Attach(*store, *host);
  EXPECT_EQ(test::CellsOf(*host), cells);
  EXPECT_EQ(host->surfaces().ByteSize(), host->surfaces().CountBytes());
}

TEST_F(Keeping, OtherContentHasOtherCells) {
  const auto store = Open();
  const auto host = test::HostOf(test::SceneOf(5));
  Attach(*store, *host);
  test::Learn(*host, pool_);
  store->Flush();
  const auto other = test::HostOf(test::SceneOf(6));
  EXPECT_EQ(Attach(*store, *other)->counts().cells_restored, 0U);
  ExpectClassical(*other);
}

TEST_F(Keeping, TakesBackWhatTheBudgetHasRoomFor) {
  const auto scene = test::SceneOf(7);
  {
    const auto store = Open();
    const auto host = test::HostOf(scene);
    Attach(*store, *host);
    test::Learn(*host, pool_);
  }
  CacheOptions options;
  options.memory_bytes = 64 << 10;
  SceneHost host(scene, options);
  const auto store = Open();
  const auto pages = Attach(*store, host);
  EXPECT_GT(pages->counts().cells_restored, 0U);
  EXPECT_GT(pages->counts().cells_left, 0U);
  EXPECT_LE(host.CacheBytes(), options.memory_bytes);
  ExpectClassical(host);
}

TEST_F(Keeping, LeavesOddPagesOut) {
  const auto scene = test::SceneOf(8);
  {
    const auto store = Open();
    const auto host = test::HostOf(scene);
    Attach(*store, *host);
    test::Learn(*host, pool_);
  }
  // Sealed as if by this program, for this scene, but with a number beside its own, or with cells
  // of an object that the scene has not.
  {
    auto file =
        PageFile::Open(folder_.path().string(), uint64_t{64} << 20, PageFile::Access::kWrite);
    ASSERT_TRUE(file.ok());
    std::vector<PageWrite> odd;
    EXPECT_TRUE((*file)
                    ->ForEach([&](const PageKey& key, std::string_view page) {
                      if (!odd.empty()) return;
                      odd.push_back({{key.scene, key.algorithm, 1000}, std::string(page)});
                      odd.push_back({{key.scene, key.algorithm, 1001}, "no page"});
                      PageHead head = OpenPage(page)->head;
                      head.number = 1002;
                      std::string cells(OpenPage(page)->cells);
                      cells.replace(0, 4, "\x7f\x7f\x7f\x7f");
                      odd.push_back({{key.scene, key.algorithm, 1002}, SealPage(head, cells)});
                    })
                    .ok());
    ASSERT_TRUE((*file)->Write(odd).ok());
  }
  for (const uint64_t odd : {3, 0}) {
    const auto store = Open();
    const auto host = test::HostOf(scene);
    const auto pages = Attach(*store, *host);
    EXPECT_EQ(pages->counts().pages_odd, odd);
    EXPECT_GT(pages->counts().cells_restored, 100U);
    ExpectClassical(*host);
  }
  ASSERT_EQ(log_.size(), 1U);
  EXPECT_THAT(log_[0], HasSubstr("3 pages are not as they were written"));
}

TEST_F(Keeping, AFullFileCostsCellsAndALine) {
  const auto host = test::HostOf(test::SceneOf(9));
  const auto store = Open(uint64_t{256} << 10);
  const auto pages = Attach(*store, *host);
  for (int i = 0; i < 3; ++i) {
    test::Learn(*host, pool_);
    store->Flush();
  }
  EXPECT_GT(pages->counts().cells_lost, 0U);
  ASSERT_FALSE(log_.empty());
  EXPECT_THAT(log_[0], HasSubstr("cells are not kept until that is mended"));
  ExpectClassical(*host);
}

// A file that is full of scenes that nobody has loaded makes room for those that somebody has.
TEST_F(Keeping, AFullFileForgetsScenesThatNobodyUses) {
  constexpr uint64_t kBytes = uint64_t{2} << 20;
  for (uint64_t seed = 10; seed < 30 && log_.empty(); ++seed) {
    const auto host = test::HostOf(test::SceneOf(seed));
    const auto store = Open(kBytes);
    const auto pages = Attach(*store, *host);
    test::Learn(*host, pool_);
    store->Flush();
    EXPECT_EQ(pages->counts().cells_lost, 0U) << seed;
  }
  ASSERT_FALSE(log_.empty());
  EXPECT_THAT(log_[0], HasSubstr("pages of other programs and scenes go"));
}

}  // namespace
}  // namespace linetree
