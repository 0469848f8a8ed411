#include "peers/peer_study.h"

#include <algorithm>

#include "core/math/check.h"

namespace linetree {
namespace {

// A row that is being measured.
struct Contestant {
  PeerRow row;
  std::unique_ptr<Peer> peer;  // null once it failed
};

std::vector<Contestant> MakeContestants(const std::vector<PeerKind>& kinds,
                                        const std::shared_ptr<const Scene>& scene,
                                        const PeerStudyOptions& options) {
  std::vector<Contestant> contestants;
  for (const PeerKind& kind : kinds) {
    for (const int threads : options.thread_counts) {
      Contestant contestant;
      contestant.row.peer = kind.name;
      contestant.row.threads = threads;
      auto peer = kind.make({scene, options.limits, threads});
      contestant.row.status = peer.status();
      if (peer.ok()) {
        contestant.row.version = (*peer)->Version();
        contestant.row.timed = (*peer)->Timed();
        contestant.peer = *std::move(peer);
      }
      contestants.push_back(std::move(contestant));
    }
  }
  return contestants;
}

void Measure(const PeerStudyOptions& options, Contestant& contestant) {
  if (contestant.peer == nullptr) return;
  auto picture = contestant.peer->Render(options.camera, options.width, options.height);
  if (!picture.ok()) {
    contestant.row.status = picture.status();
    contestant.row.seconds.clear();
    contestant.row.radiance.clear();
    contestant.peer.reset();
    return;
  }
  contestant.row.seconds.push_back(picture->seconds);
  contestant.row.radiance = std::move(picture->radiance);
  contestant.row.differences = std::move(picture->differences);
}

}  // namespace

bool PeerRow::Failed() const {
  return !status.ok() && !absl::IsUnavailable(status) && !absl::IsUnimplemented(status);
}

PixelTime PixelTimeOf(const std::vector<double>& seconds, int width, int height) {
  LT_CHECK(!seconds.empty() && width > 0 && height > 0);
  std::vector<double> sorted = seconds;
  std::sort(sorted.begin(), sorted.end());
  const size_t half = sorted.size() / 2;
  const double median =
      sorted.size() % 2 == 1 ? sorted[half] : (sorted[half - 1] + sorted[half]) / 2;
  const double ns = 1e9 / (static_cast<double>(width) * static_cast<double>(height));
  return {median * ns, sorted.front() * ns, sorted.back() * ns};
}

std::vector<PeerRow> StudyPeers(const std::vector<PeerKind>& kinds,
                                const std::shared_ptr<const Scene>& scene,
                                const PeerStudyOptions& options,
                                const std::function<void(double)>& progress) {
  std::vector<Contestant> contestants = MakeContestants(kinds, scene, options);
  const size_t steps = contestants.size() * static_cast<size_t>(options.repeats);
  size_t done = 0;
  for (int repeat = 0; repeat < options.repeats; ++repeat) {
    for (Contestant& contestant : contestants) {
      Measure(options, contestant);
      if (progress) progress(static_cast<double>(++done) / static_cast<double>(steps));
    }
  }
  std::vector<PeerRow> rows;
  rows.reserve(contestants.size());
  for (Contestant& contestant : contestants) rows.push_back(std::move(contestant.row));
  for (PeerRow& row : rows) {
    if (!row.status.ok() || !rows[0].status.ok()) continue;
    row.difference = DifferenceOf(row.radiance, rows[0].radiance);
  }
  return rows;
}

}  // namespace linetree
