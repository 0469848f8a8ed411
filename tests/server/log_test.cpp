// Lines of the log, and what becomes of them when there is no room.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/logger.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include "server/log_format.h"
#include "server/log_sink.h"

namespace linetree {
namespace {

using testing::HasSubstr;

std::string LineOf(LogFormat format, const std::string& message) {
  spdlog::memory_buf_t buffer;
  MakeLogFormatter(format)->format({"test", spdlog::level::info, message}, buffer);
  return {buffer.data(), buffer.size()};
}

TEST(LogFormatTest, OneLineWhateverIsInIt) {
  using std::string_literals::operator""s;
  const std::string nasty = "a \"quoted\"\nline\x01 \xff\xfe \xe2\x82\xac \0 end"s;
  const LogFields fields({{"field", nasty}, {"plain", "1.5"}});
  for (const LogFormat format : {LogFormat::kText, LogFormat::kJson}) {
    const std::string line = LineOf(format, nasty);
    EXPECT_EQ(line.find('\n'), line.size() - 1) << line;
    EXPECT_EQ(line.find('\0'), std::string::npos) << line;
  }
  EXPECT_THAT(LineOf(LogFormat::kText, nasty), HasSubstr(" plain=1.5"));
  const auto json = nlohmann::json::parse(LineOf(LogFormat::kJson, nasty));
  EXPECT_THAT(json["message"].get<std::string>(), HasSubstr("a \"quoted\"\nline\x01"));
  EXPECT_EQ(json["field"], json["message"]);
  EXPECT_EQ(json["plain"], "1.5");
  EXPECT_EQ(json["level"], "info");
}

TEST(LogFormatTest, FieldsHoldAsLongAsTheyLive) {
  {
    const LogFields outer(LogFields::Fields{{"a", "1"}});
    {
      const LogFields inner(LogFields::Fields{{"b", ""}});
      EXPECT_THAT(LineOf(LogFormat::kText, "m"), HasSubstr(" m b=\"\"\n"));
    }
    EXPECT_THAT(LineOf(LogFormat::kText, "m"), HasSubstr(" m a=1\n"));
  }
  EXPECT_THAT(LineOf(LogFormat::kText, "m"), HasSubstr(" m\n"));
}

// A pipe with a logger on one end.
class LogPipe {
 public:
  LogPipe() {
    EXPECT_EQ(pipe(ends_), 0);
    sink_ = std::make_shared<LogSink>(ends_[1]);
    log_ = std::make_unique<spdlog::logger>("test", sink_);
    log_->set_pattern("%v");
  }
  ~LogPipe() {
    close(ends_[0]);
    close(ends_[1]);
  }
  spdlog::logger& log() { return *log_; }
  const LogSink& sink() const { return *sink_; }
  // What is in the pipe now.
  std::string ReadAll() {
    std::string all;
    char buffer[65536];
    fcntl(ends_[0], F_SETFL, O_NONBLOCK);
    for (ssize_t n; (n = read(ends_[0], buffer, sizeof buffer)) > 0;) {
      all.append(buffer, static_cast<size_t>(n));
    }
    return all;
  }

 private:
  int ends_[2] = {-1, -1};
  std::shared_ptr<LogSink> sink_;
  std::unique_ptr<spdlog::logger> log_;
};

TEST(LogSinkTest, AReaderThatStopsCostsLinesAndNothingElse) {
  LogPipe pipe;
  const std::string line(999, 'x');
  for (int i = 0; i < 1000; ++i) pipe.log().info(line);  // a pipe holds 64 KiB
  const uint64_t lost = pipe.sink().lines_lost();
  const std::string first = pipe.ReadAll();
  EXPECT_EQ(lost + first.size() / 1000, 1000u);
  EXPECT_GT(first.size() / 1000, 10u);
  pipe.log().info("again");
  EXPECT_EQ(pipe.ReadAll(), "lines of this log lost: " + std::to_string(lost) + "\nagain\n");
}

TEST(LogSinkTest, AFullDiskCostsLinesAndNothingElse) {
  const int full = open("/dev/full", O_WRONLY);
  ASSERT_GE(full, 0);
  spdlog::logger log("test", std::make_shared<LogSink>(full));
  for (int i = 0; i < 10; ++i) log.info("nobody reads this");
  EXPECT_EQ(dynamic_cast<LogSink&>(*log.sinks()[0]).lines_lost(), 10u);
  close(full);
}

TEST(LogSinkTest, LongLinesArriveWhole) {
  LogPipe pipe;
  const std::string line(20'000, 'y');
  pipe.log().info(line);
  EXPECT_EQ(pipe.ReadAll(), line + "\n");
}

}  // namespace
}  // namespace linetree
