// RenderFrame: one frame, rendered on the render queue and sent chunk by chunk, one write at a
// time.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <memory>
#include <optional>

#include "core/io/wire_frame.h"
#include "server/backend.h"

namespace linetree {

class FrameCall final : public grpc::ServerWriteReactor<grpc::ByteBuffer> {
 public:
  // Starts the call; it owns itself until gRPC is done with it.
  static grpc::ServerWriteReactor<grpc::ByteBuffer>* Start(Backend& backend,
                                                           grpc::CallbackServerContext* context,
                                                           const grpc::ByteBuffer& request);

  void OnWriteDone(bool ok) override;
  void OnCancel() override { cancel_.Cancel(); }
  void OnDone() override;

 private:
  // What happens to a call happens one after the other, so nothing but the token needs a lock: the
  // request is checked, then the job renders, then each write is started by the end of the one
  // before, and whoever finds an end calls Finish.
  FrameCall(Backend& backend, grpc::CallbackServerContext* context)
      : backend_(backend), context_(context) {}
  absl::Status Prepare(const grpc::ByteBuffer& request);
  void Render();
  void SendNext();
  void End(const grpc::Status& status);

  Backend& backend_;
  grpc::CallbackServerContext* const context_;
  std::optional<Backend::PreparedFrame> frame_;
  std::optional<FrameChunks> chunks_;
  grpc::ByteBuffer sending_;
  CancelToken cancel_;
  std::shared_ptr<FrameCall> self_;  // until OnDone; the queue's job holds another
};

}  // namespace linetree
