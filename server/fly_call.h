// Fly: viewpoints in, frames out, in order. One render and one write are under way at a time; a
// client that sends far ahead is no longer read, which gRPC's flow control tells it.
#pragma once

#include <grpcpp/support/server_callback.h>

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/io/wire_frame.h"
#include "server/backend.h"

namespace linetree {

class FlyCall final : public grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer> {
 public:
  // Starts the call; it owns itself until gRPC is done with it.
  static std::shared_ptr<FlyCall> Start(Backend& backend, grpc::CallbackServerContext* context);

  // Ends with UNAVAILABLE after the frame that is under way.
  void Drain();

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  FlyCall(Backend& backend, grpc::CallbackServerContext* context,
          std::optional<Budget::Share> place)
      : backend_(backend), context_(context), place_(std::move(place)) {}

  // These need mutex_. gRPC never calls back from within a Start... or Finish.
  void ReadMore();
  void Advance();
  void SendNext();
  void End(const absl::Status& status);

  // On the render queue.
  void Render(const absl::StatusOr<v1::FlyRequest>& request);
  absl::StatusOr<Frame> RenderFrame(const absl::StatusOr<v1::FlyRequest>& request);

  Backend& backend_;
  grpc::CallbackServerContext* const context_;
  CancelToken cancel_;

  std::mutex mutex_;
  // Guarded by mutex_. What cannot be understood waits for its turn to be refused like the rest.
  std::deque<absl::StatusOr<v1::FlyRequest>> pending_;
  std::optional<Budget::Share> place_;  // none: the call was refused, or has ended
  bool reading_ = false;
  bool read_all_ = false;
  bool working_ = false;  // a frame is being rendered or sent
  bool draining_ = false;
  bool ended_ = false;
  grpc::ByteBuffer received_;
  grpc::ByteBuffer sending_;
  std::shared_ptr<FlyCall> self_;  // until OnDone; the queue's job holds another

  // Of the frame that is being worked on.
  uint64_t sequence_ = 0;
  std::optional<Backend::PreparedFrame> frame_;
  std::optional<FrameChunks> chunks_;
};

// The flights that are open, so that a server that stops can end them.
//
// Thread safety: all methods may be called from any thread.
class Flights {
 public:
  // Ends at once when Drain has been called.
  void Add(const std::shared_ptr<FlyCall>& flight);
  void Drain();

 private:
  std::mutex mutex_;
  std::vector<std::weak_ptr<FlyCall>> open_;  // guarded by mutex_, as is draining_
  bool draining_ = false;
};

}  // namespace linetree
