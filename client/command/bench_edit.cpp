// linetree bench edit: what editing a scene costs its cache.
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "absl/strings/str_format.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/progress_bar.h"
#include "client/command/table.h"
#include "core/audit/edit_study.h"
#include "core/audit/speed_scenes.h"
#include "core/io/load_scene.h"

namespace linetree {
namespace {

struct BenchEditFlags {
  std::string scene;
  std::string made = "spheres:1000:4";
  SizeFlags size;
  EditStudyOptions study;
  int threads = 0;
  std::string json;
  bool quiet = false;
};

absl::StatusOr<std::shared_ptr<const Scene>> SceneOf(const BenchEditFlags& flags) {
  if (!flags.scene.empty()) return LoadSceneFile(flags.scene);
  const auto made = ParseMadeScene(flags.made);
  if (!made.ok()) return made.status();
  return Make(*made);
}

std::string EditText(const EditStudy& study) {
  return absl::StrFormat(
      "%s objects, %s cells before the first edit\n"
      "finding what an edit touches: %.2f ms (%.2f to %.2f)\n"
      "cells that it drops: %s (%s to %s)\n"
      "pixels beyond epsilon after edits: %s of %s\n",
      Grouped(study.objects), Grouped(study.cells), study.find_ms.median, study.find_ms.least,
      study.find_ms.most, Percent(study.dropped_share.median), Percent(study.dropped_share.least),
      Percent(study.dropped_share.most), Grouped(study.beyond), Grouped(study.pixels));
}

nlohmann::json SpreadJson(const SpeedSpread& spread) {
  return {{"median", spread.median}, {"least", spread.least}, {"most", spread.most}};
}

nlohmann::json EditJson(const EditStudy& study, const BenchEditFlags& flags) {
  return {{"scene", flags.scene.empty() ? flags.made : flags.scene},
          {"epsilon", flags.study.epsilon},
          {"edits", flags.study.edits},
          {"objects", study.objects},
          {"cells", study.cells},
          {"find_ms", SpreadJson(study.find_ms)},
          {"dropped_share", SpreadJson(study.dropped_share)},
          {"pixels", study.pixels},
          {"beyond", study.beyond}};
}

absl::StatusOr<int> BenchEdit(BenchEditFlags& flags) {
  if (!flags.json.empty()) {
    if (absl::Status status = CheckFolders({flags.json}); !status.ok()) return status;
  }
  flags.study.width = flags.size.width;
  flags.study.height = flags.size.height;
  const auto scene = SceneOf(flags);
  if (!scene.ok()) return scene.status();
  WorkerPool pool(flags.threads);
  absl::StatusOr<EditStudy> study;
  {
    ProgressBar bar(!flags.quiet && IsTerminal(), "bench edit");
    study = StudyEdits(*scene, flags.study, pool, [&bar](double share) { bar.Show(share); });
  }
  if (!study.ok()) return study.status();
  std::cout << EditText(*study);
  if (!flags.json.empty()) {
    if (auto s = WriteJson(EditJson(*study, flags), flags.json); !s.ok()) return s;
  }
  return study->beyond == 0 ? kExitOk : kExitFailure;
}

void AddEditFlags(CLI::App& app, BenchEditFlags& flags) {
  auto* scene = app.add_option("--scene", flags.scene, "Scene file with spheres and a camera");
  scene->type_name("FILE");
  app.add_option(
         "--made", flags.made,
         "KIND:OBJECTS:LIGHTS, a scene made for the purpose: spheres, room, mirrors or glass")
      ->capture_default_str()
      ->excludes(scene);
  AddSizeFlags(app, flags.size);
  app.add_option("--edits", flags.study.edits, "Spheres that are moved, one after the other")
      ->type_name("N")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  app.add_option("--warm", flags.study.warm_frames, "Frames before the first edit")
      ->type_name("N")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  app.add_option("--between", flags.study.frames_between, "Frames from one edit to the next")
      ->type_name("N")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  app.add_option("--epsilon", flags.study.epsilon, "What cached answers promise")
      ->type_name("E")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  app.add_option("--seed", flags.study.seed, "Of what moves, and where to")
      ->type_name("N")
      ->capture_default_str();
  AddThreadsFlag(app, flags.threads);
  AddJsonFlag(app, flags.json, "the figures");
  AddQuietFlag(app, flags.quiet);
}

}  // namespace

void AddBenchEdit(CLI::App& bench, Commands& commands) {
  auto flags = std::make_shared<BenchEditFlags>();
  CLI::App* app =
      bench.add_subcommand("edit", "What moving an object costs the cache of its scene");
  AddEditFlags(*app, *flags);
  app->footer(
      "Flies around the scene, ray by ray, then moves spheres: what the cache knows of the rest "
      "goes on serving.\nPrints how long it took to find it (median, and the range), and holds the "
      "frame after each edit against a\nclassical one. Ends with status 1 when a pixel is beyond "
      "epsilon.\n\nExamples:\n"
      "  linetree bench edit --made spheres:1000:4 --warm 30\n"
      "  linetree bench edit --scene scenes/room.textproto --edits 50 --json edit.json");
  commands.push_back({app, [flags] { return BenchEdit(*flags); }});
}

}  // namespace linetree
