#include "server/flight_plan.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/math/check.h"
#include "server/wire_priority.h"

namespace linetree {
namespace {

constexpr uint32_t kMaxDivisor = 64;

uint32_t DividedUp(uint32_t side, uint32_t divisor) {
  return side / divisor + (side % divisor != 0 ? 1 : 0);
}

void Reduce(const v1::WhileMoving& while_moving, v1::RenderFrameRequest& frame) {
  const uint32_t divisor = std::max(while_moving.divisor(), 1u);
  frame.set_width(DividedUp(frame.width(), divisor));
  frame.set_height(DividedUp(frame.height(), divisor));
  if (while_moving.has_max_relative_error()) {
    frame.mutable_options()->set_max_relative_error(while_moving.max_relative_error());
  }
}

uint64_t SaturatedProduct(uint64_t a, uint64_t b) {
  uint64_t product = 0;
  if (__builtin_mul_overflow(a, b, &product)) return std::numeric_limits<uint64_t>::max();
  return product;
}

}  // namespace

uint64_t EstimatedRays(const v1::RenderFrameRequest& request) {
  const uint64_t pixels = uint64_t{request.width()} * request.height();
  const uint64_t samples = std::max<uint64_t>(request.sampling().samples(), 1);
  return std::max<uint64_t>(SaturatedProduct(pixels, samples), 1);
}

absl::Status FlightPlan::Check(const v1::FlyRequest& request) {
  if (std::exchange(is_first_, false)) {
    if (!v1::Pacing_IsValid(request.pacing())) {
      return absl::InvalidArgumentError(
          absl::StrCat("pacing: expected one of the values in service.proto, got ",
                       static_cast<int>(request.pacing())));
    }
    newest_only_ = request.pacing() == v1::PACING_NEWEST;
  }
  const v1::WhileMoving& while_moving = request.while_moving();
  if (while_moving.divisor() > kMaxDivisor) {
    return absl::InvalidArgumentError(absl::StrCat("while_moving.divisor: expected at most ",
                                                   kMaxDivisor, ", got ", while_moving.divisor()));
  }
  const double error = while_moving.max_relative_error();
  if (!(error >= 0 && error <= 1)) {
    return absl::InvalidArgumentError(
        absl::StrCat("while_moving.max_relative_error: expected a number in [0, 1], got ", error));
  }
  return absl::OkStatus();
}

void FlightPlan::Add(absl::StatusOr<v1::FlyRequest> request) {
  if (failed_) return;
  if (request.ok()) {
    if (const auto status = Check(*request); !status.ok()) request = status;
  }
  failed_ = !request.ok();
  if (newest_only_ && !failed_ && !waiting_.empty()) {
    waiting_.pop_back();
    ++skipped_;
  }
  waiting_.push_back(std::move(request));
}

bool FlightPlan::WantsMore() const {
  return !failed_ && (newest_only_ || waiting_.size() < max_waiting_);
}

const v1::FlyRequest* FlightPlan::NextRequest() const {
  if (waiting_.empty()) return &*refinement_;
  return waiting_.front().ok() ? &*waiting_.front() : nullptr;
}

Priority FlightPlan::PriorityOfNext() const {
  const v1::FlyRequest* next = NextRequest();
  if (next == nullptr) return Priority::kInteractive;
  return PriorityFromWire(next->frame().priority(), Priority::kInteractive, "frame.priority")
      .value_or(Priority::kInteractive);
}

uint64_t FlightPlan::WorkOfNext() const {
  if (waiting_.empty()) return EstimatedRays(refinement_->frame());
  const auto& next = waiting_.front();
  if (!next.ok()) return 1;
  v1::RenderFrameRequest frame = next->frame();
  if (next->has_while_moving()) Reduce(next->while_moving(), frame);
  return EstimatedRays(frame);
}

absl::StatusOr<FlightPlan::Step> FlightPlan::Next() {
  LT_CHECK(HasNext());
  Step step;
  if (waiting_.empty()) {
    step.viewpoint = *std::exchange(refinement_, std::nullopt);
    step.refines = true;
    return step;
  }
  refinement_.reset();
  auto request = std::move(waiting_.front());
  waiting_.pop_front();
  if (!request.ok()) return request.status();
  step.skipped = std::exchange(skipped_, 0);
  step.viewpoint = *std::move(request);
  if (step.viewpoint.has_while_moving()) {
    refinement_ = step.viewpoint;
    Reduce(step.viewpoint.while_moving(), *step.viewpoint.mutable_frame());
    step.reduced = true;
  }
  return step;
}

}  // namespace linetree
