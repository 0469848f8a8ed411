#include "client/library/flight.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/io/wire.h"
#include "core/io/wire_frame.h"

namespace linetree {
namespace {

// Viewpoints that are sent ahead of the frames: enough to keep the server busy, far less than it
// holds.
constexpr size_t kViewpointsAhead = 8;

}  // namespace

absl::Status Flight::Run() {
  const Caller::Deadline deadline = caller_.DeadlineOf(plan_.requests.size());
  Retries retries(caller_.options().retry);
  for (;;) {
    const size_t before = next_;
    const absl::Status status = RunOneStream(deadline);
    if (next_ > before) retries.Progress();
    if (status.ok() || !caller_.WaitToRetry(retries, status, deadline)) return status;
  }
}

absl::Status Flight::RunOneStream(Caller::Deadline deadline) {
  grpc::ClientContext context;
  caller_.Prepare(context, deadline);
  const auto stream = stub_.Fly(&context);
  sent_ = next_;
  for (bool writable = true; next_ < plan_.requests.size(); ++next_) {
    writable = writable && SendAhead(*stream);
    auto frame = ReadFrame(*stream);
    if (absl::IsOutOfRange(frame.status())) {
      auto status = Caller::StatusOf(stream->Finish(), context);
      return status.ok() ? frame.status() : status;
    }
    if (!frame.ok()) {
      context.TryCancel();
      stream->Finish();
      return frame.status();
    }
    plan_.on_frame(next_, *std::move(frame));
  }
  stream->WritesDone();
  // All frames are here: how the stream ends no longer matters.
  stream->Finish();
  return absl::OkStatus();
}

bool Flight::SendAhead(Stream& stream) {
  for (; sent_ < std::min(plan_.requests.size(), next_ + kViewpointsAhead); ++sent_) {
    if (!stream.Write(RequestFor(sent_))) return false;
  }
  return true;
}

v1::FlyRequest Flight::RequestFor(size_t index) const {
  v1::FlyRequest message;
  message.set_sequence(index);
  message.set_pacing(v1::PACING_EVERY);
  if (index == next_) message.set_resume_token(resume_token_);
  *message.mutable_frame() =
      FrameRequestToWire(plan_.scene, plan_.requests[index], "", plan_.format);
  message.mutable_frame()->set_priority(caller_.options().priority);
  return message;
}

absl::StatusOr<Frame> Flight::ReadFrame(Stream& stream) {
  const FrameRequest& request = plan_.requests[next_];
  FrameAssembler assembler(request.width, request.height, plan_.format);
  v1::FlyReply reply;
  while (!assembler.complete()) {
    if (!stream.Read(&reply)) return absl::OutOfRangeError("the server ended the flight early");
    if (reply.has_farewell()) {
      resume_token_ = reply.farewell().resume_token();
      continue;
    }
    if (reply.sequence() != next_) {
      return absl::DataLossError(absl::StrCat("expected a chunk of frame ", next_,
                                              ", got one of frame ", reply.sequence()));
    }
    if (auto status = assembler.Add(reply.chunk()); !status.ok()) return status;
  }
  return assembler.Take();
}

}  // namespace linetree
