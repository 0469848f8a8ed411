// Scenes whose caches have learnt something, to be kept.
#pragma once

#include <memory>
#include <string>

#include "core/render/scene_host.h"
#include "core/store/scene_pages.h"
#include "tests/support/random_scene.h"
#include "tests/support/render_frame.h"

namespace linetree::test {

inline std::shared_ptr<const Scene> SceneOf(uint64_t seed, int objects = 40) {
  Random random(seed);
  auto scene = std::make_shared<Scene>(RandomScene(random, objects, 2));
  Camera camera;
  camera.eye = random.Direction() * 6;
  camera.up = random.Direction();
  camera.fov_deg = 40;
  scene->cameras = {camera};
  scene->version = std::string(24, 'a') + std::to_string(10'000'000 + seed);
  return scene;
}

inline std::unique_ptr<SceneHost> HostOf(const std::shared_ptr<const Scene>& scene) {
  CacheOptions options;
  options.always_ask = true;  // packets ask what is known, whether it pays or not
  return std::make_unique<SceneHost>(scene, options);
}

inline ScenePages::Caches CachesOf(SceneHost& host) {
  return {host.scene(), host.surfaces(), host.paths()};
}

inline FrameRequest Request(const Scene& scene, Mode mode, Lanes lanes = Lanes::kScalar,
                            double epsilon = 0) {
  FrameRequest request;
  request.camera = scene.cameras[0];
  request.width = request.height = 256;
  request.options.mode = mode;
  request.options.judge = JudgeKind::kCertified;
  request.options.lanes = lanes;
  request.options.max_relative_error = epsilon;
  return request;
}

// Both kinds of lanes, so that both kinds of cells are there, with sums and functions.
inline void Learn(SceneHost& host, WorkerPool& pool) {
  for (const Lanes lanes : {Lanes::kScalar, Lanes::kSimd}) {
    FrameRequest request = Request(host.scene(), Mode::kCached, lanes, 0.1);
    for (int frame = 0; frame < 6; ++frame) {
      RenderFrame(host, request, pool);
      Vec3d& eye = request.camera.eye;
      eye = {eye.z, eye.x, eye.y};  // another side of what is in the middle
      if (frame % 3 == 2) eye = -eye;
    }
  }
}

inline uint64_t CellsOf(SceneHost& host) {
  return host.surfaces().CellCount() + host.paths().CellCount();
}

}  // namespace linetree::test
