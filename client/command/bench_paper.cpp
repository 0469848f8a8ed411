// linetree bench paper: the paper's Tables 1, 2 and 3 beside what this program counts.
#include <iostream>
#include <memory>

#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/paper_tables.h"
#include "client/command/progress_bar.h"

namespace linetree {
namespace {

struct BenchPaperFlags {
  PaperBenchOptions options;
  std::string json;
  bool quiet = false;
};

absl::StatusOr<std::vector<Sequence>> MeasureAll(const BenchPaperFlags& flags) {
  WorkerPool pool(flags.options.threads);
  const std::vector<SequenceSpec> tables = PaperSequences(flags.options.scenes_dir);
  const auto sweep = PrintedEpsilonRows();
  ProgressBar bar(!flags.quiet && IsTerminal(), "bench paper");
  const double steps = static_cast<double>(tables.size() + sweep.size());
  std::vector<Sequence> measured;
  const auto measure = [&](const SequenceSpec& spec, const std::vector<std::string>& cameras) {
    auto sequence = MeasureSequence(spec, cameras, flags.options, pool);
    if (sequence.ok()) measured.push_back(*std::move(sequence));
    bar.Show(static_cast<double>(measured.size()) / steps);
    return sequence.status();
  };
  for (const SequenceSpec& spec : tables) {
    const auto status = measure(spec, {"frame1", "frame2", "frame3", "frame4", "frame5"});
    if (!status.ok()) return status;
  }
  for (const auto& [epsilon, printed] : sweep) {
    const auto status =
        measure(PaperEpsilonSweep(flags.options.scenes_dir, printed, epsilon), {"frame1"});
    if (!status.ok()) return status;
  }
  return measured;
}

absl::StatusOr<int> BenchPaper(const BenchPaperFlags& flags) {
  if (!flags.json.empty()) {
    if (absl::Status status = CheckFolders({flags.json}); !status.ok()) return status;
  }
  const auto measured = MeasureAll(flags);
  if (!measured.ok()) return measured.status();
  nlohmann::json json = {{"width", flags.options.width},
                         {"height", flags.options.height},
                         {"max_cell_depth", flags.options.cache.max_cell_depth},
                         {"min_cell_rays", flags.options.cache.min_cell_rays},
                         {"tables", nlohmann::json::array()}};
  for (const Sequence& sequence : *measured) {
    std::cout << SequenceText(sequence) << "\n";
    json["tables"].push_back(SequenceJson(sequence));
  }
  std::cout
      << "Counts in thousands. I: Intersect, S: Shade (section 8); success: share of the\n"
         "pixels on objects that a cell answered; beyond: pixels whose error exceeds epsilon.\n"
         "At epsilon 0 no cell can answer, so none is built; the paper's program built them.\n";
  if (flags.json.empty()) return kExitOk;
  if (absl::Status status = WriteJson(json, flags.json); !status.ok()) return status;
  return kExitOk;
}

}  // namespace

void AddBenchPaper(CLI::App& bench, Commands& commands) {
  auto flags = std::make_shared<BenchPaperFlags>();
  CLI::App* app = bench.add_subcommand(
      "paper", "Tables 1, 2 and 3 of the paper for face and room, beside the printed figures");
  app->add_option("--scenes", flags->options.scenes_dir,
                  "Folder with face.textproto and room.textproto")
      ->capture_default_str();
  app->add_option("--width", flags->options.width, "Pixels")->capture_default_str();
  app->add_option("--height", flags->options.height, "Pixels")->capture_default_str();
  AddThreadsFlag(*app, flags->options.threads);
  app->add_option("--cell-depth", flags->options.cache.max_cell_depth, "Depth of the deepest cells")
      ->check(CLI::Range(0, kMaxCellDepth))
      ->capture_default_str();
  app->add_option("--min-cell-rays", flags->options.cache.min_cell_rays,
                  "Build a cell for at least this many rays of a frame")
      ->capture_default_str();
  AddJsonFlag(*app, flags->json, "the tables");
  AddQuietFlag(*app, flags->quiet);
  commands.push_back({app, [flags] { return BenchPaper(*flags); }});
}

}  // namespace linetree
