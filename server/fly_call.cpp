#include "server/fly_call.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/messages.h"

namespace linetree {

std::shared_ptr<FlyCall> FlyCall::Start(Backend& backend, grpc::CallbackServerContext* context) {
  const std::shared_ptr<FlyCall> call(new FlyCall(backend, context, backend.flights().Take(1)));
  const std::lock_guard lock(call->mutex_);
  call->self_ = call;
  if (call->place_) {
    call->Begin();
  } else {
    call->End(backend.Busy("place for a flight"));
  }
  return call;
}

void FlyCall::Begin() {
  ReadMore();
  const std::chrono::seconds most = backend_.options().max_flight_s;
  if (most.count() == 0) return;
  too_old_.Set(std::chrono::system_clock::now() + most,
               [most, flight = weak_from_this()](bool is_time) {
                 // What is called off may come late, when nobody waits for the call any more.
                 if (!is_time) return;
                 const auto call = flight.lock();
                 if (!call) return;
                 const std::lock_guard lock(call->mutex_);
                 call->EndSoon(absl::UnavailableError(absl::StrCat(
                     "the flight has lasted for ", most.count(),
                     " s, which is the most; the last reply's token lets another go on with it")));
               });
}

void FlyCall::ReadMore() {
  if (reading_ || read_all_ || ended_ || !plan_.WantsMore()) return;
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
      Take(std::move(request));
    } else {
      plan_.Add(status);
    }
    // Who has moved on does not wait for the last view's finer picture.
    if (step_.refines && cancel_ && plan_.HasNewer()) cancel_->Cancel();
    ReadMore();
  } else {
    read_all_ = true;
  }
  Advance();
}

void FlyCall::Take(v1::FlyRequest request) {
  if (!std::exchange(has_begun_, true) && !request.resume_token().empty()) {
    auto token = ParseResumeToken(request.resume_token(), "resume_token");
    if (!token.ok()) return plan_.Add(token.status());
    token_ = *std::move(token);
  }
  plan_.Add(std::move(request));
}

void FlyCall::Advance() {
  if (working_ || ended_) return;
  if (gone_) return End(absl::CancelledError("the client is gone"));
  if (farewell_) return SayFarewell();
  if (plan_.HasNext()) return SubmitNext();
  if (read_all_) End(absl::OkStatus());
}

void FlyCall::SubmitNext() {
  working_ = true;
  timer_ = {};
  timer_.Enter(FrameTimer::Stage::kQueue);
  // At most one job per flight, and flights are counted: these jobs need no bound of their own.
  backend_.look_ahead().Yield();
  const auto job = backend_.renders().Submit(
      {.priority = plan_.PriorityOfNext(),
       .session = info_.session,
       // What is more than may be asked for is refused in its turn.
       .work_rays = std::min(plan_.WorkOfNext(), backend_.limits().render.max_samples),
       .deadline = info_.deadline,
       .has_place = true},
      [call = self_](const absl::Status& turn) { call->Run(turn); });
  job_ = *job;
}

void FlyCall::Run(const absl::Status& turn) {
  {
    const std::lock_guard lock(mutex_);
    if (!turn.ok()) return End(turn);
    auto step = plan_.Next();
    if (!step.ok()) return End(step.status());
    step_ = *std::move(step);
    timer_.Enter(FrameTimer::Stage::kRender);
    cancel_.emplace();
    if (gone_) cancel_->Cancel();
    ReadMore();
  }
  auto chunks = Render();
  const std::lock_guard lock(mutex_);
  cancel_.reset();
  if (chunks.ok()) {
    ++token_.frames;
    chunks_ = *std::move(chunks);
    return SendNext();
  }
  frame_.reset();
  if (!step_.refines || gone_ || !absl::IsCancelled(chunks.status())) return End(chunks.status());
  working_ = false;
  Advance();
}

absl::StatusOr<FrameChunks> FlyCall::Render() {
  auto prepared = backend_.PrepareFrame(step_.viewpoint.frame(), "frame.");
  if (!prepared.ok()) return prepared.status();
  frame_.emplace(*std::move(prepared));
  auto frame = backend_.Render(*frame_, *cancel_);
  if (!frame.ok()) return frame.status();
  timer_.Enter(FrameTimer::Stage::kEncode);
  auto chunks = FrameChunks::Make(*std::move(frame), frame_->format);
  if (!step_.refines) LookAheadFrom(*frame_);
  return chunks;
}

void FlyCall::LookAheadFrom(const Backend::PreparedFrame& frame) {
  const auto next = forecast_.After(frame.request.camera);
  if (!next) return;
  FrameRequest request = frame.request;
  request.camera = *next;
  backend_.look_ahead().Offer(frame.scene, request);
}

void FlyCall::SendNext() {
  timer_.Enter(FrameTimer::Stage::kEncode);
  v1::FlyReply reply;
  if (!chunks_->Next(reply.mutable_chunk())) {
    chunks_.reset();
    frame_.reset();
    working_ = false;
    return Advance();
  }
  reply.set_sequence(step_.viewpoint.sequence());
  reply.set_reduced(step_.reduced);
  reply.set_frame_number(token_.frames);
  if (reply.chunk().has_end()) {
    reply.set_skipped(step_.skipped);
    v1::FrameEnd& end = *reply.mutable_chunk()->mutable_end();
    end.set_request_id(info_.request_id);
    timer_.Enter(FrameTimer::Stage::kElsewhere);
    *end.mutable_timing() = timer_.ToWire();
  }
  Send(reply);
}

void FlyCall::Send(const v1::FlyReply& reply) {
  if (!std::exchange(has_sent_, true)) SendIdBack(info_, context_);
  sending_ = Serialize(reply);
  timer_.Enter(FrameTimer::Stage::kElsewhere);
  send_ = backend_.sends().Begin([this] { context_->TryCancel(); });
  StartWrite(&sending_);
}

void FlyCall::SayFarewell() {
  working_ = true;
  v1::FlyReply reply;
  reply.set_sequence(step_.viewpoint.sequence());
  reply.set_frame_number(token_.frames);
  reply.mutable_farewell()->set_resume_token(ToText(token_));
  Send(reply);
}

void FlyCall::OnWriteDone(bool ok) {
  backend_.sends().End(send_);
  const std::lock_guard lock(mutex_);
  if (!ok) return End(absl::CancelledError("the client is gone"));
  if (chunks_) return SendNext();
  End(*farewell_);
}

void FlyCall::OnCancel() {
  const std::lock_guard lock(mutex_);
  gone_ = true;
  if (cancel_) cancel_->Cancel();
  backend_.renders().Withdraw(job_);
  Advance();
}

void FlyCall::EndSoon(const absl::Status& why) {
  if (!farewell_) farewell_ = why;
  Advance();
}

void FlyCall::Drain() {
  const std::lock_guard lock(mutex_);
  EndSoon(Backend::Stopping());
}

void FlyCall::End(const absl::Status& status) {
  ended_ = true;
  too_old_.Cancel();
  // Before the client hears of the end and asks for them again.
  chunks_.reset();
  frame_.reset();
  place_.reset();
  Finish(Finished(status, info_, context_));
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
