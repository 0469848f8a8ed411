#include "core/io/trace_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>

#include "core/io/atomic_file.h"
#include "core/io/read_file.h"
#include "tests/io/temp_dir.h"

namespace linetree {
namespace {

using ::testing::HasSubstr;

Trace SmallTrace() {
  Trace trace = {
      {0, 0x1122334455667788, 100, 2.5f}, {0, 7, 200, 3.5f}, {4, 0x1122334455667788, 100, 2.5f}};
  LinkTrace(trace);
  return trace;
}

class TraceFile : public testing::Test {
 protected:
  TraceFile() { EXPECT_TRUE(WriteTrace(SmallTrace(), path_).ok()); }
  std::string Bytes(const std::string& path) { return *ReadFileAtMost(path, 1 << 20); }
  // With other bytes in the place of some.
  void Change(size_t at, const std::string& bytes) {
    std::string all = Bytes(path_);
    all.replace(at, bytes.size(), bytes);
    ASSERT_TRUE(WriteFileAtomically(path_, all).ok());
  }
  void ExpectError(const std::string& part) {
    const auto read = ReadTrace(path_);
    ASSERT_FALSE(read.ok());
    EXPECT_EQ(read.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(read.status().message()), HasSubstr(path_));
    EXPECT_THAT(std::string(read.status().message()), HasSubstr(part));
  }

  TempDir dir_;
  const std::string path_ = dir_.File("a.trace");
};

TEST_F(TraceFile, HasTheLayoutThatOthersRead) {
  const std::string bytes = Bytes(path_);
  ASSERT_EQ(bytes.size(), 72u);
  EXPECT_EQ(bytes.substr(0, 24), std::string("\0\0\0\0"
                                             "\x88\x77\x66\x55\x44\x33\x22\x11"
                                             "\x64\0\0\0"
                                             "\x02\0\0\0\0\0\0\0",
                                             24));
  EXPECT_EQ(bytes.substr(40, 8), std::string(8, '\xff')) << "never again";
  EXPECT_EQ(bytes.substr(48, 4), std::string("\x04\0\0\0", 4));
  EXPECT_EQ(Bytes(path_ + ".cost").size(), 12u);
}

TEST_F(TraceFile, ComesBackAsItWas) {
  const auto read = ReadTrace(path_);
  ASSERT_TRUE(read.ok()) << read.status();
  const Trace trace = SmallTrace();
  ASSERT_EQ(read->size(), trace.size());
  for (size_t i = 0; i < trace.size(); ++i) {
    EXPECT_EQ((*read)[i].time, trace[i].time);
    EXPECT_EQ((*read)[i].id, trace[i].id);
    EXPECT_EQ((*read)[i].bytes, trace[i].bytes);
    EXPECT_EQ((*read)[i].rebuild_ns, trace[i].rebuild_ns);
    EXPECT_EQ((*read)[i].next, trace[i].next);
  }
}

TEST_F(TraceFile, WithoutCostsAllAreEqual) {
  std::filesystem::remove(path_ + ".cost");
  const auto read = ReadTrace(path_);
  ASSERT_TRUE(read.ok()) << read.status();
  for (const TraceEvent& event : *read) EXPECT_EQ(event.rebuild_ns, 1);
}

TEST_F(TraceFile, OtherWaysToCountAreUnderstood) {
  Change(16, std::string("\x03", 1));  // from 1
  Change(40, std::string("\xff\xff\xff\xff\xff\xff\xff\x7f", 8));
  const auto read = ReadTrace(path_);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ((*read)[0].next, 2);
  EXPECT_EQ((*read)[1].next, kNeverAgain);
}

TEST_F(TraceFile, WhatIsCutShortIsRefused) {
  const std::string bytes = Bytes(path_);
  ASSERT_TRUE(WriteFileAtomically(path_, bytes.substr(0, 71)).ok());
  ExpectError("found 71 bytes: the last record is cut short");
  ASSERT_TRUE(WriteFileAtomically(path_, bytes.substr(0, 48)).ok());
  ExpectError("record 0: its object is next used by record 2, there are 2");
}

TEST_F(TraceFile, WhatContradictsItselfIsRefused) {
  Change(0, std::string(1, 5));
  ExpectError("record 1: expected a time of at least 5, found 0");
  Change(0, std::string(1, '\0'));
  Change(16, std::string(1, 1));
  ExpectError("record 0: expected 2 as the next use of its object, found 1");
  Change(16, std::string(1, 2));
  Change(36, std::string(4, '\0'));
  ExpectError("record 1: expected a size of at least 1 byte");
}

TEST_F(TraceFile, CostsAreChecked) {
  const std::string costs = Bytes(path_ + ".cost");
  ASSERT_TRUE(WriteFileAtomically(path_ + ".cost", costs.substr(4)).ok());
  ExpectError("expected 12 bytes, 4 for each of 3 records of the trace, found 8");
  ASSERT_TRUE(
      WriteFileAtomically(path_ + ".cost", costs.substr(0, 8) + std::string(4, '\xff')).ok());
  ExpectError("record 2: expected a cost above 0");
}

TEST_F(TraceFile, MissingFilesAreNotFound) {
  EXPECT_EQ(ReadTrace(dir_.File("b")).status().code(), absl::StatusCode::kNotFound);
}

}  // namespace
}  // namespace linetree
