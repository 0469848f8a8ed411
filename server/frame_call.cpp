#include "server/frame_call.h"

#include <utility>

#include "server/flight_plan.h"
#include "server/messages.h"

namespace linetree {

grpc::ServerWriteReactor<grpc::ByteBuffer>* FrameCall::Start(Backend& backend,
                                                             grpc::CallbackServerContext* context,
                                                             const grpc::ByteBuffer& request) {
  const std::shared_ptr<FrameCall> call(new FrameCall(backend, context));
  call->self_ = call;
  const absl::Status status = call->Submit(request);
  if (!status.ok()) call->Finish(Finished(status, call->info_, context));
  return call.get();
}

absl::Status FrameCall::Submit(const grpc::ByteBuffer& request) {
  if (!open_) return Backend::Stopping();
  v1::RenderFrameRequest message;
  auto status = Parse(request, backend_.limits().max_request_bytes, &message);
  if (!status.ok()) return status;
  auto frame = backend_.PrepareFrame(message, "");
  if (!frame.ok()) return frame.status();
  frame_ = *std::move(frame);
  timer_.Enter(FrameTimer::Stage::kQueue);
  backend_.look_ahead().Yield();
  const auto job =
      backend_.renders().Submit({.priority = frame_->priority,
                                 .session = info_.session,
                                 .work_rays = EstimatedRays(message),
                                 .deadline = info_.deadline},
                                [call = self_](const absl::Status& turn) { call->Run(turn); });
  if (job.ok()) job_ = *job;
  return job.status();
}

void FrameCall::Run(const absl::Status& turn) {
  timer_.Enter(FrameTimer::Stage::kRender);
  const absl::Status status = turn.ok() ? Render() : turn;
  if (!status.ok()) return End(status);
  SendIdBack(info_, context_);
  SendNext();
}

absl::Status FrameCall::Render() {
  auto frame = backend_.Render(*frame_, cancel_);
  if (!frame.ok()) return frame.status();
  timer_.Enter(FrameTimer::Stage::kEncode);
  auto chunks = FrameChunks::Make(*std::move(frame), frame_->format);
  if (chunks.ok()) chunks_ = *std::move(chunks);
  return chunks.status();
}

void FrameCall::OnCancel() {
  cancel_.Cancel();
  backend_.renders().Withdraw(job_);
}

void FrameCall::SendNext() {
  timer_.Enter(FrameTimer::Stage::kEncode);
  v1::FrameChunk chunk;
  if (!chunks_->Next(&chunk)) {
    return End(absl::OkStatus());
  }
  if (chunk.has_end()) {
    timer_.Enter(FrameTimer::Stage::kElsewhere);
    chunk.mutable_end()->set_request_id(info_.request_id);
    *chunk.mutable_end()->mutable_timing() = timer_.ToWire();
  }
  sending_ = Serialize(chunk);
  timer_.Enter(FrameTimer::Stage::kElsewhere);
  send_ = backend_.sends().Begin([this] { context_->TryCancel(); });
  StartWrite(&sending_);
}

void FrameCall::OnWriteDone(bool ok) {
  backend_.sends().End(send_);
  if (ok) return SendNext();
  End(absl::CancelledError("the client is gone"));
}

void FrameCall::End(const absl::Status& status) {
  // First, so that a client that has seen the end finds the memory free.
  chunks_.reset();
  frame_.reset();
  Finish(Finished(status, info_, context_));
}

void FrameCall::OnDone() { const auto last = std::move(self_); }

}  // namespace linetree
