// Limits on everything that comes from the wire or is held for a client, in one place. What exceeds
// one is refused with RESOURCE_EXHAUSTED before it costs anything.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>

#include "core/render/options.h"
#include "core/scene/scene.h"

namespace linetree {

struct ServerLimits {
  // Sizes of pictures, which are smaller than what `--local` takes: the server holds many at a
  // time. 2^25 pixels hold an 8K picture (7680 x 4320); 2^29 samples are 16 for each of them.
  RenderLimits render{.max_side = 16384,
                      .max_pixels = uint64_t{1} << 25,
                      .max_samples = uint64_t{1} << 29,
                      .max_rays = uint64_t{1} << 20};

  // What gRPC accepts at all: above a batch of 10^7 rays of 62 bytes, so that such a batch is
  // refused by a message that says `rays`.
  int max_message_bytes = 768 << 20;
  size_t max_scene_bytes = size_t{256} << 20;
  // Messages within a scene's message: several for each of the objects that it may have, and some
  // gigabytes at worst.
  uint64_t max_scene_messages = 40'000'000;
  size_t max_batch_bytes = size_t{80} << 20;  // max_rays rays, and what goes with them
  // Requests other than scenes and batches of rays.
  size_t max_request_bytes = size_t{1} << 20;

  SceneLimits scene;
  size_t max_scenes = 256;
  uint64_t max_objects_in_all_scenes = 16'000'000;

  // Frames and batches that wait for a render slot, and their rays together: several times what one
  // may have. Flights are not among them.
  size_t max_waiting_renders = 64;
  uint64_t max_waiting_rays = uint64_t{1} << 31;
  // Scenes that wait to be built.
  size_t max_waiting_loads = 8;
  // Flights at a time, and what each may send ahead before the server stops reading.
  uint64_t max_flights = 256;
  size_t max_pending_viewpoints = 64;
  int max_streams_per_connection = 256;
  // Frames that are being rendered or sent, together.
  uint64_t max_frame_bytes = uint64_t{4} << 30;

  // Of one warm-up.
  uint32_t max_warm_up_frames = 1000;

  // Answers that wait to be traced again by the audit.
  size_t max_waiting_audits = 4096;

  // When a caller that was refused for want of room should come back.
  std::chrono::milliseconds retry_after_ms{200};
};

// What one pixel of a Frame takes in memory.
inline constexpr uint64_t kFrameBytesPerPixel =
    3 * sizeof(float) + sizeof(int32_t) + 2 + sizeof(float);

}  // namespace linetree
