#include "server/queued_call.h"

#include <utility>

#include "server/backend.h"
#include "server/messages.h"

namespace linetree {

grpc::ServerUnaryReactor* QueuedCall::Start(OpenCalls& calls, JobQueue& queue, const JobInfo& job,
                                            CallInfo info, grpc::CallbackServerContext* context,
                                            grpc::ByteBuffer* reply, Work work) {
  const std::shared_ptr<QueuedCall> call(
      new QueuedCall(calls, queue, std::move(info), context, reply, std::move(work)));
  call->self_ = call;
  absl::StatusOr<JobId> id = Backend::Stopping();
  if (call->open_) {
    id = queue.Submit(job, [call](const absl::Status& turn) { call->Run(turn); });
  }
  if (id.ok()) {
    call->job_ = *id;
  } else {
    call->Finish(Finished(id.status(), call->info_, context));
  }
  return call.get();
}

void QueuedCall::Run(const absl::Status& turn) {
  if (!turn.ok()) return Finish(Finished(turn, info_, context_));
  auto result = work_(cancel_);
  if (result.ok()) {
    *reply_ = *std::move(result);
    SendIdBack(info_, context_);
  }
  Finish(Finished(result.status(), info_, context_));
}

void QueuedCall::OnCancel() {
  cancel_.Cancel();
  queue_.Withdraw(job_);
}

void QueuedCall::OnDone() { const auto last = std::move(self_); }

}  // namespace linetree
