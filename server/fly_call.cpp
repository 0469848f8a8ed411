#include "server/fly_call.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/messages.h"

namespace linetree {

std::shared_ptr<FlyCall> FlyCall::Start(Backend& backend, grpc::CallbackServerContext* context) {
  const std::shared_ptr<FlyCall> call(new FlyCall(backend, context, backend.flights().Take(1)));
  const std::lock_guard lock(call->mutex_);
  call->self_ = call;
  if (call->place_) {
    call->ReadMore();
  } else {
    call->End(backend.Busy("place for a flight"));
  }
  return call;
}

void FlyCall::ReadMore() {
  if (reading_ || read_all_ || ended_) return;
  if (pending_.size() >= backend_.limits().max_pending_viewpoints) return;
  reading_ = true;
  StartRead(&received_);
}

void FlyCall::OnReadDone(bool ok) {
  const std::lock_guard lock(mutex_);
  reading_ = false;
  if (ok) {
    v1::FlyRequest request;
    const auto status = Parse(received_, backend_.limits().max_request_bytes, &request);
    received_.Clear();
    if (status.ok()) {
      pending_.emplace_back(std::move(request));
    } else {
      pending_.emplace_back(status);
    }
    ReadMore();
  } else {
    read_all_ = true;
  }
  Advance();
}

void FlyCall::Advance() {
  if (working_ || ended_) return;
  if (cancel_.IsCancelled()) return End(absl::CancelledError("the client is gone"));
  if (draining_) return End(absl::UnavailableError("the server is stopping"));
  if (pending_.empty()) {
    if (read_all_) End(absl::OkStatus());
    return;
  }
  working_ = true;
  auto request = std::move(pending_.front());
  pending_.pop_front();
  ReadMore();
  // At most one job per flight, and flights are counted: this queue cannot grow without bound.
  backend_.renders().Submit(
      [call = self_, request = std::move(request)] { call->Render(request); });
}

void FlyCall::Render(const absl::StatusOr<v1::FlyRequest>& request) {
  auto frame = RenderFrame(request);
  const std::lock_guard lock(mutex_);
  if (!frame.ok()) return End(frame.status());
  chunks_.emplace(*std::move(frame), frame_->all_layers);
  SendNext();
}

absl::StatusOr<Frame> FlyCall::RenderFrame(const absl::StatusOr<v1::FlyRequest>& request) {
  if (!request.ok()) return request.status();
  sequence_ = request->sequence();
  auto prepared = backend_.PrepareFrame(request->frame(), "frame.");
  if (!prepared.ok()) return prepared.status();
  frame_.emplace(*std::move(prepared));
  return backend_.Render(*frame_, cancel_);
}

void FlyCall::SendNext() {
  v1::FlyReply reply;
  if (!chunks_->Next(reply.mutable_chunk())) {
    chunks_.reset();
    frame_.reset();
    working_ = false;
    return Advance();
  }
  reply.set_sequence(sequence_);
  sending_ = Serialize(reply);
  StartWrite(&sending_);
}

void FlyCall::OnWriteDone(bool ok) {
  const std::lock_guard lock(mutex_);
  if (ok) return SendNext();
  End(absl::CancelledError("the client is gone"));
}

void FlyCall::OnCancel() {
  cancel_.Cancel();
  const std::lock_guard lock(mutex_);
  Advance();
}

void FlyCall::Drain() {
  const std::lock_guard lock(mutex_);
  draining_ = true;
  Advance();
}

void FlyCall::End(const absl::Status& status) {
  ended_ = true;
  // Before the client hears of the end and asks for them again.
  chunks_.reset();
  frame_.reset();
  place_.reset();
  Finish(Finished(status, context_));
}

void FlyCall::OnDone() { const auto last = std::move(self_); }

void Flights::Add(const std::shared_ptr<FlyCall>& flight) {
  const std::lock_guard lock(mutex_);
  std::erase_if(open_, [](const auto& open) { return open.expired(); });
  open_.push_back(flight);
  if (draining_) flight->Drain();
}

void Flights::Drain() {
  const std::lock_guard lock(mutex_);
  draining_ = true;
  for (const auto& open : open_) {
    if (const auto flight = open.lock()) flight->Drain();
  }
}

}  // namespace linetree
