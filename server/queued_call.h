// A unary call whose work is done on a queue, never in gRPC's callback threads.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <functional>
#include <memory>

#include "absl/status/statusor.h"
#include "core/render/scene_host.h"
#include "server/work_queue.h"

namespace linetree {

class QueuedCall final : public grpc::ServerUnaryReactor {
 public:
  using Work = std::function<absl::StatusOr<grpc::ByteBuffer>(const CancelToken& cancel)>;

  // Starts the call; it owns itself until gRPC is done with it. `busy` is its answer when the queue
  // is full. `reply` belongs to gRPC and lives as long as the call.
  static grpc::ServerUnaryReactor* Start(WorkQueue& queue, grpc::CallbackServerContext* context,
                                         grpc::ByteBuffer* reply, Work work,
                                         const absl::Status& busy);

  void OnCancel() override { cancel_.Cancel(); }
  void OnDone() override;

 private:
  QueuedCall(grpc::CallbackServerContext* context, grpc::ByteBuffer* reply, Work work)
      : context_(context), reply_(reply), work_(std::move(work)) {}
  void Run();

  grpc::CallbackServerContext* const context_;
  grpc::ByteBuffer* const reply_;
  const Work work_;
  CancelToken cancel_;
  std::shared_ptr<QueuedCall> self_;  // until OnDone; the queue's job holds another
};

}  // namespace linetree
