// Runs a load test: many clients at the same time, closed loop or open loop.
//
// In a closed loop every client asks for its next frame when the last one has come. In an open loop
// frames begin when a plan of arrivals says, each at the next client that is free, and their
// latency counts from then: a server that stalls delays what would have come meanwhile, and that
// shows.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/command/load_plan.h"
#include "client/command/load_report.h"
#include "client/library/client.h"

namespace linetree {

struct LoadPlan {
  std::string scene{};   // as the clients know it
  FrameRequest frame{};  // all of it but the camera
  std::vector<std::vector<Camera>> paths{};
  std::vector<FlightPiece> pieces{};  // one for each client
  size_t frames_each = 0;             // of each client; 0: as many as its piece has
  double duration_s = 0;  // no frame begins later; 0: no such end, then frames_each counts
  // Open loop. frames_each bounds the mean over all clients, if it is set.
  std::optional<ArrivalOptions> arrivals{};
  // Before the measured frames, in a closed loop, each client's first ones; then all begin again.
  size_t warm_up_frames = 0;
  // Frames by Client::Fly, a flight for each client: frames_each of them, in a closed loop. A
  // frame's latency is the time since the one before it.
  bool stream = false;
  FrameFormat format{};  // how frames are sent
  // With `stream`: viewpoints a second of each client, of which the server keeps the newest; a
  // frame's latency counts from when its viewpoint was to be sent.
  std::optional<double> newest{};
};

// One client for each piece; they may be the same object. With `light`, which should be a client of
// its own, light calls are timed meanwhile. Phases "warm-up", if there is one, and "measured".
// Refusals for want of room are samples, and in a closed loop the client comes back when the server
// has said; all other errors end the test.
absl::StatusOr<std::vector<LoadPhase>> RunLoad(const LoadPlan& plan,
                                               const std::vector<Client*>& clients,
                                               const std::function<void(double)>& progress,
                                               Client* light = nullptr);

}  // namespace linetree
