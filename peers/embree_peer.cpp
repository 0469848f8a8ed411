#include "peers/embree_peer.h"

#ifdef LINETREE_EMBREE
#include "core/audit/clock.h"
#include "core/render/worker_pool.h"
#include "peers/embree/embree_tracer.h"
#endif

namespace linetree {

#ifdef LINETREE_EMBREE
namespace {

class EmbreePeer : public Peer {
 public:
  explicit EmbreePeer(const PeerSetup& setup)
      : scene_(setup.scene), limits_(setup.limits), tracer_(*scene_), pool_(setup.threads) {}

  std::string Version() const override { return tracer_.Version(); }
  std::string Timed() const override { return "the loop over pixels"; }

  absl::StatusOr<PeerPicture> Render(const Camera& camera, int width, int height) override {
    PeerPicture picture;
    const double start_us = NowUs();
    picture.radiance.resize(3 * static_cast<size_t>(width) * static_cast<size_t>(height));
    const EyeRays rays(camera, width, height);
    pool_.ParallelFor(static_cast<size_t>(height), [&](size_t row) {
      float* out = &picture.radiance[3 * row * static_cast<size_t>(width)];
      for (int column = 0; column < width; ++column) {
        const Ray ray = rays.ThroughPixel(column, static_cast<int>(row));
        const Rgb radiance = tracer_.Radiance(ray, limits_);
        for (int i = 0; i < 3; ++i) *out++ = static_cast<float>(radiance[i]);
      }
    });
    picture.seconds = (NowUs() - start_us) / 1e6;
    return picture;
  }

 private:
  const std::shared_ptr<const Scene> scene_;
  const PathLimits limits_;
  const EmbreeTracer tracer_;
  WorkerPool pool_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Peer>> MakeEmbreePeer(const PeerSetup& setup) {
  return std::make_unique<EmbreePeer>(setup);
}
#else
absl::StatusOr<std::unique_ptr<Peer>> MakeEmbreePeer(const PeerSetup& /*setup*/) {
  return absl::UnavailableError(
      "built without Embree: install the package libembree-dev and build again");
}
#endif

}  // namespace linetree
