// orbit SERVER SCENE FILE: loads a scene into a linetreed, flies once around it and prints how much
// of every frame came from the cache.
#include <cmath>
#include <cstdio>

#include "client/library/client.h"
#include "core/io/load_scene.h"

using namespace linetree;

int main(int argc, char** argv) {
  if (argc != 4) return std::fprintf(stderr, "usage: orbit HOST:PORT NAME FILE\n"), 2;
  const auto report = [](const absl::Status& status) {
    return std::fprintf(stderr, "orbit: %s\n", std::string(status.message()).c_str()), 1;
  };
  const auto file = ReadSceneFile(argv[3]);
  if (!file.ok()) return report(file.status());
  const auto client = Client::Connect(argv[1], {.retry = {.max_attempts = 10}});
  if (!client.ok()) return report(client.status());
  const auto scene = (*client)->LoadScene(argv[2], (*file)->message(), /*replace=*/true);
  if (!scene.ok()) return report(scene.status());

  std::vector<FrameRequest> views(8);
  for (size_t i = 0; i < views.size(); ++i) {
    const double angle_rad = 2 * M_PI * static_cast<double>(i) / static_cast<double>(views.size());
    views[i].camera.eye = {8 * std::cos(angle_rad), 4, 8 * std::sin(angle_rad)};
    views[i].width = views[i].height = 64;
  }
  const auto flown = (*client)->Fly(argv[2], views, /*format=*/{}, [](size_t i, Frame frame) {
    const FrameStats& stats = frame.stats;
    std::printf("frame %zu: %.0f %% from the cache\n", i,
                100.0 * static_cast<double>(stats.interpolated + stats.replayed) /
                    static_cast<double>(stats.pixels));
  });
  return flown.ok() ? 0 : report(flown);
}
