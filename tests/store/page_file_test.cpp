// What was committed is there; what is odd, full or somebody else's is an error that says so, and
// never the end of the process.
#include "core/store/page_file.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "core/store/page.h"
#include "tests/io/temp_dir.h"
#include "tests/support/random.h"

namespace linetree {
namespace {

constexpr uint64_t kMaxBytes = 8 << 20;
const SceneVersion kScene(32, '7');

std::string PageText(test::Random& random) {
  std::string text(static_cast<size_t>(8000 + random.Below(16'000)), ' ');
  for (char& c : text) c = static_cast<char>(random.Below(256));
  return text;
}

std::vector<PageWrite> Pages(test::Random& random, uint64_t first, int count) {
  std::vector<PageWrite> pages;
  for (uint64_t number = first; number < first + static_cast<uint64_t>(count); ++number) {
    const PageHead head{PageKind::kSurface, 5, kScene, {}, number, 1};
    pages.push_back({{kScene, 5, number}, SealPage(head, PageText(random))});
  }
  return pages;
}

absl::StatusOr<std::unique_ptr<PageFile>> Open(const TempDir& folder,
                                               PageFile::Access access = PageFile::Access::kWrite,
                                               std::string* odd = nullptr) {
  return PageFile::Open(folder.path().string() + "/cells", kMaxBytes, access, odd);
}

std::map<uint64_t, std::string> AllOf(const PageFile& file) {
  std::map<uint64_t, std::string> all;
  EXPECT_TRUE(file.ForEach(kScene, 5,
                           [&](const PageKey& key, std::string_view page) {
                             all[key.number] = std::string(page);
                           })
                  .ok());
  return all;
}

TEST(PageFile, KeepsWhatWasCommitted) {
  const TempDir folder;
  test::Random random(1);
  std::vector<PageWrite> pages = Pages(random, 1, 20);
  {
    const auto file = Open(folder);
    ASSERT_TRUE(file.ok()) << file.status();
    const SceneNote note{kScene, "room", 1234};
    ASSERT_TRUE((*file)->Write(pages, std::span(&note, 1)).ok());
    // The same number again takes its place.
    pages[3].page = Pages(random, 4, 1)[0].page;
    ASSERT_TRUE((*file)->Write(std::span(pages).subspan(3, 1)).ok());
  }
  const auto file = Open(folder, PageFile::Access::kReadOnly);
  ASSERT_TRUE(file.ok()) << file.status();
  const auto all = AllOf(**file);
  ASSERT_EQ(all.size(), pages.size());
  for (const PageWrite& page : pages) EXPECT_EQ(all.at(page.key.number), page.page);
  const auto notes = (*file)->Notes();
  ASSERT_TRUE(notes.ok() && notes->size() == 1);
  EXPECT_EQ((*notes)[0].name, "room");
  EXPECT_EQ((*notes)[0].last_used, 1234);
}

TEST(PageFile, HasOneWriterAtATime) {
  const TempDir folder;
  const auto first = Open(folder);
  ASSERT_TRUE(first.ok());
  EXPECT_TRUE(absl::IsFailedPrecondition(Open(folder).status()));
  EXPECT_TRUE(Open(folder, PageFile::Access::kReadOnly).ok());
}

TEST(PageFile, SaysThatItIsFullAndIsAsItWas) {
  const TempDir folder;
  test::Random random(2);
  const auto file = Open(folder);
  ASSERT_TRUE(file.ok());
  absl::Status status;
  size_t written = 0;
  while ((status = (*file)->Write(Pages(random, written + 1, 4))).ok()) written += 4;
  EXPECT_TRUE(absl::IsResourceExhausted(status)) << status;
  EXPECT_TRUE(absl::IsResourceExhausted((*file)->Write(Pages(random, 1000, 2000))));
  EXPECT_EQ(AllOf(**file).size(), written);
  ASSERT_GT(written, 20U);
  // There is room left for taking pages out.
  const auto erased =
      (*file)->Erase([](const PageKey& key, std::string_view) { return key.number <= 10; });
  ASSERT_TRUE(erased.ok()) << erased.status();
  EXPECT_EQ(*erased, 10U);
  EXPECT_TRUE((*file)->Write(Pages(random, 1000, 5)).ok());
  EXPECT_EQ(AllOf(**file).size(), written - 5);
  // To the last byte; and then all of it again at once.
  for (uint64_t number = 2000; status.ok() || number == 2000;) {
    std::vector<PageWrite> small;
    while (small.size() < 200) small.push_back({{kScene, 5, number++}, "small"});
    status = (*file)->Write(small);
  }
  const auto all = (*file)->Erase([](const PageKey&, std::string_view) { return true; });
  ASSERT_TRUE(all.ok()) << all.status();
  EXPECT_TRUE((*file)->Write(Pages(random, 1, static_cast<int>(written) - 5)).ok());
}

TEST(PageFile, FindsNothingWhereNothingIs) {
  const TempDir folder;
  EXPECT_TRUE(absl::IsNotFound(Open(folder, PageFile::Access::kReadOnly).status()));
  const std::string file = folder.path().string() + "/file";
  std::ofstream(file) << "text";
  EXPECT_FALSE(PageFile::Open(file, kMaxBytes, PageFile::Access::kWrite).ok());
}

// Cut off, written over, or something else altogether: no page comes back that was not written.
TEST(PageFile, SurvivesWhateverHappensToTheFile) {
  test::Random random(3);
  int put_aside = 0;
  for (int round = 0; round < 40; ++round) {
    const TempDir folder;
    const std::vector<PageWrite> pages = Pages(random, 1, 30);
    {
      const auto file = Open(folder);
      ASSERT_TRUE(file.ok());
      ASSERT_TRUE((*file)->Write(pages).ok());
      ASSERT_TRUE(
          (*file)
              ->Erase([](const PageKey& key, std::string_view) { return key.number % 3 == 0; })
              .ok());
    }
    const std::string name = folder.path().string() + "/cells/data.mdb";
    const auto bytes = static_cast<int>(std::filesystem::file_size(name));
    if (round % 4 == 0) {
      std::filesystem::resize_file(name, static_cast<uintmax_t>(random.Below(bytes)));
    } else {
      std::fstream data(name, std::ios::in | std::ios::out | std::ios::binary);
      for (int n = 0; n < 1 << (round % 10); ++n) {
        data.seekp(random.Below(bytes));
        data.put(static_cast<char>(random.Below(256)));
      }
    }
    std::string odd;
    const auto file = Open(folder, PageFile::Access::kWrite, &odd);
    ASSERT_TRUE(file.ok()) << file.status();
    put_aside += odd.empty() ? 0 : 1;
    for (const auto& [number, page] : AllOf(**file)) {
      if (!OpenPage(page)) continue;
      ASSERT_LE(number, pages.size());
      EXPECT_EQ(page, pages[number - 1].page);
    }
    EXPECT_TRUE((*file)->Write(Pages(random, 100, 5)).ok());
  }
  EXPECT_GT(put_aside, 5);
  EXPECT_LT(put_aside, 40);
}

}  // namespace
}  // namespace linetree
