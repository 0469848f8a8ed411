#include "core/io/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <climits>
#include <csignal>
#include <fstream>
#include <sstream>

#include "tests/io/temp_dir.h"

namespace linetree {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::string Content(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

// While it lives no file of this process grows beyond `bytes`: writes fail as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    old_handler_ = signal(SIGXFSZ, SIG_IGN);
    EXPECT_EQ(getrlimit(RLIMIT_FSIZE, &old_), 0);
    const rlimit limit{bytes, old_.rlim_max};
    EXPECT_EQ(setrlimit(RLIMIT_FSIZE, &limit), 0);
  }
  ~FileSizeLimit() {
    EXPECT_EQ(setrlimit(RLIMIT_FSIZE, &old_), 0);
    signal(SIGXFSZ, old_handler_);
  }

 private:
  rlimit old_{};
  void (*old_handler_)(int) = nullptr;
};

TEST(AtomicFile, WritesAndReplaces) {
  TempDir dir;
  ASSERT_EQ(WriteFileAtomically(dir.File("a"), "first, the longer one"), absl::OkStatus());
  ASSERT_EQ(WriteFileAtomically(dir.File("a"), "second"), absl::OkStatus());
  EXPECT_EQ(Content(dir.File("a")), "second");
  EXPECT_THAT(dir.Names(), ElementsAre("a"));
}

TEST(AtomicFile, WritesNamesAsLongAsTheSystemAllows) {
  TempDir dir;
  EXPECT_EQ(WriteFileAtomically(dir.File(std::string(NAME_MAX, 'n')), "x"), absl::OkStatus());
}

TEST(AtomicFile, KeepsTheModeOfWhatItReplaces) {
  TempDir dir;
  std::ofstream(dir.File("a")) << "old";
  ASSERT_EQ(chmod(dir.File("a").c_str(), 0640), 0);
  ASSERT_EQ(WriteFileAtomically(dir.File("a"), "new"), absl::OkStatus());
  struct stat info {};
  ASSERT_EQ(stat(dir.File("a").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 0777, 0640u);
}

TEST(AtomicFile, WritesThroughASymbolicLink) {
  TempDir dir;
  std::ofstream(dir.File("target")) << "old";
  std::filesystem::create_symlink("target", dir.path() / "link");
  ASSERT_EQ(WriteFileAtomically(dir.File("link"), "new"), absl::OkStatus());
  EXPECT_EQ(Content(dir.File("target")), "new");
  EXPECT_TRUE(std::filesystem::is_symlink(dir.path() / "link"));
}

TEST(AtomicFile, AFullDiskLeavesTheOldFile) {
  TempDir dir;
  ASSERT_EQ(WriteFileAtomically(dir.File("a"), "old"), absl::OkStatus());
  absl::Status status;
  {
    const FileSizeLimit limit(1000);
    status = WriteFileAtomically(dir.File("a"), std::string(5000, 'x'));
  }
  EXPECT_FALSE(status.ok());
  EXPECT_THAT(std::string(status.message()), HasSubstr("cannot write " + dir.File("a")));
  EXPECT_EQ(Content(dir.File("a")), "old");
  EXPECT_THAT(dir.Names(), ElementsAre("a"));
}

TEST(AtomicFile, AFullDeviceIsReportedAndStaysADevice) {
  const absl::Status status = WriteFileAtomically("/dev/full", "text");
  EXPECT_EQ(status.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_THAT(std::string(status.message()), HasSubstr("cannot write /dev/full: No space left"));
  EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

TEST(AtomicFile, AMissingFolderIsNotFound) {
  TempDir dir;
  EXPECT_EQ(WriteFileAtomically(dir.File("none/a"), "x").code(), absl::StatusCode::kNotFound);
}

TEST(AtomicFile, AFolderIsNoPlaceForAFile) {
  TempDir dir;
  const absl::Status status = WriteFileAtomically(dir.path().string(), "x");
  EXPECT_FALSE(status.ok());
  EXPECT_THAT(std::string(status.message()), HasSubstr("directory"));
}

TEST(AtomicFile, AReadOnlyFolderIsRefused) {
  // Root may write everywhere but into what the kernel owns.
  TempDir dir;
  std::string path = "/proc/linetree_test.exr";
  if (geteuid() != 0) {
    ASSERT_EQ(chmod(dir.path().c_str(), 0500), 0);
    path = dir.File("a");
  }
  const absl::Status status = WriteFileAtomically(path, "x");
  EXPECT_FALSE(status.ok());
  EXPECT_THAT(std::string(status.message()), HasSubstr("cannot write " + path));
  EXPECT_THAT(dir.Names(), IsEmpty());
  ASSERT_EQ(chmod(dir.path().c_str(), 0700), 0);
}

}  // namespace
}  // namespace linetree
