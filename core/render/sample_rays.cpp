#include "core/render/sample_rays.h"

#include <algorithm>
#include <vector>

#include "core/render/sample_mean.h"

namespace linetree {
namespace {

// About as many as one batch of AnswerRays, so rays and answers of a whole large picture never
// exist at once.
constexpr size_t kBatchSamples = size_t{1} << 18;
// Pixels that one iteration of a parallel loop handles.
constexpr size_t kChunkPixels = 256;

// Pixels [first, first + count) of a frame, in rows.
class PixelBatch {
 public:
  PixelBatch(const PixelSamples& samples, const EyeRays& eye_rays, size_t first, size_t count,
             Frame& frame)
      : samples_(samples),
        eye_rays_(eye_rays),
        first_(first),
        count_(count),
        each_(static_cast<size_t>(samples.count())),
        frame_(frame) {}

  std::vector<Ray> MakeRays(WorkerPool& pool) const {
    std::vector<Ray> rays(count_ * each_);
    ForPixels(pool, [&](size_t i) {
      const auto width = static_cast<size_t>(frame_.width);
      const auto left = static_cast<int>((first_ + i) % width) * samples_.across();
      const auto top = static_cast<int>((first_ + i) / width) * samples_.down();
      for (int row = 0; row < samples_.down(); ++row) {
        for (int column = 0; column < samples_.across(); ++column) {
          rays[Index(i, column, row)] = samples_.RayOf(eye_rays_, left + column, top + row);
        }
      }
    });
    return rays;
  }

  void StoreMeans(std::span<const RayAnswer> answers, WorkerPool& pool) {
    const ShownSample shown(samples_);
    ForPixels(pool, [&](size_t i) {
      const size_t p = first_ + i;
      const Rgb mean = MeanOfSamples(
          samples_, [&](int column, int row) { return answers[Index(i, column, row)].radiance; });
      for (int c = 0; c < 3; ++c) {
        frame_.radiance[3 * p + static_cast<size_t>(c)] = static_cast<float>(mean[c]);
      }
      const RayAnswer& answer = answers[Index(i, shown.column, shown.row)];
      frame_.object[p] = answer.object;
      frame_.source[p] = answer.source;
      frame_.verdict[p] = answer.verdict;
      frame_.depth[p] = static_cast<float>(answer.depth);
    });
  }

 private:
  size_t Index(size_t pixel, int column, int row) const {
    return pixel * each_ + static_cast<size_t>(row * samples_.across() + column);
  }

  template <class Body>
  void ForPixels(WorkerPool& pool, const Body& body) const {
    const auto chunk = [&](size_t number) {
      const size_t end = std::min(count_, (number + 1) * kChunkPixels);
      for (size_t i = number * kChunkPixels; i < end; ++i) body(i);
    };
    pool.ParallelFor((count_ + kChunkPixels - 1) / kChunkPixels, chunk, &frame_.stats.cpu_ms);
  }

  const PixelSamples& samples_;
  const EyeRays& eye_rays_;
  const size_t first_, count_, each_;
  Frame& frame_;
};

}  // namespace

absl::Status AnswerSamples(const Tracer& tracer, RadianceCache& cache, CertifiedTrees trees,
                           const RenderOptions& options, WorkerPool& pool,
                           const CancelToken* cancel, const Progress& progress, Frame& frame) {
  const PixelSamples samples(frame.sampling);
  const EyeRays eye_rays =
      EyeRays(frame.camera, frame.width, frame.height).Divided(samples.across(), samples.down());
  const size_t pixels = frame.object.size();
  const size_t most = kBatchSamples / static_cast<size_t>(samples.count());
  for (size_t first = 0; first < pixels; first += most) {
    const size_t count = std::min(most, pixels - first);
    PixelBatch batch(samples, eye_rays, first, count, frame);
    const std::vector<Ray> rays = batch.MakeRays(pool);
    std::vector<RayAnswer> answers(rays.size());
    const auto part_progress = [&](double share) {
      const double done = static_cast<double>(first) + share * static_cast<double>(count);
      if (progress) progress(done / static_cast<double>(pixels));
    };
    if (auto s = AnswerRays(tracer, cache, trees, options, rays, pool, cancel, part_progress,
                            answers, frame.stats);
        !s.ok()) {
      return s;
    }
    batch.StoreMeans(answers, pool);
  }
  return absl::OkStatus();
}

}  // namespace linetree
