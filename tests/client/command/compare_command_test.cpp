#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/io/exr.h"
#include "tests/client/command/program.h"
#include "tests/io/frames.h"

namespace linetree {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

class CompareCommand : public ::testing::Test {
 protected:
  // All pixels 1, but for `value` in pixel (1, 2) of a picture of 4 x 3.
  std::string Write(const std::string& name, float value, double promise = 0) {
    Frame frame = MakeFrame(4, 3);
    frame.white = 1;
    frame.max_relative_error = promise;
    std::fill(frame.radiance.begin(), frame.radiance.end(), 1.0f);
    frame.radiance[3 * 9] = value;
    EXPECT_EQ(WriteExr(frame, dir_.File(name)), absl::OkStatus());
    return dir_.File(name);
  }

  TempDir dir_;
};

TEST_F(CompareCommand, EqualPictures) {
  const Finished run = RunLinetree({"compare", Write("a.exr", 1), Write("b.exr", 1)});
  EXPECT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("max error        0 "), HasSubstr("PSNR             inf dB")));
}

TEST_F(CompareCommand, EpsilonDecides) {
  const std::string a = Write("a.exr", 1.5f);
  const std::string b = Write("b.exr", 1);
  const Finished beyond = RunLinetree({"compare", a, b, "--epsilon", "0.25"});
  EXPECT_EQ(beyond.exit_status, 1);
  EXPECT_EQ(beyond.err, "");
  EXPECT_THAT(beyond.out, AllOf(HasSubstr("max error        0.5 at pixel (1, 2)"),
                                HasSubstr("beyond 0.25      1\n")));
  EXPECT_EQ(RunLinetree({"compare", a, b, "--epsilon", "0.5"}).exit_status, 0);
}

TEST_F(CompareCommand, WithoutEpsilonThePromiseDecides) {
  const std::string b = Write("b.exr", 1);
  EXPECT_EQ(RunLinetree({"compare", Write("a.exr", 1.5f, 0.5), b}).exit_status, 0);
  EXPECT_EQ(RunLinetree({"compare", Write("a.exr", 1.5f, 0.25), b}).exit_status, 1);
}

TEST_F(CompareCommand, Json) {
  const Finished run =
      RunLinetree({"compare", Write("a.exr", 3), Write("b.exr", 1), "--json", "--epsilon", "1"});
  EXPECT_EQ(run.exit_status, 1);
  const nlohmann::json json = nlohmann::json::parse(run.out);
  EXPECT_EQ(json["max"], 2.0);
  EXPECT_EQ(json["beyond"], 1);
  EXPECT_EQ(json["floor"], 1.0 / 1024);
}

TEST_F(CompareCommand, NotANumberIsBeyond) {
  EXPECT_EQ(RunLinetree({"compare", Write("a.exr", std::nanf("")), Write("b.exr", 1), "--epsilon",
                         "1000000"})
                .exit_status,
            1);
}

TEST_F(CompareCommand, WhatCannotBeComparedIsAnError) {
  const std::string a = Write("a.exr", 1);
  ASSERT_EQ(WriteExr(MakeFrame(3, 4), dir_.File("b.exr")), absl::OkStatus());
  const Finished sizes = RunLinetree({"compare", a, dir_.File("b.exr")});
  EXPECT_EQ(sizes.exit_status, 2);
  EXPECT_THAT(sizes.err, HasSubstr("expected pictures of one size, found 4 x 3 and 3 x 4"));
  EXPECT_EQ(RunLinetree({"compare", a, dir_.File("none.exr")}).exit_status, 2);
  std::ofstream(dir_.File("text.exr")) << "text";
  EXPECT_EQ(RunLinetree({"compare", a, dir_.File("text.exr")}).exit_status, 2);
}

}  // namespace
}  // namespace linetree
