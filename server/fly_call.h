// Fly: viewpoints in, frames out, in order. One render and one write are under way at a time, so
// nothing is rendered ahead for a reader that is slow.
#pragma once

#include <grpcpp/alarm.h>
#include <grpcpp/support/server_callback.h>

#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/io/wire_frame.h"
#include "server/backend.h"
#include "server/call_info.h"
#include "server/flight_plan.h"
#include "server/frame_timer.h"
#include "server/resume_token.h"
#include "server/view_forecast.h"

namespace linetree {

class FlyCall final : public grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>,
                      public std::enable_shared_from_this<FlyCall> {
 public:
  // Starts the call; it owns itself until gRPC is done with it.
  static std::shared_ptr<FlyCall> Start(Backend& backend, grpc::CallbackServerContext* context);

  // Says farewell and ends with UNAVAILABLE, after the frame that is under way.
  void Drain();

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  FlyCall(Backend& backend, grpc::CallbackServerContext* context,
          std::optional<Budget::Share> place)
      : backend_(backend),
        context_(context),
        info_(ReadCallInfo(context)),
        token_{RandomId()},
        plan_(backend.limits().max_pending_viewpoints),
        place_(std::move(place)) {}

  // These need mutex_. gRPC never calls back from within a Start... or Finish.
  void Begin();
  void ReadMore();
  void Take(v1::FlyRequest request);
  void Advance();
  void SubmitNext();
  void SendNext();
  void SayFarewell();
  void Send(const v1::FlyReply& reply);
  void End(const absl::Status& status);
  // After the frame that is under way; only the first one counts.
  void EndSoon(const absl::Status& why);

  // On the render queue.
  void Run(const absl::Status& turn);
  absl::StatusOr<FrameChunks> Render();
  void LookAheadFrom(const Backend::PreparedFrame& frame);

  Backend& backend_;
  grpc::CallbackServerContext* const context_;
  const CallInfo info_;
  // Flights is what ends those that come late.
  const std::optional<OpenCalls::Share> open_ = backend_.open_calls().Enter();

  std::mutex mutex_;
  // Guarded by mutex_, but for what belongs to the frame that is being rendered.
  ResumeToken token_;
  bool has_begun_ = false;  // its first viewpoint has come
  FlightPlan plan_;
  std::optional<Budget::Share> place_;  // none: the call was refused, or has ended
  bool reading_ = false;
  bool read_all_ = false;
  bool working_ = false;  // a frame waits, or is being rendered or sent; or the farewell is sent
  bool has_sent_ = false;
  StallWatch::Id send_ = 0;               // that is under way
  bool gone_ = false;                     // the client
  std::optional<absl::Status> farewell_;  // why the server ends the flight
  bool ended_ = false;
  JobId job_ = 0;  // that waits
  grpc::ByteBuffer received_;
  grpc::ByteBuffer sending_;
  grpc::Alarm too_old_;
  std::shared_ptr<FlyCall> self_;  // until OnDone; the queue's job holds another

  // Of the frame that is being worked on.
  FlightPlan::Step step_;
  FrameTimer timer_;
  std::optional<CancelToken> cancel_;
  std::optional<Backend::PreparedFrame> frame_;
  std::optional<FrameChunks> chunks_;
  ViewForecast forecast_;
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
