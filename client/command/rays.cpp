// linetree rays: radiance along rays that are given as text.
#include <fstream>
#include <iostream>
#include <memory>

#include "absl/strings/str_cat.h"
#include "client/command/command.h"
#include "client/command/flags.h"
#include "client/command/output.h"
#include "client/command/ray_text.h"
#include "client/command/session.h"
#include "core/io/stats_json.h"

namespace linetree {
namespace {

// Rays in one call: a message of a few megabytes, well below what servers accept.
constexpr size_t kBatch = 65536;

struct RaysFlags {
  ConnectionFlags connection;
  SceneFlags scene;
  RenderOptions options;
  std::string input;
  std::string stats;
  bool json = false;
};

// What all batches have in common.
struct RayTotals {
  FrameStats stats;
  double lane_rounding = 0;
};

// Traces everything that `reader` has and hands out the answers batch by batch.
absl::StatusOr<RayTotals> TraceAll(Session& session, RayReader& reader,
                                   const RenderOptions& options,
                                   const std::function<void(const RayAnswer&)>& on_answer) {
  RayTotals totals;
  for (;;) {
    const absl::StatusOr<std::vector<Ray>> rays = reader.Next(kBatch);
    if (!rays.ok()) return rays.status();
    if (rays->empty()) return totals;
    const absl::StatusOr<RayBatch> batch =
        session.client->TraceRays(session.scene.name(), *rays, options);
    if (!batch.ok()) return batch.status();
    for (const RayAnswer& answer : batch->answers) on_answer(answer);
    totals.stats += batch->stats;
    totals.lane_rounding = batch->lane_rounding;
  }
}

absl::StatusOr<int> TraceInput(const RaysFlags& flags, std::istream& in, const std::string& name) {
  absl::StatusOr<Session> session = OpenSession(flags.connection, flags.scene);
  if (!session.ok()) return session.status();
  RayReader reader(in, name);
  nlohmann::json rays = nlohmann::json::array();
  const auto on_answer = [&](const RayAnswer& answer) {
    if (flags.json) {
      rays.push_back(RayAnswerJson(answer));
    } else {
      std::cout << RayAnswerLine(answer);
    }
  };
  const absl::StatusOr<RayTotals> totals = TraceAll(*session, reader, flags.options, on_answer);
  if (!totals.ok()) return totals.status();
  nlohmann::json counters = StatsJson(totals->stats, 0, 0);
  counters["lane_rounding"] = totals->lane_rounding;
  counters["scene"] = session->scene.name();
  counters["scene_version"] = session->scene.scene_version();
  if (flags.json) {
    std::cout << nlohmann::json{{"rays", std::move(rays)}, {"stats", counters}}.dump(2) << '\n';
  }
  if (!flags.stats.empty()) {
    absl::Status status = WriteJson(counters, flags.stats);
    if (!status.ok()) return status;
  }
  return kExitOk;
}

absl::StatusOr<int> TraceRays(const RaysFlags& flags) {
  if (!flags.stats.empty()) {
    if (absl::Status s = CheckFolders({flags.stats}); !s.ok()) return s;
  }
  if (flags.input == "-") return TraceInput(flags, std::cin, "standard input");
  std::ifstream file(flags.input);
  if (!file) return absl::NotFoundError(absl::StrCat("cannot read ", flags.input));
  return TraceInput(flags, file, flags.input);
}

}  // namespace

void AddRays(CLI::App& parent, Commands& commands) {
  auto flags = std::make_shared<RaysFlags>();
  CLI::App* app = parent.add_subcommand("rays", "Radiance along rays given as text");
  AddConnectionFlags(*app, flags->connection);
  AddPriorityFlag(*app, flags->connection);
  AddSceneFlags(*app, flags->scene);
  app->add_option("--input", flags->input,
                  "Rays, one a line: ox oy oz dx dy dz; - is standard input; # starts a comment")
      ->type_name("FILE|-")
      ->required();
  AddOptionsFlags(*app, flags->options);
  app->add_flag("--json", flags->json, "Answers and counters as JSON")->group("Output");
  AddStatsFlag(*app, flags->stats);
  app->footer(
      "Prints a line for every ray: r g b source object depth\n"
      "(linear radiance; background, interpolated or traced; -1 and inf where nothing is hit).\n"
      "With --lanes simd, radiance is off by lane_rounding more than epsilon (see --stats).\n\n"
      "Examples:\n"
      "  echo 0 1 6 0 0 -1 | linetree rays --scene room --input -\n"
      "  linetree rays --local --scene scenes/face.textproto --input rays.txt --json\n"
      "  linetree rays --scene room --input rays.txt --lanes simd --stats rays.json\n"
      "  linetree rays --scene room --input rays.txt --priority background");
  commands.push_back({app, [flags] { return TraceRays(*flags); }});
}

}  // namespace linetree
