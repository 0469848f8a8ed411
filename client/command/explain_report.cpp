#include "client/command/explain_report.h"

#include <iostream>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/command/table.h"

namespace linetree {
namespace {

std::string FeatureTable(const v1::ExplainReply& explanation) {
  Table table({{"in the scene"}, {"count", Align::kRight}, {"frames by packets"}});
  for (const auto& note : explanation.features()) {
    table.AddRow(
        {note.feature(), note.has_count() ? Grouped(note.count()) : "", note.what_frames_do()});
  }
  return table.ToString();
}

std::string ObjectTable(const v1::ExplainReply& explanation) {
  Table table({{"object"},
               {"trees"},
               {"why"},
               {"points", Align::kRight},
               {"work", Align::kRight},
               {"without", Align::kRight},
               {"cells", Align::kRight},
               {"bytes", Align::kRight}});
  for (const auto& object : explanation.objects()) {
    const auto work = [&](double value) {
      return object.points() > 0 ? absl::StrFormat("%.1f", value) : "-";
    };
    table.AddRow({absl::StrCat(object.object(), " ", object.name()),
                  object.asked() ? "asked" : "skipped", std::string(WordsFor(object.reason())),
                  Grouped(object.points()), work(object.tree_work()), work(object.classical_work()),
                  Grouped(object.cells()), Grouped(object.bytes())});
  }
  return table.ToString();
}

// How many objects have which reason.
std::string Sums(const v1::ExplainReply& explanation) {
  std::string text;
  for (const auto& count : explanation.reasons()) {
    absl::StrAppend(&text, "  ", Grouped(count.objects()), ": ",
                    std::string(WordsFor(count.reason())), "\n");
  }
  return text;
}

}  // namespace

std::string ExplanationText(const v1::ExplainReply& explanation) {
  const uint64_t objects = explanation.objects_asked() + explanation.objects_skipped();
  const auto listed = static_cast<uint64_t>(explanation.objects_size());
  std::string text = absl::StrCat(
      FeatureTable(explanation), "\nSurface trees after ", explanation.decisions(),
      " decision(s): ", Grouped(explanation.objects_skipped()), " of ", Grouped(objects),
      " objects skipped.\n", Sums(explanation),
      "Work is that of a point that was looked at of late, with the trees and without.\n",
      ObjectTable(explanation));
  if (listed < objects) {
    absl::StrAppend(&text, Grouped(objects - listed), " objects with no more points than these\n");
  }
  return text;
}

void AddExplainFlag(CLI::App& app, bool& explain) {
  app.add_flag("--explain", explain,
               "Also print what was left out, for the scene and its objects, and why, of all "
               "frames of the scene so far; of frames by packets (--lanes simd)")
      ->group("Output");
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
  v1::ExplainRequest request;
  request.set_scene(scene);
  request.set_max_relative_error(options.max_relative_error);
  const auto explanation = client.Explain(request);
  if (!explanation.ok()) return explanation.status();
  std::cout << "\n" << ExplanationText(*explanation);
  return absl::OkStatus();
}

}  // namespace linetree
