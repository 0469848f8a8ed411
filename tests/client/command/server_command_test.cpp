// Every command against a server in a process of its own; answers are those of --local.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/io/exr.h"
#include "tests/client/command/program.h"

namespace linetree {
namespace {

using ::testing::HasSubstr;

class ServerCommand : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    server_ =
        new ServerProcess({"--audit", "1", "--scene", "gap=" + SourceFile("scenes/gap.textproto")});
  }
  static void TearDownTestSuite() {
    delete server_;
    server_ = nullptr;
  }

  static Finished Run(std::vector<std::string> arguments, const std::string& in = "") {
    arguments.insert(arguments.end(), {"--server", server_->address()});
    return RunLinetree(arguments, in);
  }

  static ServerProcess* server_;
  TempDir dir_;
};
ServerProcess* ServerCommand::server_ = nullptr;

TEST_F(ServerCommand, ClassicalFramesAreThoseOfLocal) {
  const std::vector<std::string> render = {"render", "--mode",   "classical", "--width",
                                           "70",     "--height", "50",        "-q"};
  std::vector<std::string> remote = render;
  remote.insert(remote.end(), {"--scene", "gap", "-o", dir_.File("remote.exr")});
  std::vector<std::string> local = render;
  local.insert(local.end(), {"--local", "--scene", SourceFile("scenes/gap.textproto"), "-o",
                             dir_.File("local.exr")});
  const Finished run = Run(remote);
  ASSERT_EQ(run.exit_status, 0) << run.err;
  ASSERT_EQ(RunLinetree(local).exit_status, 0);
  const auto a = ReadExr(dir_.File("remote.exr"));
  const auto b = ReadExr(dir_.File("local.exr"));
  ASSERT_EQ(a.status(), absl::OkStatus());
  EXPECT_EQ(a->radiance, b->radiance);
  EXPECT_EQ(a->object, b->object);
  EXPECT_EQ(a->source, b->source);
  EXPECT_EQ(a->verdict, b->verdict);
  EXPECT_EQ(a->depth, b->depth);
  EXPECT_EQ(a->camera, b->camera);
  EXPECT_EQ(a->white, b->white);
  EXPECT_EQ(a->scene_version, b->scene_version);
}

TEST_F(ServerCommand, ScenesAreEdited) {
  Finished run = Run({"render", "--scene", SourceFile("scenes/blocker.textproto"), "--width", "16",
                      "--height", "16"});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  const std::string edits = dir_.File("edits.textproto");
  std::ofstream(edits) << "edits { remove_object { index: 0 } }\n";
  run = Run({"scene", "edit", "--scene", "blocker", edits});
  EXPECT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("blocker: version "));
  std::ofstream(edits) << "edits { remove_object { index: 999 } }\n";
  run = Run({"scene", "edit", "--scene", "blocker", edits});
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_THAT(run.err, HasSubstr("edits[0].remove_object.index: expected a number below"));
  std::ofstream(edits) << "edits { remove_objet {} }\n";
  run = Run({"scene", "edit", "--scene", "blocker", edits});
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_THAT(run.err, HasSubstr("edits.textproto:1:"));
}

TEST_F(ServerCommand, WhatWasLeftOutIsExplained) {
  const std::vector<std::string> render = {
      "render",  "--scene",  SourceFile("scenes/many_lights.textproto"),
      "--lanes", "simd",     "--width",
      "128",     "--height", "128",
      "-q",      "--explain"};
  const Finished remote = Run(render);
  ASSERT_EQ(remote.exit_status, 0) << remote.err;
  std::vector<std::string> here = render;
  here.push_back("--local");
  const Finished local = RunLinetree(here);
  ASSERT_EQ(local.exit_status, 0) << local.err;
  EXPECT_EQ(remote.out, local.out);
  EXPECT_THAT(remote.out, HasSubstr("decision(s): "));
}

TEST_F(ServerCommand, FramesComeInTheFormThatIsAskedFor) {
  const auto render = [&](const std::string& codec, const std::string& file) {
    return Run({"render", "--scene", "gap", "--mode", "classical", "--width", "40", "--height",
                "30", "-q", "--codec", codec, "--priority", "batch", "-o", dir_.File(file)});
  };
  for (const char* codec : {"float", "exr", "half"}) {
    const Finished run = render(codec, std::string(codec) + ".exr");
    ASSERT_EQ(run.exit_status, 0) << run.err;
  }
  const auto plain = ReadExr(dir_.File("float.exr"));
  ASSERT_TRUE(plain.ok()) << plain.status();
  EXPECT_EQ(ReadExr(dir_.File("exr.exr"))->radiance, plain->radiance);
  EXPECT_EQ(ReadExr(dir_.File("exr.exr"))->verdict, plain->verdict);
  const auto half = ReadExr(dir_.File("half.exr"));
  EXPECT_NE(half->radiance, plain->radiance);
  for (size_t i = 0; i < plain->radiance.size(); ++i) {
    EXPECT_NEAR(half->radiance[i], plain->radiance[i], 0x1p-11 * plain->radiance[i] + 0x1p-25);
  }
  // The picture of the server is that which the client would have made.
  ASSERT_EQ(render("float", "mine.png").exit_status, 0);
  ASSERT_EQ(render("png", "theirs.png").exit_status, 0);
  const auto bytes = [&](const std::string& file) {
    std::ifstream in(dir_.File(file), std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>());
  };
  EXPECT_EQ(bytes("mine.png"), bytes("theirs.png"));
  ASSERT_EQ(render("jpeg", "theirs.jpg").exit_status, 0);
  EXPECT_TRUE(bytes("theirs.jpg").starts_with("\xff\xd8\xff"));
  for (const auto& [codec, file] :
       {std::pair("png", "a.exr"), {"jpeg", "a.png"}, {"png", "a.jpg"}}) {
    const Finished run = render(codec, file);
    EXPECT_EQ(run.exit_status, 1);
    EXPECT_THAT(run.err, HasSubstr("frames come as "));
  }
  EXPECT_EQ(Run({"render", "--scene", "gap", "--priority", "urgent"}).exit_status, 2);
  EXPECT_EQ(RunLinetree({"render", "--local", "--scene", SourceFile("scenes/gap.textproto"),
                         "--priority", "batch"})
                .exit_status,
            2);
}

TEST_F(ServerCommand, AFlightMayKeepTheNewestViewpointOnly) {
  const std::string path = SourceFile("scenes/paths/face_walk.textproto");
  // So many at once that most are overtaken.
  Finished run = Run({"fly", "--scene", "gap", "--path", path, "--frames", "200", "--width", "120",
                      "--height", "90", "--newest", "100000", "--codec", "jpeg", "-o",
                      dir_.File("v_%03d.jpg"), "--stats", dir_.File("fly.json")});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  const auto fly = ReadJson(dir_.File("fly.json"));
  EXPECT_EQ(fly["viewpoints"], 200);
  EXPECT_LT(fly["frames"].size(), 200u);
  EXPECT_EQ(dir_.Names().size(), fly["frames"].size() + 1);
  EXPECT_THAT(dir_.Names(), testing::Contains("v_200.jpg")) << "the newest one always comes";
  EXPECT_THAT(run.out, HasSubstr("200 viewpoints, "));

  run = Run({"load", "--scene", "gap", "--path", path, "--clients", "2", "--frames", "100",
             "--stream", "--newest", "100000", "--codec", "jpeg", "--priority", "background", "-q",
             "--stats", dir_.File("load.json")});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  const auto load = ReadJson(dir_.File("load.json"));
  EXPECT_EQ(load["frames"].get<int>() + load["overtaken"].get<int>(), 200);
  EXPECT_GE(load["frames"], 2);
  EXPECT_EQ(Run({"load", "--scene", "gap", "--path", path, "--newest", "9"}).exit_status, 2);
}

TEST_F(ServerCommand, AFileIsLoadedUnderItsName) {
  const std::string peak = SourceFile("scenes/peak.textproto");
  Finished run = Run({"render", "--scene", peak, "--width", "16", "--height", "16"});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  run = Run({"render", "--scene", "peak", "--width", "16", "--height", "16"});
  EXPECT_EQ(run.exit_status, 0) << run.err;
  // Another scene of the same name only on request.
  std::filesystem::copy(SourceFile("scenes/gap.textproto"), dir_.File("peak.textproto"));
  run = Run({"render", "--scene", dir_.File("peak.textproto"), "--width", "16", "--height", "16"});
  EXPECT_EQ(run.exit_status, 1);
  EXPECT_THAT(run.err, HasSubstr("--replace"));
  run = Run({"render", "--replace", "--scene", dir_.File("peak.textproto"), "--width", "16",
             "--height", "16"});
  EXPECT_EQ(run.exit_status, 0) << run.err;
}

TEST_F(ServerCommand, FliesOverOneStream) {
  const Finished run =
      Run({"fly", "--scene", SourceFile("scenes/face.textproto"), "--path",
           SourceFile("scenes/paths/face_walk.textproto"), "--frames", "4", "--width", "32",
           "--height", "32", "-o", dir_.File("f_%d.exr"), "--stats", dir_.File("s.json")});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_TRUE(std::filesystem::exists(dir_.File("f_4.exr")));
  EXPECT_EQ(ReadJson(dir_.File("s.json"))["frames"].size(), 4u);
}

TEST_F(ServerCommand, Rays) {
  const Finished run = Run({"rays", "--scene", "gap", "--input", "-"}, "0 5 0 0 -1 0\n");
  EXPECT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr(" 0 5\n"));  // object 0, the mirror, at a distance of 5
}

TEST_F(ServerCommand, Load) {
  const Finished run =
      Run({"load", "--scene", "gap", "--path", SourceFile("scenes/paths/face_walk.textproto"),
           "--clients", "3", "--frames", "2", "--width", "16", "--height", "16", "--stats",
           dir_.File("l.json")});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_EQ(ReadJson(dir_.File("l.json"))["frames"], 6);
}

TEST_F(ServerCommand, StatsShowWhatWasDone) {
  ASSERT_EQ(Run({"render", "--scene", "gap", "--width", "16", "--height", "16"}).exit_status, 0);
  Finished run = Run({"stats", "--objects"});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("gap "));
  EXPECT_THAT(run.out, HasSubstr("Cells of gap by verdict"));
  EXPECT_THAT(run.out, HasSubstr("bytes/cell"));
  EXPECT_THAT(run.out, HasSubstr("Audit of a share of 1 of the answers"));
  run = Run({"stats", "--scene", "gap", "--json"});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  const nlohmann::json json = nlohmann::json::parse(run.out);
  ASSERT_EQ(json["scenes"].size(), 1u);
  EXPECT_EQ(json["scenes"][0]["scene"], "gap");
  EXPECT_GE(json["scenes"][0]["frames"], 1);
  EXPECT_GT(json["memory_budget_bytes"], 0);
  uint64_t budgeted = 0;
  for (const auto& part : json["scenes"][0]["memory"]) {
    if (part.contains("cells")) budgeted += part["bytes"].get<uint64_t>();
  }
  EXPECT_EQ(json["scenes"][0]["cache_bytes"], budgeted);
  EXPECT_EQ(json["audit_share"], 1);
  EXPECT_EQ(json["scenes"][0]["audit"]["violations"], 0);
  EXPECT_TRUE(json["scenes"][0]["audit"]["checked"].is_number_unsigned());
}

TEST_F(ServerCommand, BenchErrorLeavesNothingBehind) {
  const Finished run =
      Run({"bench", "error", "--scene", SourceFile("scenes/gap.textproto"), "--epsilons", "0.25",
           "--repeat", "1", "--width", "16", "--height", "16"});
  ASSERT_EQ(run.exit_status, 0) << run.err;
  const nlohmann::json json = nlohmann::json::parse(Run({"stats", "--json"}).out);
  for (const auto& scene : json["scenes"]) {
    EXPECT_THAT(scene["scene"].get<std::string>(), ::testing::Not(HasSubstr("bench")));
  }
}

TEST_F(ServerCommand, RefusalsAreOneLine) {
  const Finished unknown = Run({"render", "--scene", "nowhere"});
  EXPECT_EQ(unknown.exit_status, 1);
  EXPECT_THAT(unknown.err, HasSubstr("nowhere"));
  const Finished huge = Run({"render", "--scene", "gap", "--width", "1000000"});
  EXPECT_EQ(huge.exit_status, 1);
  EXPECT_THAT(huge.err, HasSubstr("width"));
  EXPECT_EQ(std::count(huge.err.begin(), huge.err.end(), '\n'), 1) << huge.err;
}

}  // namespace
}  // namespace linetree
