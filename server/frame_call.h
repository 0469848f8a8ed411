// RenderFrame: one frame, rendered on the render queue and sent chunk by chunk, one write at a
// time.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <memory>
#include <optional>

#include "core/io/wire_frame.h"
#include "server/backend.h"
#include "server/call_info.h"
#include "server/frame_timer.h"

namespace linetree {

class FrameCall final : public grpc::ServerWriteReactor<grpc::ByteBuffer> {
 public:
  // Starts the call; it owns itself until gRPC is done with it.
  static grpc::ServerWriteReactor<grpc::ByteBuffer>* Start(Backend& backend,
                                                           grpc::CallbackServerContext* context,
                                                           const grpc::ByteBuffer& request);

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  // What happens to a call happens one after the other, so nothing but the token needs a lock: the
  // request is checked, then the job renders, then each write is started by the end of the one
  // before, and whoever finds an end calls Finish. gRPC cancels no call before Start has returned.
  FrameCall(Backend& backend, grpc::CallbackServerContext* context)
      : backend_(backend), context_(context), info_(ReadCallInfo(context)) {}
  absl::Status Submit(const grpc::ByteBuffer& request);
  void Run(const absl::Status& turn);
  absl::Status Render();
  void SendNext();
  void End(const absl::Status& status);

  Backend& backend_;
  grpc::CallbackServerContext* const context_;
  const CallInfo info_;
  const std::optional<OpenCalls::Share> open_ = backend_.open_calls().Enter();
  JobId job_ = 0;
  StallWatch::Id send_ = 0;
  FrameTimer timer_;
  std::optional<Backend::PreparedFrame> frame_;
  std::optional<FrameChunks> chunks_;
  grpc::ByteBuffer sending_;
  CancelToken cancel_;
  std::shared_ptr<FrameCall> self_;  // until OnDone; the queue's job holds another
};

}  // namespace linetree
