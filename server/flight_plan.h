// What a flight renders next: which of the viewpoints that have come, and whether at full quality.
//
// Thread safety: none.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>

#include "absl/status/statusor.h"
#include "linetree/v1/service.pb.h"
#include "server/schedule.h"

namespace linetree {

class FlightPlan {
 public:
  // At most so many viewpoints wait, where every one of them gets a frame.
  explicit FlightPlan(size_t max_waiting) : max_waiting_(max_waiting) {}

  // What came: a viewpoint, or why it cannot be understood. What is wrong waits for its turn like
  // the rest, and nothing is taken after it. Requests are checked for what concerns the flight, not
  // their frames.
  void Add(absl::StatusOr<v1::FlyRequest> request);
  // Whether there is room for another.
  bool WantsMore() const;

  // What is rendered for one reply.
  struct Step {
    v1::FlyRequest viewpoint;  // with the frame to be rendered
    bool reduced = false;      // as while_moving says; the full frame may follow
    bool refines = false;      // is the full one after a reduced one
    uint64_t skipped = 0;      // viewpoints overtaken since the step before
  };
  bool HasNext() const { return !waiting_.empty() || refinement_; }
  // Rays of the next step, estimated; at least 1.
  uint64_t WorkOfNext() const;
  // The class of the next step; interactive for what is wrong.
  Priority PriorityOfNext() const;
  // Requires HasNext().
  absl::StatusOr<Step> Next();

  // Whether a refinement that is being rendered should make room.
  bool HasNewer() const { return !waiting_.empty(); }

 private:
  absl::Status Check(const v1::FlyRequest& request);
  // Null when what is wrong is next.
  const v1::FlyRequest* NextRequest() const;

  const size_t max_waiting_;
  bool is_first_ = true;
  bool failed_ = false;  // what is wrong waits, or has been handed out
  bool newest_only_ = false;
  std::deque<absl::StatusOr<v1::FlyRequest>> waiting_;
  std::optional<v1::FlyRequest> refinement_;  // the full frame of the last step
  uint64_t skipped_ = 0;
};

// Rays through the pixels of the frame that is asked for, whatever it says; at least 1.
uint64_t EstimatedRays(const v1::RenderFrameRequest& request);

}  // namespace linetree
