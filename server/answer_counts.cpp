#include "server/answer_counts.h"

#include <string>

#include "core/io/layer_colors.h"
#include "core/math/check.h"

namespace linetree {
namespace {

using SceneStats = v1::GetStatsReply::SceneStats;
using ObjectStats = v1::GetStatsReply::ObjectStats;

void ToWire(const AnswerCounts::Counts& counts, v1::GetStatsReply::AnswerCounts* out) {
  uint64_t answers = 0;
  for (size_t s = 0; s < kSourceCount; ++s) {
    answers += counts.sources[s];
    if (counts.sources[s] > 0) {
      (*out->mutable_sources())[std::string(SourceLegend()[s].label)] = counts.sources[s];
    }
  }
  for (size_t v = 0; v < kVerdictCount; ++v) {
    if (counts.verdicts[v] > 0) {
      (*out->mutable_verdicts())[std::string(kVerdictNames[v])] = counts.verdicts[v];
    }
  }
  out->set_answers(answers);
}

}  // namespace

AnswerCounts::Counts& AnswerCounts::Counts::operator+=(const Counts& o) {
  for (size_t s = 0; s < kSourceCount; ++s) sources[s] += o.sources[s];
  for (size_t v = 0; v < kVerdictCount; ++v) verdicts[v] += o.verdicts[v];
  return *this;
}

void AnswerCounts::Add(std::span<const int32_t> object, std::span<const Source> source,
                       std::span<const Verdict> verdict) {
  LT_CHECK(object.size() == source.size() && object.size() == verdict.size());
  ByObject counts;
  // Neighbours are mostly alike: one look-up for a run of them.
  for (size_t begin = 0, end = 0; begin < object.size(); begin = end) {
    while (end < object.size() && object[end] == object[begin] && source[end] == source[begin] &&
           verdict[end] == verdict[begin]) {
      ++end;
    }
    Counts& of_object = counts[object[begin]];
    of_object.sources[static_cast<size_t>(source[begin])] += end - begin;
    of_object.verdicts[static_cast<size_t>(verdict[begin])] += end - begin;
  }
  Merge(counts);
}

void AnswerCounts::Add(const RayBatch& batch) {
  ByObject counts;
  for (const RayAnswer& answer : batch.answers) {
    Counts& of_object = counts[answer.object];
    ++of_object.sources[static_cast<size_t>(answer.source)];
    ++of_object.verdicts[static_cast<size_t>(answer.verdict)];
  }
  Merge(counts);
}

void AnswerCounts::Merge(const ByObject& more) {
  const std::lock_guard lock(mutex_);
  for (const auto& [object, counts] : more) {
    counts_[object] += counts;
    sum_ += counts;
  }
}

AnswerCounts::ByObject AnswerCounts::values() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

AnswerCounts::Counts AnswerCounts::sum() const {
  const std::lock_guard lock(mutex_);
  return sum_;
}

void AnswerSumToWire(const AnswerCounts::Counts& sum, SceneStats* stats) {
  ToWire(sum, stats->mutable_answers());
}

void AnswerCountsToWire(const AnswerCounts::ByObject& counts, const Scene& scene,
                        SceneStats* stats) {
  std::map<uint32_t, ObjectStats> objects;
  for (ObjectStats& object : *stats->mutable_objects()) {
    objects[object.object()] = std::move(object);
  }
  AnswerCounts::Counts all;
  for (const auto& [index, of_object] : counts) {
    all += of_object;
    if (index < 0) continue;
    ObjectStats& object = objects[static_cast<uint32_t>(index)];
    object.set_object(static_cast<uint32_t>(index));
    object.set_name(scene.objects[static_cast<size_t>(index)].name);
    ToWire(of_object, object.mutable_answers());
  }
  stats->clear_objects();
  for (auto& [index, object] : objects) *stats->add_objects() = std::move(object);
  ToWire(all, stats->mutable_answers());
}

}  // namespace linetree
