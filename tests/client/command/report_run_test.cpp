#include "client/command/report_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "client/command/report_sections.h"
#include "tests/io/temp_dir.h"

namespace linetree {
namespace {

using ::testing::HasSubstr;

std::string ContentOf(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

// Whether every element that begins ends, in order.
bool IsWellFormed(const std::string& page) {
  std::vector<std::string> open;
  for (size_t at = page.find('<'); at != std::string::npos; at = page.find('<', at + 1)) {
    const size_t end = page.find('>', at);
    if (end == std::string::npos) return false;
    const bool closes = page[at + 1] == '/';
    const size_t begin = at + (closes ? 2 : 1);
    const std::string name = page.substr(begin, page.find_first_of(" />", begin) - begin);
    if (page[at + 1] == '!' || page[end - 1] == '/') continue;
    if (!closes) {
      open.push_back(name);
    } else if (open.empty() || open.back() != name) {
      return false;
    } else {
      open.pop_back();
    }
  }
  return open.empty();
}

// A section whose result is the number of times that sections of this kind have been run.
struct CountedSection {
  int runs = 0;

  ReportSection Make(const std::string& id, int parameter = 1) {
    ReportSection section{.id = id, .title = "About <" + id + ">", .text = "what it shows"};
    section.command = "linetree bench " + id;
    section.parameters = {{"n", parameter}, {"epsilon", 0.1}};
    section.run = [this](const Progress& progress) -> absl::StatusOr<nlohmann::json> {
      progress(0.5);
      return nlohmann::json{{"runs", ++runs}};
    };
    section.plots = [](const nlohmann::json& result) -> std::vector<Plot> {
      return {{"a plot", {}, {}, {{"runs", {{0, result.at("runs").get<double>()}}}}}};
    };
    section.goals = [](const nlohmann::json& result) -> std::vector<ReportGoal> {
      return {{"few runs", "<= 1", result.at("runs").dump(), result.at("runs") <= 1}};
    };
    return section;
  }
};

class ReportRun : public ::testing::Test {
 protected:
  std::vector<ReportEntry> Run(const std::vector<ReportSection>& sections, bool fresh = false) {
    auto entries = RunReport(sections, dir_.File(""), fresh, nullptr);
    EXPECT_TRUE(entries.ok()) << entries.status();
    return *std::move(entries);
  }

  TempDir dir_;
  CountedSection counted_;
};

TEST_F(ReportRun, WhatIsThereIsNotRunAgain) {
  Run({counted_.Make("a")});
  EXPECT_EQ(counted_.runs, 1);
  const auto entries = Run({counted_.Make("a"), counted_.Make("b")});
  EXPECT_EQ(counted_.runs, 2);
  EXPECT_FALSE(entries[0].is_new);
  EXPECT_EQ(entries[0].result["runs"], 1);
  EXPECT_TRUE(entries[1].is_new);
  EXPECT_EQ(entries[1].result["runs"], 2);
}

TEST_F(ReportRun, FreshRunsEverything) {
  Run({counted_.Make("a")});
  EXPECT_TRUE(Run({counted_.Make("a")}, /*fresh=*/true)[0].is_new);
  EXPECT_EQ(counted_.runs, 2);
}

TEST_F(ReportRun, OtherParametersAreAnotherMeasurement) {
  Run({counted_.Make("a", 1)});
  EXPECT_TRUE(Run({counted_.Make("a", 2)})[0].is_new);
}

TEST_F(ReportRun, WhatAnotherVersionMeasuredIsMeasuredAgain) {
  Run({counted_.Make("a")});
  nlohmann::json json = nlohmann::json::parse(ContentOf(dir_.File("a.json")));
  json["provenance"]["version"] = "of yesterday";
  std::ofstream(dir_.File("a.json")) << json;
  EXPECT_TRUE(Run({counted_.Make("a")})[0].is_new);
}

TEST_F(ReportRun, ADamagedFileIsAsGoodAsNone) {
  Run({counted_.Make("a")});
  const std::string whole = ContentOf(dir_.File("a.json"));
  nlohmann::json odd = nlohmann::json::parse(whole);
  odd["result"] = {{"runs", "many"}};
  for (const std::string& text :
       {std::string(), std::string("{"), std::string("[1]"), whole.substr(0, whole.size() / 2),
        std::string(R"({"result": 1})"), odd.dump()}) {
    std::ofstream(dir_.File("a.json")) << text;
    EXPECT_TRUE(Run({counted_.Make("a")})[0].is_new) << text;
  }
}

TEST_F(ReportRun, AFailingSectionIsNamedAndWhatCameBeforeStays) {
  ReportSection failing = counted_.Make("b");
  failing.run = [](const Progress&) -> absl::StatusOr<nlohmann::json> {
    return absl::NotFoundError("no scene");
  };
  const auto entries =
      RunReport({counted_.Make("a"), failing}, dir_.File(""), /*fresh=*/false, nullptr);
  EXPECT_EQ(entries.status(), absl::NotFoundError("b: no scene"));
  EXPECT_THAT(ContentOf(dir_.File("report.html")), HasSubstr("id=\"a\""));
  EXPECT_FALSE(Run({counted_.Make("a")})[0].is_new);
}

TEST_F(ReportRun, ThePageNamesGoalsCommandsAndMachines) {
  const std::string html = ReportHtml(Run({counted_.Make("a"), counted_.Make("b")}));
  EXPECT_TRUE(IsWellFormed(html));
  EXPECT_FALSE(IsWellFormed(html.substr(0, html.size() - 10)));
  const Provenance here = ProvenanceOf("linetree bench b");
  for (const std::string& part :
       {std::string("<td>few runs</td><td>&lt;= 1</td><td>2</td><td>NO</td>"),
        std::string("About &lt;a&gt;"), std::string("<svg"), std::string("linetree bench b; "),
        here.version}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  EXPECT_THAT(here.machine, HasSubstr(" threads, "));
}

TEST(ReportSections, AreWhatTheirChaptersSay) {
  for (const bool quick : {false, true}) {
    for (const ReportChapter& chapter : ReportChapters()) {
      const ReportSection section = chapter.make({.quick = quick});
      EXPECT_EQ(section.id, chapter.id);
      EXPECT_TRUE(section.plots || section.tables) << chapter.id;
      EXPECT_THAT(section.command, HasSubstr("linetree ")) << chapter.id;
    }
  }
}

}  // namespace
}  // namespace linetree
