// Measures where the time for one frame or batch goes.
//
// Thread safety: none.
#pragma once

#include <array>
#include <chrono>
#include <cstddef>

#include "linetree/v1/service.pb.h"

namespace linetree {

class FrameTimer {
 public:
  // As FrameTiming in service.proto says; nothing counts what is kElsewhere.
  enum class Stage { kQueue, kRender, kEncode, kElsewhere };

  // Ends the stage that was and begins another; a stage that comes back goes on.
  void Enter(Stage stage) {
    const Clock::time_point now = Clock::now();
    spent_[static_cast<size_t>(stage_)] += now - entered_;
    stage_ = stage;
    entered_ = now;
  }

  // Of the stages that have ended.
  v1::FrameTiming ToWire() const {
    v1::FrameTiming message;
    message.set_queue_ms(In(Stage::kQueue));
    message.set_render_ms(In(Stage::kRender));
    message.set_encode_ms(In(Stage::kEncode));
    return message;
  }

 private:
  using Clock = std::chrono::steady_clock;

  double In(Stage stage) const {
    const Clock::duration spent = spent_[static_cast<size_t>(stage)];
    return std::chrono::duration<double, std::milli>(spent).count();
  }

  Stage stage_ = Stage::kElsewhere;
  Clock::time_point entered_ = Clock::now();
  std::array<Clock::duration, 4> spent_{};
};

}  // namespace linetree
