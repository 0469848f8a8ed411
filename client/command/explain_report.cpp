#include "client/command/explain_report.h"

#include <iostream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/local_client.h"
#include "client/command/table.h"
#include "core/math/check.h"

namespace linetree {
namespace {

std::string FeatureTable(const std::vector<FeatureNote>& features) {
  Table table({{"in the scene"}, {"count", Align::kRight}, {"frames by packets"}});
  for (const FeatureNote& note : features) {
    table.AddRow({note.feature, note.count ? Grouped(*note.count) : "", note.what_frames_do});
  }
  return table.ToString();
}

std::string ObjectTable(const Scene& scene, const std::vector<ObjectPlan>& objects) {
  Table table({{"object"},
               {"trees"},
               {"why"},
               {"points", Align::kRight},
               {"work", Align::kRight},
               {"without", Align::kRight},
               {"cells", Align::kRight},
               {"bytes", Align::kRight}});
  for (const ObjectPlan& object : objects) {
    const auto work = [&](double value) {
      return object.points > 0 ? absl::StrFormat("%.1f", value) : "-";
    };
    table.AddRow({absl::StrCat(object.object, " ", scene.objects[object.object].name),
                  object.asked ? "asked" : "skipped", std::string(WordsFor(object.reason)),
                  Grouped(object.points), work(object.tree_work), work(object.classical_work),
                  Grouped(object.trees.cells), Grouped(object.trees.bytes)});
  }
  return table.ToString();
}

}  // namespace

std::string ExplanationText(const Scene& scene, const SceneHost::Explanation& explanation) {
  size_t skipped = 0;
  for (const ObjectPlan& object : explanation.objects) skipped += object.asked ? 0 : 1;
  return absl::StrCat(
      FeatureTable(explanation.features), "\nSurface trees after ", explanation.decisions,
      " decision(s): ", skipped, " of ", explanation.objects.size(),
      " objects skipped. Work is that of a point that was looked at of late, with the trees and "
      "without.\n",
      ObjectTable(scene, explanation.objects));
}

void AddExplainFlag(CLI::App& app, bool& explain) {
  app.add_flag("--explain", explain,
               "Also print what was left out, for the scene and every object, and why; of frames "
               "by packets (--lanes simd)")
      ->group("Output")
      ->needs("--local");
}

absl::Status ValidateExplain(bool explain, const RenderOptions& options) {
  if (!explain || (options.lanes == Lanes::kSimd && options.mode == Mode::kCached &&
                   options.judge == JudgeKind::kCertified)) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(
      "--explain: expected --lanes simd, --mode cached and --judge certified: other frames are not "
      "planned");
}

absl::Status PrintExplanation(Client& client, const std::string& scene,
                              const RenderOptions& options) {
  auto* local = dynamic_cast<LocalClient*>(&client);
  LT_CHECK(local != nullptr);
  const auto host = local->Find(scene);
  if (!host.ok()) return host.status();
  std::cout << "\n"
            << ExplanationText((*host)->scene(), (*host)->Explain(options.max_relative_error));
  return absl::OkStatus();
}

}  // namespace linetree
