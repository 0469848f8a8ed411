#include "server/tokens.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/gate.h"

namespace linetree {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

constexpr char kTwo[] =
    "# who may call\n"
    "viewer  looks-and-no-more \r\n"
    "\n"
    "admin\tmay-do-everything # the operator\n";

TEST(TokensTest, EachTokenHasItsRole) {
  const auto tokens = Tokens::Parse(kTwo, "tokens");
  ASSERT_TRUE(tokens.ok()) << tokens.status();
  EXPECT_EQ(tokens->RoleOf("looks-and-no-more"), Role::kViewer);
  EXPECT_EQ(tokens->RoleOf("may-do-everything"), Role::kAdmin);
  for (const char* unknown : {"", "admin", "may-do-everythin", "may-do-everything ", "MAY-DO"}) {
    EXPECT_EQ(tokens->RoleOf(unknown), std::nullopt) << unknown;
  }
}

TEST(TokensTest, BadLinesAreNamed) {
  for (const auto& [text, where] : std::vector<std::pair<std::string, std::string>>{
           {"", "t:1: expected at least one line"},
           {"# nothing\n\n", "t:3: expected at least one line"},
           {"viewer\n", "t:1: expected 'viewer TOKEN'"},
           {"\nowner may-do-everything\n", "t:2: expected 'viewer TOKEN'"},
           {"admin may do everything\n", "t:1: expected 'viewer TOKEN'"},
           {"admin short\n", "t:1: expected a token of 16"},
           {"admin " + std::string(300, 'x') + "\n", "t:1: expected a token of 16"},
           {"admin gr\xc3\xbc\xc3\x9f-gott-mein-herr\n", "t:1: expected a token of 16"},
           {"admin may-do-everything\nviewer may-do-everything", "t:2: expected a token that"}}) {
    const auto status = Tokens::Parse(text, "t").status();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << text;
    EXPECT_THAT(std::string(status.message()), StartsWith(where));
    EXPECT_THAT(std::string(status.message()), testing::Not(HasSubstr("may-do-everything")));
  }
}

TEST(TokensTest, CallersAreToldWhatIsMissing) {
  const auto tokens = Tokens::Parse(kTwo, "tokens");
  ASSERT_TRUE(tokens.ok());
  const auto check = [&](const std::vector<absl::string_view>& values, Role needed) {
    return CheckCaller(*tokens, values, needed, "LoadScene");
  };
  EXPECT_TRUE(check({"Bearer may-do-everything"}, Role::kAdmin).ok());
  EXPECT_TRUE(check({"bearer may-do-everything"}, Role::kViewer).ok());
  EXPECT_TRUE(check({"Bearer looks-and-no-more"}, Role::kViewer).ok());
  const auto refused = check({"Bearer looks-and-no-more"}, Role::kAdmin);
  EXPECT_TRUE(absl::IsPermissionDenied(refused));
  EXPECT_THAT(std::string(refused.message()), HasSubstr("LoadScene expects a token of the role"));
  for (const std::vector<absl::string_view>& values :
       {std::vector<absl::string_view>{},
        {""},
        {"Bearer "},
        {"Bearer nobody-knows-this-one"},
        {"Basic may-do-everything"},
        {"may-do-everything"},
        {"Bearer may-do-everything", "Bearer may-do-everything"}}) {
    EXPECT_TRUE(absl::IsUnauthenticated(check(values, Role::kViewer)));
  }
}

}  // namespace
}  // namespace linetree
