// Answers of one scene by object, source and verdict.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <mutex>
#include <span>

#include "core/render/scene_host.h"
#include "linetree/v1/service.pb.h"

namespace linetree {

// Thread safety: all methods may be called from any thread.
class AnswerCounts {
 public:
  struct Counts {
    std::array<uint64_t, kSourceCount> sources{};
    std::array<uint64_t, kVerdictCount> verdicts{};
    Counts& operator+=(const Counts& o);
    bool operator==(const Counts&) const = default;
  };
  // By index; -1 is the background. Only what was seen.
  using ByObject = std::map<int32_t, Counts>;

  // One answer for each pixel. The layers must have equal sizes. Costs about a nanosecond a pixel.
  void Add(std::span<const int32_t> object, std::span<const Source> source,
           std::span<const Verdict> verdict);
  void Add(const Frame& frame) { Add(frame.object, frame.source, frame.verdict); }
  void Add(const RayBatch& batch);

  ByObject values() const;
  // The sum over all of them, kept as they come.
  Counts sum() const;

 private:
  void Merge(const ByObject& more);

  mutable std::mutex mutex_;
  ByObject counts_;  // guarded by mutex_, as is sum_
  Counts sum_;
};

// Fills in the answers of the scene.
void AnswerSumToWire(const AnswerCounts::Counts& sum, v1::GetStatsReply::SceneStats* stats);

// Fills in the answers of the scene and of its objects; entries of objects that have none yet are
// added in order. `scene` is what the counts are about.
void AnswerCountsToWire(const AnswerCounts::ByObject& counts, const Scene& scene,
                        v1::GetStatsReply::SceneStats* stats);

}  // namespace linetree
