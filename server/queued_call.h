// A unary call whose work is done on a queue, never in gRPC's callback threads.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "absl/status/statusor.h"
#include "core/render/scene_host.h"
#include "server/call_info.h"
#include "server/job_queue.h"
#include "server/open_calls.h"

namespace linetree {

class QueuedCall final : public grpc::ServerUnaryReactor {
 public:
  using Work = std::function<absl::StatusOr<grpc::ByteBuffer>(const CancelToken& cancel)>;

  // Starts the call; it owns itself until gRPC is done with it. `job` says how the work is queued.
  // `reply` belongs to gRPC and lives as long as the call.
  static grpc::ServerUnaryReactor* Start(OpenCalls& calls, JobQueue& queue, const JobInfo& job,
                                         CallInfo info, grpc::CallbackServerContext* context,
                                         grpc::ByteBuffer* reply, Work work);

  void OnCancel() override;
  void OnDone() override;

 private:
  QueuedCall(OpenCalls& calls, JobQueue& queue, CallInfo info, grpc::CallbackServerContext* context,
             grpc::ByteBuffer* reply, Work work)
      : open_(calls.Enter()),
        queue_(queue),
        info_(std::move(info)),
        context_(context),
        reply_(reply),
        work_(std::move(work)) {}
  void Run(const absl::Status& turn);

  const std::optional<OpenCalls::Share> open_;
  JobQueue& queue_;
  const CallInfo info_;
  grpc::CallbackServerContext* const context_;
  grpc::ByteBuffer* const reply_;
  const Work work_;
  JobId job_ = 0;
  CancelToken cancel_;
  std::shared_ptr<QueuedCall> self_;  // until OnDone; the queue's job holds another
};

}  // namespace linetree
