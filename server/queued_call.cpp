#include "server/queued_call.h"

#include <utility>

#include "server/messages.h"

namespace linetree {

grpc::ServerUnaryReactor* QueuedCall::Start(WorkQueue& queue, grpc::CallbackServerContext* context,
                                            grpc::ByteBuffer* reply, Work work,
                                            const absl::Status& busy) {
  const std::shared_ptr<QueuedCall> call(new QueuedCall(context, reply, std::move(work)));
  call->self_ = call;
  if (!queue.TrySubmit([call] { call->Run(); })) call->Finish(Finished(busy, context));
  return call.get();
}

void QueuedCall::Run() {
  if (cancel_.IsCancelled()) {
    Finish(grpc::Status::CANCELLED);
    return;
  }
  auto result = work_(cancel_);
  if (result.ok()) *reply_ = *std::move(result);
  Finish(Finished(result.status(), context_));
}

void QueuedCall::OnDone() { const auto last = std::move(self_); }

}  // namespace linetree
