#include "server/frame_call.h"

#include <utility>

#include "server/messages.h"

namespace linetree {

grpc::ServerWriteReactor<grpc::ByteBuffer>* FrameCall::Start(Backend& backend,
                                                             grpc::CallbackServerContext* context,
                                                             const grpc::ByteBuffer& request) {
  const std::shared_ptr<FrameCall> call(new FrameCall(backend, context));
  call->self_ = call;
  absl::Status status = call->Prepare(request);
  if (status.ok() && !backend.renders().TrySubmit([call] { call->Render(); })) {
    status = backend.Busy("render slot");
  }
  if (!status.ok()) call->Finish(Finished(status, context));
  return call.get();
}

absl::Status FrameCall::Prepare(const grpc::ByteBuffer& request) {
  v1::RenderFrameRequest message;
  auto status = Parse(request, backend_.limits().max_request_bytes, &message);
  if (!status.ok()) return status;
  auto frame = backend_.PrepareFrame(message, "");
  if (!frame.ok()) return frame.status();
  frame_ = *std::move(frame);
  return absl::OkStatus();
}

void FrameCall::Render() {
  auto frame = backend_.Render(*frame_, cancel_);
  if (!frame.ok()) {
    End(Finished(frame.status(), context_));
    return;
  }
  chunks_.emplace(*std::move(frame), frame_->all_layers);
  SendNext();
}

void FrameCall::SendNext() {
  v1::FrameChunk chunk;
  if (!chunks_->Next(&chunk)) {
    End(grpc::Status::OK);
    return;
  }
  sending_ = Serialize(chunk);
  StartWrite(&sending_);
}

void FrameCall::OnWriteDone(bool ok) {
  if (ok) {
    SendNext();
  } else {
    End(grpc::Status::CANCELLED);
  }
}

void FrameCall::End(const grpc::Status& status) {
  // First, so that a client that has seen the end finds the memory free.
  chunks_.reset();
  frame_.reset();
  Finish(status);
}

void FrameCall::OnDone() { const auto last = std::move(self_); }

}  // namespace linetree
