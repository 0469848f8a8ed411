// A frame that must succeed.
#pragma once

#include <gtest/gtest.h>

#include <utility>

#include "core/render/scene_host.h"

namespace linetree::test {

inline Frame RenderFrame(SceneHost& host, const FrameRequest& request, WorkerPool& pool) {
  auto frame = host.RenderFrame(request, pool);
  EXPECT_TRUE(frame.ok()) << frame.status();
  return *std::move(frame);
}

}  // namespace linetree::test
