// A flight whose viewpoints come while it lasts, for clients that steer by what they see: only the
// newest one waits, and what it has overtaken gets no frame.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>

#include "absl/status/statusor.h"
#include "core/io/frame_codec.h"
#include "core/render/scene_host.h"

namespace linetree {

struct LiveOptions {
  FrameFormat format{};
  // If set, a viewpoint first gets a frame that is smaller, or rougher, and the full one when no
  // newer viewpoint has come by then. `divisor`, in [1, 64], divides width and height.
  struct WhileMoving {
    int divisor = 1;
    std::optional<double> max_relative_error{};
  };
  std::optional<WhileMoving> while_moving{};
};

struct LiveFrame {
  uint64_t view = 0;  // the viewpoint's number
  bool reduced = false;
  uint64_t skipped = 0;  // viewpoints that the server overtook since the frame before this one
  Frame frame;
};

// Thread safety: all methods may be called from any thread; from within OnFrame only Look.
class LiveFlight {
 public:
  // Called from a thread of the flight, with one frame at a time, in the order of viewpoints.
  using OnFrame = std::function<void(LiveFrame frame)>;

  // Gives up what has not come yet.
  virtual ~LiveFlight() = default;

  // Takes the place of a viewpoint that has not been sent, and does not wait. Viewpoints are
  // numbered from 0 on; this is the number, or why the flight has ended.
  virtual absl::StatusOr<uint64_t> Look(const FrameRequest& view) = 0;

  // For whoever has the next viewpoint at some time: waits until then, or until the flight has
  // ended, and says whether it has.
  virtual bool HasEndedBy(std::chrono::system_clock::time_point time) = 0;

  // No viewpoint comes any more: waits for the full frame of the newest one. OK, or why the flight
  // has ended without it, which may have been before: an error that is no reason to try again, or
  // DEADLINE_EXCEEDED when ClientOptions::call_timeout_ms has gone by without any frame though a
  // viewpoint waited.
  virtual absl::Status Land() = 0;
};

}  // namespace linetree
