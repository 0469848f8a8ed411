#include "core/render/answer_rays.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "absl/container/flat_hash_map.h"
#include "core/math/check.h"

namespace linetree {
namespace {

// Rays that one iteration of a parallel loop handles: enough to hide the loop's cost, few enough to
// stop soon when a request is cancelled.
constexpr size_t kChunkRays = 1024;

class Batch {
 public:
  Batch(const Tracer& tracer, RadianceCache& cache, const RenderOptions& options,
        std::span<const Ray> rays, WorkerPool& pool, const CancelToken* cancel,
        std::span<RayAnswer> answers, FrameStats& stats)
      : tracer_(tracer),
        cache_(cache),
        options_(options),
        rays_(rays),
        pool_(pool),
        cancel_(cancel),
        answers_(answers),
        stats_(stats),
        hits_(rays.size()) {}

  void FindHits();
  void AnswerFromCache();
  // Traces what no cell answered.
  void TraceRest();
  // The same, with the certified trees' help, which grow on the way.
  void TraceWithTrees(CertifiedTrees& trees);
  bool IsCancelled() const { return cancel_ != nullptr && cancel_->IsCancelled(); }

 private:
  // A ray that may still be answered by a cell.
  struct Pending {
    uint32_t ray = 0;
    CellQuery query;
  };

  template <class F>
  void ForChunks(size_t count, RayCounts* counts, F body);
  // Who cancels does not wait for what others would learn either.
  ParallelLoop UnlessCancelled();
  void CollectPending();
  std::vector<uint32_t> Unanswered() const;
  // Looks the pending rays up; keeps those whose cell is unbuilt, with the cells in `unbuilt`.
  void LookUp(const RadianceCache::Session& session, std::vector<CellId>& unbuilt);
  // Of the unbuilt cells, those that enough rays ask for. Drops the rays of the others.
  std::vector<CellRef> ChooseCells(const std::vector<CellId>& unbuilt);
  // What interpolants may be off by; 0: there is no room for any.
  double InterpolationError() const {
    const double asked = options_.max_relative_error;
    return asked >= kMinInterpolationError ? asked : 0;
  }
  // Answers one ray with what the certified trees know.
  void AnswerWithTrees(uint32_t ray, const LightLists& lights, const PathCache::Reader& paths,
                       RayCounts& counts);

  const Tracer& tracer_;
  RadianceCache& cache_;
  const RenderOptions& options_;
  std::span<const Ray> rays_;
  WorkerPool& pool_;
  const CancelToken* cancel_;
  std::span<RayAnswer> answers_;
  FrameStats& stats_;
  std::vector<Hit> hits_;
  std::vector<Pending> pending_;
};

// body(begin, end, counts) over [0, count) in chunks; sums the chunks' counts in order.
template <class F>
void Batch::ForChunks(size_t count, RayCounts* counts, F body) {
  const size_t chunks = (count + kChunkRays - 1) / kChunkRays;
  std::vector<RayCounts> chunk_counts(chunks);
  pool_.ParallelFor(
      chunks,
      [&](size_t chunk) {
        if (IsCancelled()) return;
        const size_t begin = chunk * kChunkRays;
        body(begin, std::min(count, begin + kChunkRays), chunk_counts[chunk]);
      },
      &stats_.cpu_ms);
  for (const RayCounts& c : chunk_counts) *counts += c;
}

ParallelLoop Batch::UnlessCancelled() {
  return [this](size_t count, const std::function<void(size_t)>& body) {
    const auto unless_cancelled = [&](size_t i) {
      if (!IsCancelled()) body(i);
    };
    pool_.ParallelFor(count, unless_cancelled, &stats_.cpu_ms);
  };
}

void Batch::FindHits() {
  ForChunks(rays_.size(), &stats_.base, [&](size_t begin, size_t end, RayCounts& counts) {
    for (size_t i = begin; i < end; ++i) {
      hits_[i] = tracer_.Intersect(rays_[i].origin, rays_[i].direction, RayStart{});
      ++counts.eye;
      ++counts.intersect;
      RayAnswer& answer = answers_[i];
      answer = {};
      if (!hits_[i].IsHit()) {
        answer.radiance = tracer_.scene().background;
        continue;
      }
      answer.source = Source::kTraced;
      answer.object = hits_[i].object;
      answer.depth = hits_[i].t;
    }
  });
}

void Batch::CollectPending() {
  for (size_t i = 0; i < rays_.size(); ++i) {
    if (!hits_[i].IsHit()) continue;
    if (const auto query = cache_.QueryFor(hits_[i], rays_[i])) {
      pending_.push_back({static_cast<uint32_t>(i), *query});
    }
  }
}

void Batch::LookUp(const RadianceCache::Session& session, std::vector<CellId>& unbuilt) {
  std::vector<CellId> cells(pending_.size());
  std::vector<char> is_unbuilt(pending_.size());
  RayCounts none;
  ForChunks(pending_.size(), &none, [&](size_t begin, size_t end, RayCounts&) {
    std::array<CellQuery, kChunkRays> queries;
    std::array<CellAnswer, kChunkRays> found;
    const size_t count = end - begin;
    for (size_t i = 0; i < count; ++i) queries[i] = pending_[begin + i].query;
    cache_.Find(session, options_.max_relative_error, std::span(queries).first(count),
                std::span(found).first(count));
    for (size_t i = 0; i < count; ++i) {
      RayAnswer& answer = answers_[pending_[begin + i].ray];
      answer.verdict = found[i].verdict;
      if (found[i].kind == Lookup::Kind::kAnswer) {
        answer.radiance = found[i].radiance;
        answer.source = Source::kInterpolated;
      }
      is_unbuilt[begin + i] = found[i].kind == Lookup::Kind::kUnbuilt;
      cells[begin + i] = found[i].cell;
    }
  });
  unbuilt.clear();
  size_t kept = 0;
  for (size_t i = 0; i < pending_.size(); ++i) {
    if (!is_unbuilt[i]) continue;
    pending_[kept++] = pending_[i];
    unbuilt.push_back(cells[i]);
  }
  pending_.resize(kept);
}

std::vector<CellRef> Batch::ChooseCells(const std::vector<CellId>& unbuilt) {
  absl::flat_hash_map<CellRef, uint32_t> rays_of;
  const auto ref_of = [&](size_t i) {
    return CellRef{pending_[i].query.object, pending_[i].query.pair, unbuilt[i]};
  };
  for (size_t i = 0; i < pending_.size(); ++i) ++rays_of[ref_of(i)];
  const uint32_t least = cache_.options().min_cell_rays;
  size_t kept = 0;
  for (size_t i = 0; i < pending_.size(); ++i) {
    if (rays_of[ref_of(i)] >= least) pending_[kept++] = pending_[i];
  }
  pending_.resize(kept);
  std::vector<CellRef> cells;
  for (const auto& [ref, rays] : rays_of) {
    if (rays >= least) cells.push_back(ref);
  }
  std::sort(cells.begin(), cells.end());  // the table's order differs from run to run
  return cells;
}

void Batch::AnswerFromCache() {
  CollectPending();
  if (pending_.empty()) return;
  const RadianceCache::Session session = cache_.Open(options_.limits);
  const ParallelLoop loop = UnlessCancelled();
  std::vector<CellId> unbuilt;
  LookUp(session, unbuilt);
  // Each round goes one level deeper, unless another client's needs took cells away meanwhile.
  const int most_rounds = 2 * (cache_.options().max_cell_depth + 1);
  for (int round = 0; round < most_rounds && !pending_.empty() && !IsCancelled(); ++round) {
    const std::vector<CellRef> cells = ChooseCells(unbuilt);
    if (cells.empty()) return;
    const BuildStats built = cache_.Build(session, cells, loop);
    stats_.ip += built.counts;
    stats_.cells_tried += built.cells_tried;
    stats_.cells_accepted += built.cells_accepted;
    stats_.cells_evicted += built.cells_evicted;
    LookUp(session, unbuilt);
    if (built.cells_dropped > 0) return;  // the budget is full of cells in use
  }
}

std::vector<uint32_t> Batch::Unanswered() const {
  std::vector<uint32_t> rest;
  for (size_t i = 0; i < answers_.size(); ++i) {
    if (answers_[i].source == Source::kTraced) rest.push_back(static_cast<uint32_t>(i));
  }
  return rest;
}

// Rays go in waves: every 512th, then every 64th, every 8th, all others; scattered, so that no
// pattern of the picture can hide from the first ones.
constexpr int kWaves = 4;
int WaveOf(uint32_t ray) {
  const uint32_t mixed = (ray * 0x9e3779b1u) >> 23;  // 9 bits
  if (mixed == 0) return 0;
  if (mixed % 64 == 0) return 1;
  return mixed % 8 == 0 ? 2 : 3;
}

// In the first waves a ray stands for hundreds, but says where one is: of what certifies a cell or
// divides it, it counts for a quarter at most. Else every frame divides the cells that one of its
// first rays happens to meet, few as their own rays may be, and frames after frames all of them.
constexpr double kMostPointsOfRay = kMinSurfaceUses / 4;
constexpr double kMostPathUsesOfRay = kMinPathUses / 4.0;

void Batch::AnswerWithTrees(uint32_t ray, const LightLists& lights, const PathCache::Reader& paths,
                            RayCounts& counts) {
  const Hit& hit = hits_[ray];
  const Vec3d& direction = rays_[ray].direction;
  RayAnswer& answer = answers_[ray];
  if (const double epsilon = InterpolationError(); epsilon > 0) {
    answer.verdict = paths.Interpolate(hit, direction, epsilon, answer.radiance);
    if (answer.verdict == Verdict::kCertified) {
      answer.source = Source::kInterpolated;
      return;
    }
  }
  RayCounts own;
  answer.radiance = tracer_.RadianceFromHit(hit, rays_[ray].origin, direction, options_.limits,
                                            lights, &paths, own);
  if (own.intersect == 0 && own.summed > 0) {
    answer.source = Source::kInterpolated;
    answer.verdict = Verdict::kCertified;
  } else if (own.intersect == 0) {
    answer.source = Source::kReplayed;
  } else if (own.listed + own.listed_branches > 0) {
    answer.source = Source::kResidual;
  }
  counts += own;
}

void Batch::TraceWithTrees(CertifiedTrees& trees) {
  const ParallelLoop loop = UnlessCancelled();
  const std::vector<uint32_t> rest = Unanswered();
  for (int wave = 0; wave < kWaves && !IsCancelled(); ++wave) {
    std::vector<uint32_t> part;
    for (const uint32_t i : rest) {
      if (WaveOf(i) == wave) part.push_back(i);
    }
    // The last wave has nobody to tell where rays go.
    const bool is_last = wave == kWaves - 1;
    // Each ray of the wave stands for so many.
    const double weight = static_cast<double>(rest.size()) / static_cast<double>(part.size() + 1);
    const auto points =
        static_cast<uint32_t>(std::lround(std::clamp(weight, 1.0, kMostPointsOfRay)));
    std::mutex samples_mutex;
    std::vector<PathCache::Sample> samples;
    ForChunks(part.size(), &stats_.base, [&](size_t begin, size_t end, RayCounts& counts) {
      std::vector<PathCache::Sample> own;
      {
        const SurfaceCache::Reader lights(trees.surfaces, InterpolationError(), points);
        const PathCache::Reader paths(trees.paths, options_.limits, is_last ? nullptr : &own);
        for (size_t k = begin; k < end; ++k) AnswerWithTrees(part[k], lights, paths, counts);
      }
      std::lock_guard lock(samples_mutex);
      samples.insert(samples.end(), own.begin(), own.end());
    });
    if (IsCancelled()) return;
    SurfaceCache::Thrift thrift;
    thrift.ahead = options_.ahead;
    const SurfaceCache::Grown surfaces = trees.surfaces.Refine(/*weight=*/1, loop, thrift);
    uint64_t paths = 0, tried_paths = 0;
    const ParallelLoop counted = [&](size_t count, const std::function<void(size_t)>& body) {
      tried_paths += count;
      loop(count, body);
    };
    if (!is_last) {
      paths = trees.paths.Refine(options_.limits, samples, std::min(weight, kMostPathUsesOfRay),
                                 counted, options_.ahead, KeptUses(rays_.size()));
    }
    stats_.cells_tried += surfaces.cells + tried_paths;
    stats_.cells_accepted += surfaces.cells + paths;
    stats_.cells_unkept += surfaces.unkept + tried_paths - paths;
  }
}

void Batch::TraceRest() {
  const std::vector<uint32_t> rest = Unanswered();
  ForChunks(rest.size(), &stats_.base, [&](size_t begin, size_t end, RayCounts& counts) {
    for (size_t k = begin; k < end; ++k) {
      const uint32_t i = rest[k];
      answers_[i].radiance = tracer_.RadianceFromHit(hits_[i], rays_[i].origin, rays_[i].direction,
                                                     options_.limits, counts);
    }
  });
}

}  // namespace

void CountAnswers(std::span<const RayAnswer> answers, FrameStats& stats) {
  stats.pixels += answers.size();
  for (const RayAnswer& answer : answers) {
    ++stats.verdicts[static_cast<size_t>(answer.verdict)];
    switch (answer.source) {
      case Source::kBackground:
        ++stats.background;
        break;
      case Source::kInterpolated:
        ++stats.interpolated;
        break;
      case Source::kReplayed:
        ++stats.replayed;
        ++stats.traced;
        break;
      case Source::kResidual:
        ++stats.residual;
        ++stats.traced;
        break;
      case Source::kTraced:
        ++stats.traced;
        break;
    }
  }
}

absl::Status AnswerRays(const Tracer& tracer, RadianceCache& cache, CertifiedTrees trees,
                        const RenderOptions& options, std::span<const Ray> rays, WorkerPool& pool,
                        const CancelToken* cancel, const Progress& progress,
                        std::span<RayAnswer> answers, FrameStats& stats) {
  LT_CHECK(rays.size() == answers.size());
  // A batch of this size bounds the memory for hits and queries (40 MiB) whatever a request asks
  // for.
  constexpr size_t kBatchRays = size_t{1} << 18;
  const bool certified = options.mode == Mode::kCached && options.judge == JudgeKind::kCertified;
  const bool interpolated = options.mode == Mode::kCached && options.judge == JudgeKind::kPaper &&
                            options.max_relative_error >= kMinInterpolationError;
  for (size_t begin = 0; begin < rays.size(); begin += kBatchRays) {
    const size_t count = std::min(kBatchRays, rays.size() - begin);
    const auto part = answers.subspan(begin, count);
    Batch batch(tracer, cache, options, rays.subspan(begin, count), pool, cancel, part, stats);
    const auto report = [&](double share) {
      const double done = static_cast<double>(begin) + share * static_cast<double>(count);
      if (progress) progress(done / static_cast<double>(rays.size()));
    };
    batch.FindHits();
    report(0.2);
    if (interpolated && !batch.IsCancelled()) batch.AnswerFromCache();
    report(0.5);
    if (certified && !batch.IsCancelled()) batch.TraceWithTrees(trees);
    if (!certified && !batch.IsCancelled()) batch.TraceRest();
    if (batch.IsCancelled()) return absl::CancelledError("the request was cancelled");
    CountAnswers(part, stats);
    report(1);
  }
  stats.cache_bytes = cache.ByteSize() + trees.ByteSize();
  return absl::OkStatus();
}

}  // namespace linetree
