#include "server/scene_root.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>

#include "tests/io/temp_dir.h"

namespace linetree {
namespace {

class SceneRootTest : public testing::Test {
 protected:
  SceneRootTest() {
    std::filesystem::create_directories(root() + "/deep/er");
    std::ofstream(folder_.File("secret")) << "secret";
    std::ofstream(root() + "/top.nff") << "top";
    std::ofstream(root() + "/deep/er/leaf") << "leaf";
    std::filesystem::create_symlink("../secret", root() + "/link");
    std::filesystem::create_symlink("top.nff", root() + "/inner_link");
    std::filesystem::create_directory_symlink("..", root() + "/up");
    EXPECT_EQ(mkfifo((root() + "/pipe").c_str(), 0600), 0);
  }
  std::string root() const { return folder_.File("root"); }
  absl::StatusOr<std::string> Read(absl::string_view path, uint64_t max_bytes = 100) const {
    return ReadFileBelow(root(), path, max_bytes, "file");
  }

  TempDir folder_;
};

TEST_F(SceneRootTest, FilesBelowAreRead) {
  EXPECT_EQ(*Read("top.nff"), "top");
  EXPECT_EQ(*Read("deep/er/leaf"), "leaf");
  EXPECT_EQ(*Read("top.nff", 3), "top");
}

TEST_F(SceneRootTest, NothingLeadsOut) {
  const std::string with_null = std::string("top.nff") + '\0' + "x";
  for (const std::string& path :
       {std::string("../secret"), std::string("deep/../../secret"), folder_.File("secret"),
        std::string("/etc/passwd"), std::string("link"), std::string("inner_link"), std::string(""),
        std::string("."), std::string("deep//er/leaf"), std::string("./top.nff"), with_null}) {
    const auto status = Read(path).status();
    EXPECT_TRUE(absl::IsPermissionDenied(status)) << path << ": " << status;
    EXPECT_THAT(std::string(status.message()), testing::StartsWith("file:"));
  }
  // A link is no folder.
  EXPECT_FALSE(Read("up/secret").ok());
}

TEST_F(SceneRootTest, WhatIsNoSuchFileIsRefused) {
  EXPECT_TRUE(absl::IsNotFound(Read("gone").status()));
  EXPECT_TRUE(absl::IsNotFound(Read("top.nff/below").status()));
  EXPECT_TRUE(absl::IsNotFound(ReadFileBelow(folder_.File("none"), "a", 9, "file").status()));
  EXPECT_TRUE(absl::IsInvalidArgument(Read("deep").status()));
  EXPECT_TRUE(absl::IsInvalidArgument(Read("pipe").status()));
  EXPECT_TRUE(absl::IsResourceExhausted(Read("top.nff", 2).status()));
}

}  // namespace
}  // namespace linetree
