// orbit HOST:PORT NAME FILE: loads a scene into a linetreed, flies once around it and prints how
// much of every frame came from the cache.
#include <cmath>
#include <cstdio>

#include "client/library/client.h"
#include "core/io/load_scene.h"

using namespace linetree;

int main(int argc, char** argv) try {
  if (argc != 4) throw std::runtime_error("usage: orbit HOST:PORT NAME FILE");
  const auto client = Client::Connect(argv[1], {.retry = {.max_attempts = 10}}).value();
  client->LoadScene(argv[2], ReadSceneFile(argv[3]).value()->message(), /*replace=*/true).value();
  std::vector<FrameRequest> views(8);
  for (size_t i = 0; i < views.size(); ++i) {
    const double angle_rad = 2 * M_PI * static_cast<double>(i) / 8;
    views[i].camera.eye = {8 * std::cos(angle_rad), 4, 8 * std::sin(angle_rad)};
    views[i].width = views[i].height = 64;
  }
  const absl::Status flown = client->Fly(argv[2], views, {}, [](size_t i, const Frame& frame) {
    const auto hits = static_cast<double>(frame.stats.interpolated + frame.stats.replayed);
    std::printf("frame %zu: %.0f %% from the cache\n", i, 100 * hits / (64 * 64));
  });
  if (!flown.ok()) throw absl::BadStatusOrAccess(flown);
} catch (const std::exception& error) {
  std::fprintf(stderr, "orbit: %s\n", error.what());
  return 1;
}
