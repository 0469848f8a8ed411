#include "peers/classical_peer.h"

#include "core/audit/clock.h"
#include "core/render/scene_host.h"

namespace linetree {
namespace {

class ClassicalPeer : public Peer {
 public:
  explicit ClassicalPeer(const PeerSetup& setup)
      : limits_(setup.limits), host_(setup.scene), pool_(setup.threads) {}

  std::string Version() const override { return LINETREE_VERSION; }
  std::string Timed() const override { return "the frame"; }

  absl::StatusOr<PeerPicture> Render(const Camera& camera, int width, int height) override {
    FrameRequest request;
    request.camera = camera;
    request.width = width;
    request.height = height;
    request.options.mode = Mode::kClassical;
    request.options.limits = limits_;
    const double start_us = NowUs();
    auto frame = host_.RenderFrame(request, pool_);
    if (!frame.ok()) return frame.status();
    PeerPicture picture;
    picture.seconds = (NowUs() - start_us) / 1e6;
    picture.radiance.assign(frame->radiance.begin(), frame->radiance.end());
    return picture;
  }

 private:
  const PathLimits limits_;
  SceneHost host_;
  WorkerPool pool_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<Peer>> MakeClassicalPeer(const PeerSetup& setup) {
  return std::make_unique<ClassicalPeer>(setup);
}

}  // namespace linetree
