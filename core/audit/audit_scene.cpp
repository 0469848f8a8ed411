#include "core/audit/audit_scene.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/audit/comparison.h"
#include "core/audit/query_rays.h"
#include "core/math/check.h"

namespace linetree {
namespace {

// How the queries of a scene are spent: the frames warm the cache and are asked one epsilon each,
// all other rays are asked at every epsilon.
constexpr double kFrameShare = 0.4;
constexpr double kLatticeShare = 0.15;
constexpr double kClimbShare = 0.15;
constexpr size_t kMaxViews = 2;
constexpr int kFramesPerView = 4;  // cold and warm, by packets and then ray by ray
constexpr int kMinSide = 16, kMaxSide = 512;
// Every climber takes so many steps, longer ones after success, shorter ones after failure, and any
// from the shortest to the longest where nothing changes. Relative to the scene's size.
constexpr int kClimbSteps = 24;
constexpr double kShortestStep = 1e-7, kLongestStep = 0.1;
// Rays of one iteration of a parallel loop.
constexpr size_t kChunkRays = 256;

template <class F>
void ForChunks(WorkerPool& pool, size_t count, const F& body) {
  pool.ParallelFor((count + kChunkRays - 1) / kChunkRays, [&](size_t chunk) {
    const size_t begin = chunk * kChunkRays;
    body(begin, std::min(count, begin + kChunkRays));
  });
}

// Rays as they are asked, with their classical answers.
struct Questions {
  std::vector<Ray> rays;
  std::vector<Rgb> classical;
};

struct Answers {
  std::vector<Rgb> radiance;
  PixelLayer<Source> source;
  FrameStats stats;
  bool from_frame = false;   // rounded to float, whatever the lanes
  double lane_rounding = 0;  // of the Frame or RayBatch
  // The classical answers that were traced the same way, where that is not in double.
  PixelLayer<float> same_lanes;
};

// What surface trees say is to be audited, not whether it pays to ask them.
CacheOptions CacheOf(const SceneAuditRequest& request) {
  CacheOptions options = request.cache;
  options.always_ask = true;
  return options;
}

class Auditor {
 public:
  Auditor(const SceneAuditRequest& request, Answerer& answerer, WorkerPool& pool)
      : request_(request),
        answerer_(answerer),
        pool_(pool),
        random_(request.seed),
        host_(request.scene, CacheOf(request)),
        views_(request.scene->cameras.begin(),
               request.scene->cameras.begin() +
                   static_cast<std::ptrdiff_t>(std::min(kMaxViews, request.scene->cameras.size()))),
        rays_(host_.tracer(), views_),
        floor_(RadianceFloor(*request.scene)) {
    audit_.by_epsilon.resize(request.epsilons.size());
  }

  absl::StatusOr<SceneAudit> Run();

 private:
  absl::Status AskFrames();
  absl::Status AskFrame(const Camera& camera, size_t epsilon, const Questions& questions, int side,
                        Lanes lanes);
  absl::Status AskRays(QueryKind kind, size_t count);
  absl::Status AskRays(QueryKind kind, size_t epsilon, const Questions& questions, Lanes lanes);
  absl::Status Climb(size_t epsilon, size_t count);

  // `eye_rays`: asked as pixels, which are traced as they are; others as TraceRays makes them.
  Questions Trace(std::vector<Ray> rays, bool eye_rays) const;
  absl::StatusOr<Answers> Ask(const Questions& questions, size_t epsilon, Lanes lanes);
  // Compares, counts, keeps violations; returns error over allowed for every question.
  std::vector<double> Judge(QueryKind kind, size_t epsilon, const Questions& questions,
                            const Answers& answers);
  void Keep(size_t epsilon, const Ray& ray, const Rgb& classical, const Rgb& answer,
            bool from_frame, double error_over_allowed);
  RenderOptions OptionsOf(size_t epsilon) const;

  const SceneAuditRequest& request_;
  Answerer& answerer_;
  WorkerPool& pool_;
  RandomStream random_;
  SceneHost host_;
  const std::vector<Camera> views_;
  const QueryRays rays_;
  const double floor_;
  // A ray, and the error found along it.
  struct Climber {
    double error_over_allowed;
    Ray ray;
    double step;
  };
  void Move(Climber& climber, const Ray& ray, double error_over_allowed);
  std::vector<std::vector<Climber>> starts_;  // by epsilon
  SceneAudit audit_;
};

RenderOptions Auditor::OptionsOf(size_t epsilon) const {
  RenderOptions options;
  options.judge = request_.judge;
  options.max_relative_error = request_.epsilons[epsilon];
  options.limits = request_.limits;
  return options;
}

Questions Auditor::Trace(std::vector<Ray> rays, bool eye_rays) const {
  Questions questions;
  questions.rays = std::move(rays);
  questions.classical.resize(questions.rays.size());
  ForChunks(pool_, questions.rays.size(), [&](size_t begin, size_t end) {
    RayCounts counts;
    for (size_t i = begin; i < end; ++i) {
      const Ray ray = eye_rays ? questions.rays[i] : *UnitRay(questions.rays[i], i);
      questions.classical[i] =
          host_.tracer().Radiance(ray.origin, ray.direction, request_.limits, counts);
    }
  });
  return questions;
}

absl::StatusOr<Answers> Auditor::Ask(const Questions& questions, size_t epsilon, Lanes lanes) {
  RenderOptions options = OptionsOf(epsilon);
  options.lanes = lanes;
  auto batch = answerer_.TraceRays(host_, questions.rays, options, pool_);
  if (!batch.ok()) return batch.status();
  LT_CHECK(batch->answers.size() == questions.rays.size());
  Answers answers;
  answers.lane_rounding = batch->lane_rounding;
  answers.stats = batch->stats;
  if (batch->lane_rounding > 0) {
    options.mode = Mode::kClassical;
    const auto classical = host_.TraceRays(questions.rays, options, pool_);
    if (!classical.ok()) return classical.status();
    answers.same_lanes.resize(3 * classical->answers.size());
    for (size_t i = 0; i < answers.same_lanes.size(); ++i) {
      const Rgb& radiance = classical->answers[i / 3].radiance;
      answers.same_lanes[i] = static_cast<float>(radiance[static_cast<int>(i % 3)]);
    }
  }
  for (const RayAnswer& answer : batch->answers) {
    answers.radiance.push_back(answer.radiance);
    answers.source.push_back(answer.source);
  }
  return answers;
}

std::vector<double> Auditor::Judge(QueryKind kind, size_t epsilon, const Questions& questions,
                                   const Answers& answers) {
  const size_t count = questions.rays.size();
  std::vector<Comparison> results(count);
  const double allowed = request_.epsilons[epsilon];
  const bool rounded = answers.from_frame || answers.lane_rounding > 0;
  ForChunks(pool_, count, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Rgb &answer = answers.radiance[i], &classical = questions.classical[i];
      results[i] = rounded
                       ? CompareRounded(answer, classical, allowed, floor_, answers.lane_rounding)
                       : Compare(answer, classical, allowed, floor_);
      if (answers.same_lanes.empty()) continue;
      const float* same = &answers.same_lanes[3 * i];
      results[i].equal = answer.r == static_cast<double>(same[0]) &&
                         answer.g == static_cast<double>(same[1]) &&
                         answer.b == static_cast<double>(same[2]);
      if (allowed == 0 && !results[i].equal) results[i].error_over_allowed = Box3::kInf;
    }
  });
  AuditTally tally;
  tally.queries = count;
  tally.shadow_rays = answers.stats.base.shadow;
  tally.listed_shadow_rays = answers.stats.base.listed;
  std::vector<double> errors(count);
  for (size_t i = 0; i < count; ++i) {
    tally.hits += answers.source[i] != Source::kBackground;
    tally.from_cells +=
        answers.source[i] != Source::kBackground && answers.source[i] != Source::kTraced;
    tally.equal += results[i].equal;
    errors[i] = results[i].error_over_allowed;
    tally.max_error_over_allowed = std::max(tally.max_error_over_allowed, errors[i]);
    if (!results[i].IsViolation()) continue;
    ++tally.violations;
    Keep(epsilon, questions.rays[i], questions.classical[i], answers.radiance[i],
         answers.from_frame, errors[i]);
  }
  audit_.by_epsilon[epsilon] += tally;
  audit_.by_kind[static_cast<size_t>(kind)] += tally;
  return errors;
}

void Auditor::Keep(size_t epsilon, const Ray& ray, const Rgb& classical, const Rgb& answer,
                   bool from_frame, double error_over_allowed) {
  if (audit_.violations.size() >= request_.max_violations) return;
  audit_.violations.push_back({.scene = request_.name,
                               .ray = ray,
                               .options = OptionsOf(epsilon),
                               .from_frame = from_frame,
                               .answer = answer,
                               .classical = classical,
                               .error_over_allowed = error_over_allowed});
}

absl::Status Auditor::AskFrame(const Camera& camera, size_t epsilon, const Questions& questions,
                               int side, Lanes lanes) {
  FrameRequest request;
  request.camera = camera;
  request.width = request.height = side;
  request.options = OptionsOf(epsilon);
  request.options.lanes = lanes;
  const auto frame = answerer_.RenderFrame(host_, request, pool_);
  if (!frame.ok()) return frame.status();
  Answers answers;
  answers.from_frame = true;
  answers.lane_rounding = frame->lane_rounding;
  answers.stats = frame->stats;
  answers.source = frame->source;
  for (size_t i = 0; i < questions.rays.size(); ++i) {
    answers.radiance.push_back(
        {frame->radiance[3 * i], frame->radiance[3 * i + 1], frame->radiance[3 * i + 2]});
  }
  if (frame->lane_rounding > 0) {
    request.options.mode = Mode::kClassical;
    auto classical = host_.RenderFrame(request, pool_);
    if (!classical.ok()) return classical.status();
    answers.same_lanes = std::move(classical->radiance);
  }
  Judge(QueryKind::kFrame, epsilon, questions, answers);
  return absl::OkStatus();
}

absl::Status Auditor::AskFrames() {
  const double pixels = kFrameShare * static_cast<double>(request_.queries) /
                        static_cast<double>(kFramesPerView * views_.size());
  const int side = std::clamp(static_cast<int>(std::sqrt(pixels)), kMinSide, kMaxSide);
  size_t epsilon = 0;
  for (const Camera& camera : views_) {
    const EyeRays eye_rays(camera, side, side);
    std::vector<Ray> rays;
    for (int i = 0; i < side * side; ++i) rays.push_back(eye_rays.ThroughPixel(i % side, i / side));
    const Questions questions = Trace(std::move(rays), /*eye_rays=*/true);
    for (int repeat = 0; repeat < kFramesPerView; ++repeat) {
      const Lanes lanes = repeat < kFramesPerView / 2 ? Lanes::kSimd : Lanes::kScalar;
      if (auto s = AskFrame(camera, epsilon, questions, side, lanes); !s.ok()) return s;
      epsilon = (epsilon + 1) % request_.epsilons.size();
    }
  }
  return absl::OkStatus();
}

absl::Status Auditor::AskRays(QueryKind kind, size_t count) {
  std::vector<Ray> rays;
  for (size_t i = 0; i < count; ++i) {
    rays.push_back(kind == QueryKind::kLattice ? rays_.Lattice(random_) : rays_.Random(random_));
  }
  const auto half = rays.begin() + static_cast<std::ptrdiff_t>(count / 2);
  const Questions by_packets = Trace({rays.begin(), half}, /*eye_rays=*/false);
  const Questions one_by_one = Trace({half, rays.end()}, /*eye_rays=*/false);
  for (size_t epsilon = 0; epsilon < request_.epsilons.size(); ++epsilon) {
    if (auto s = AskRays(kind, epsilon, by_packets, Lanes::kSimd); !s.ok()) return s;
    if (auto s = AskRays(kind, epsilon, one_by_one, Lanes::kScalar); !s.ok()) return s;
  }
  return absl::OkStatus();
}

absl::Status Auditor::AskRays(QueryKind kind, size_t epsilon, const Questions& questions,
                              Lanes lanes) {
  const auto answers = Ask(questions, epsilon, lanes);
  if (!answers.ok()) return answers.status();
  const std::vector<double> errors = Judge(kind, epsilon, questions, *answers);
  for (size_t i = 0; i < errors.size(); ++i) {
    // Without any error every ray is as good: some are kept.
    if (errors[i] > 0 || i % 8 == 0) {
      const double step = random_.LogUniform(kShortestStep, kLongestStep);
      starts_[epsilon].push_back({errors[i], questions.rays[i], step});
    }
  }
  return absl::OkStatus();
}

// To a ray with no smaller error; the next step depends on the success of this one.
void Auditor::Move(Climber& climber, const Ray& ray, double error_over_allowed) {
  const double before = climber.error_over_allowed;
  if (error_over_allowed >= before) {
    climber.error_over_allowed = error_over_allowed;
    climber.ray = ray;
  }
  if (error_over_allowed > before) {
    climber.step = std::min(1.5 * climber.step, kLongestStep);
  } else if (error_over_allowed < before) {
    climber.step = std::max(0.7 * climber.step, kShortestStep);
  } else {
    climber.step = random_.LogUniform(kShortestStep, kLongestStep);
  }
}

absl::Status Auditor::Climb(size_t epsilon, size_t count) {
  std::vector<Climber>& climbers = starts_[epsilon];
  count = std::min(count, climbers.size());
  // Among equals, and without any error all are, lattice rays get their turn too.
  for (size_t i = climbers.size(); i > 1; --i) {
    std::swap(climbers[i - 1], climbers[random_.Index(i)]);
  }
  std::stable_sort(climbers.begin(), climbers.end(), [](const Climber& a, const Climber& b) {
    return a.error_over_allowed > b.error_over_allowed;
  });
  climbers.resize(count);
  for (int step = 0; step < kClimbSteps && count > 0; ++step) {
    std::vector<Ray> rays;
    for (const Climber& climber : climbers) {
      rays.push_back(rays_.Near(climber.ray, climber.step, random_));
    }
    const Questions questions = Trace(std::move(rays), /*eye_rays=*/false);
    const auto answers = Ask(questions, epsilon, Lanes::kScalar);
    if (!answers.ok()) return answers.status();
    const std::vector<double> errors = Judge(QueryKind::kClimb, epsilon, questions, *answers);
    for (size_t i = 0; i < count; ++i) Move(climbers[i], questions.rays[i], errors[i]);
  }
  return absl::OkStatus();
}

absl::StatusOr<SceneAudit> Auditor::Run() {
  starts_.resize(request_.epsilons.size());
  if (auto s = AskFrames(); !s.ok()) return s;
  const double each =
      static_cast<double>(request_.queries) / static_cast<double>(request_.epsilons.size());
  const auto share = [&](double of) { return static_cast<size_t>(std::ceil(of * each)); };
  const double random_share = 1 - kFrameShare - kLatticeShare - kClimbShare;
  if (auto s = AskRays(QueryKind::kRandom, share(random_share)); !s.ok()) return s;
  if (auto s = AskRays(QueryKind::kLattice, share(kLatticeShare)); !s.ok()) return s;
  for (size_t epsilon = 0; epsilon < request_.epsilons.size(); ++epsilon) {
    if (auto s = Climb(epsilon, share(kClimbShare / kClimbSteps)); !s.ok()) return s;
  }
  return std::move(audit_);
}

}  // namespace

absl::StatusOr<SceneAudit> AuditScene(const SceneAuditRequest& request, Answerer& answerer,
                                      WorkerPool& pool) {
  if (request.scene->cameras.empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat(request.name, ": expected a scene with a camera"));
  }
  for (const double epsilon : request.epsilons) {
    if (epsilon >= 0 && epsilon <= 1) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("epsilon: expected a number in [0, 1], got ", epsilon));
  }
  if (request.epsilons.empty()) return absl::InvalidArgumentError("epsilon: expected one at least");
  return Auditor(request, answerer, pool).Run();
}

}  // namespace linetree
