// How many lookups threads do in warm trees at the same time, and how that grows with threads.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "absl/status/statusor.h"
#include "core/audit/speed_study.h"
#include "core/cache/epoch.h"
#include "core/render/scene_host.h"

namespace linetree {

struct LookupStudyOptions {
  int width = 512, height = 512;  // of the frame whose eye rays are looked up
  int warm_frames = 6;            // of the same view, before
  int passes = 4;                 // of each thread over all rays, per repeat
  int repeat = 5;
  std::vector<int> threads = {1, 2};
  double epsilon = 0.02;
};

struct LookupRow {
  int threads = 1;
  EpochKind kind = EpochKind::kRcu;
  SpeedSpread per_second;  // lookups of all threads together
};

struct LookupStudy {
  size_t rays = 0;   // that hit something: each is one lookup in surface trees and linetrees
  size_t known = 0;  // of which surface trees know something
  uint64_t cells = 0;
  std::vector<LookupRow> rows;  // by threads, and readers without locks first
};

// Lookups by every number of threads and kind of readers, in turn. INVALID_ARGUMENT for a scene
// without camera or that sees nothing. Nobody else may read caches in this process meanwhile.
absl::StatusOr<LookupStudy> StudyLookups(std::shared_ptr<const Scene> scene,
                                         const LookupStudyOptions& options, WorkerPool& pool,
                                         const std::function<void(double)>& progress);

}  // namespace linetree
