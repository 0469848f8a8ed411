#include "server/secrets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/io/temp_dir.h"

namespace linetree {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr char kOld[] = "the-token-of-old";
constexpr char kNew[] = "the-token-of-now";

class SecretsTest : public testing::Test {
 protected:
  SecretsTest() { Write(kOld); }
  void Write(const std::string& token) {
    std::ofstream(dir_.File("tokens")) << "admin " << token << "\n";
  }

  TempDir dir_;
};

TEST_F(SecretsTest, WhatIsNotAskedForIsNotThere) {
  const auto secrets = Secrets::Read({}, "");
  ASSERT_TRUE(secrets.ok());
  EXPECT_EQ((*secrets)->tls(), nullptr);
  EXPECT_EQ((*secrets)->tokens(), nullptr);
  EXPECT_TRUE((*secrets)->Reload().tls.ok());
  EXPECT_TRUE((*secrets)->Reload().tokens.ok());
  EXPECT_EQ((*secrets)->tokens(), nullptr);
}

TEST_F(SecretsTest, TokensAreReadAnewWhenAskedTo) {
  const auto secrets = Secrets::Read({}, dir_.File("tokens"));
  ASSERT_TRUE(secrets.ok());
  const auto held = (*secrets)->tokens();  // by a call that is under way
  Write(kNew);
  EXPECT_EQ((*secrets)->tokens()->RoleOf(kOld), Role::kAdmin);
  EXPECT_TRUE((*secrets)->Reload().tokens.ok());
  EXPECT_EQ((*secrets)->tokens()->RoleOf(kOld), std::nullopt);
  EXPECT_EQ((*secrets)->tokens()->RoleOf(kNew), Role::kAdmin);
  EXPECT_EQ(held->RoleOf(kOld), Role::kAdmin);
}

TEST_F(SecretsTest, TheOldOnesStayWhereTheNewOnesAreBad) {
  const auto secrets = Secrets::Read({}, dir_.File("tokens"));
  ASSERT_TRUE(secrets.ok());
  Write("short");
  EXPECT_THAT(std::string((*secrets)->Reload().tokens.message()), HasSubstr("tokens:1: expected"));
  EXPECT_EQ((*secrets)->tokens()->RoleOf(kOld), Role::kAdmin);
  std::filesystem::remove(dir_.File("tokens"));
  EXPECT_THAT(std::string((*secrets)->Reload().tokens.message()), StartsWith("--token-file: "));
  EXPECT_EQ((*secrets)->tokens()->RoleOf(kOld), Role::kAdmin);
}

TEST_F(SecretsTest, NothingBeginsWithBadOnes) {
  EXPECT_THAT(std::string(Secrets::Read({}, "nowhere").status().message()),
              StartsWith("--token-file: "));
  EXPECT_THAT(std::string(Secrets::Read({dir_.File("tokens"), "", ""}, "").status().message()),
              StartsWith("--tls-cert: "));
}

}  // namespace
}  // namespace linetree
