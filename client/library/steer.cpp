#include "client/library/steer.h"

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "absl/strings/str_cat.h"
#include "core/io/wire.h"
#include "core/io/wire_frame.h"

namespace linetree {
namespace {

using Clock = std::chrono::system_clock;
using Stream = grpc::ClientReaderWriter<v1::FlyRequest, v1::FlyReply>;

// The side of a frame that WhileMoving asks for.
int Reduced(int side, int divisor) { return (side + divisor - 1) / divisor; }

// One thread reads frames, stream after stream; a second one, which each stream has for itself,
// sends what Look leaves in the mailbox.
class GrpcLiveFlight final : public LiveFlight {
 public:
  GrpcLiveFlight(const Caller& caller, v1::RadianceCache::Stub& stub, const std::string& scene,
                 const LiveOptions& options, OnFrame on_frame)
      : caller_(caller),
        stub_(stub),
        scene_(scene),
        options_(options),
        on_frame_(std::move(on_frame)),
        reader_([this] { Run(); }) {}

  ~GrpcLiveFlight() override {
    {
      const std::lock_guard lock(mutex_);
      given_up_ = true;
      if (context_ != nullptr) context_->TryCancel();
    }
    changed_.notify_all();
    reader_.join();
  }

  absl::StatusOr<uint64_t> Look(const FrameRequest& view) override {
    if (auto status = ValidateSize(view.width, view.height, RenderLimits()); !status.ok()) {
      return status;
    }
    const std::lock_guard lock(mutex_);
    if (ended_) return status_.ok() ? absl::FailedPreconditionError("it has landed") : status_;
    if (!Waiting()) waiting_since_ = Clock::now();
    newest_ = view;
    ++looked_;
    changed_.notify_all();
    return looked_ - 1;
  }

  bool HasEndedBy(Clock::time_point time) override {
    std::unique_lock lock(mutex_);
    return changed_.wait_until(lock, time, [this] { return ended_; });
  }

  absl::Status Land() override {
    std::unique_lock lock(mutex_);
    landing_ = true;
    changed_.notify_all();
    changed_.wait(lock, [this] { return ended_; });
    return status_;
  }

 private:
  // These need mutex_.
  // Whether the newest viewpoint has had no full frame yet.
  bool Waiting() const { return answered_ < looked_; }
  bool MaySend() const { return sent_ < looked_; }
  // When the flight has waited for too long.
  Clock::time_point Due() const { return waiting_since_ + caller_.options().call_timeout_ms; }

  void Run() {
    Retries retries(caller_.options().retry);
    absl::Status status;
    for (;;) {
      const uint64_t before = frames_;
      status = RunOneStream();
      if (frames_ > before) retries.Progress();
      if (status.ok()) break;
      Clock::time_point due;
      {
        const std::lock_guard lock(mutex_);
        if (given_up_) break;
        due = Waiting() ? Due() : Clock::now() + caller_.options().call_timeout_ms;
      }
      if (!caller_.WaitToRetry(retries, status, due)) break;
    }
    const std::lock_guard lock(mutex_);
    status_ = status;
    ended_ = true;
    changed_.notify_all();
  }

  absl::Status RunOneStream() {
    grpc::ClientContext context;
    caller_.Prepare(context, Caller::Deadline::max());  // the sender looks after time
    {
      const std::lock_guard lock(mutex_);
      if (given_up_) return absl::CancelledError("the flight was given up");
      context_ = &context;
      stream_over_ = false;
      // The newest one again, if it has had no frame: who reads this one knows nothing of it.
      sent_ = std::min(sent_, answered_);
    }
    const auto stream = stub_.Fly(&context);
    std::thread sender([&] { SendAll(*stream, context); });
    const absl::Status received = ReceiveAll(*stream);
    {
      const std::lock_guard lock(mutex_);
      stream_over_ = true;
      changed_.notify_all();
    }
    if (!received.ok()) context.TryCancel();
    sender.join();
    const absl::Status ended = Caller::StatusOf(stream->Finish(), context);
    const std::lock_guard lock(mutex_);
    context_ = nullptr;
    if (timed_out_) return absl::DeadlineExceededError("no frame came in time");
    if (!received.ok()) return received;
    if (!ended.ok() || (landing_ && !Waiting())) return ended;
    return absl::DataLossError("the server ended the flight early");
  }

  // Until the stream is over. Ends the call when the flight has waited for too long.
  void SendAll(Stream& stream, grpc::ClientContext& context) {
    bool is_first = true;
    bool done = false;  // with writing
    std::unique_lock lock(mutex_);
    for (;;) {
      const auto has_news = [&] { return stream_over_ || (!done && (MaySend() || landing_)); };
      if (!Waiting()) {
        changed_.wait(lock, [&] { return has_news() || Waiting(); });
      } else if (!changed_.wait_until(lock, Due(), [&] { return has_news() || !Waiting(); })) {
        if (Clock::now() < Due()) continue;  // a reduced frame has come meanwhile
        timed_out_ = true;
        return context.TryCancel();
      }
      if (stream_over_) return;
      if (done) continue;
      if (MaySend()) {
        const v1::FlyRequest request = RequestForNewest(std::exchange(is_first, false));
        lock.unlock();
        done = !stream.Write(request);
      } else if (landing_) {
        lock.unlock();
        done = true;
        stream.WritesDone();
      } else {
        continue;
      }
      lock.lock();
    }
  }

  // Needs mutex_.
  v1::FlyRequest RequestForNewest(bool is_first) {
    const uint64_t view = looked_ - 1;
    sent_ = looked_;
    v1::FlyRequest message;
    message.set_sequence(view);
    *message.mutable_frame() = FrameRequestToWire(scene_, newest_, "", options_.format);
    message.mutable_frame()->set_priority(caller_.options().priority);
    message.set_pacing(v1::PACING_NEWEST);
    if (is_first) message.set_resume_token(resume_token_);
    if (options_.while_moving) {
      v1::WhileMoving& moving = *message.mutable_while_moving();
      moving.set_divisor(static_cast<uint32_t>(options_.while_moving->divisor));
      if (const auto error = options_.while_moving->max_relative_error) {
        moving.set_max_relative_error(*error);
      }
    }
    sizes_[view] = {newest_.width, newest_.height};
    return message;
  }

  // OK at the end of the stream, whatever the server says it was for.
  absl::Status ReceiveAll(Stream& stream) {
    std::optional<FrameAssembler> assembler;
    uint64_t number = 0;  // of the frame that is being put together
    v1::FlyReply reply;
    while (stream.Read(&reply)) {
      if (reply.has_farewell()) {
        const std::lock_guard lock(mutex_);
        resume_token_ = reply.farewell().resume_token();
        continue;
      }
      if (!assembler) {
        auto begun = Begin(reply);
        if (!begun.ok()) return begun.status();
        assembler.emplace(*std::move(begun));
        number = reply.frame_number();
      } else if (reply.frame_number() != number) {
        return absl::DataLossError("a frame ended before it was complete");
      }
      if (auto status = assembler->Add(reply.chunk()); !status.ok()) return status;
      if (!assembler->complete()) continue;
      Deliver(reply, assembler->Take());
      assembler.reset();
    }
    return absl::OkStatus();
  }

  absl::StatusOr<FrameAssembler> Begin(const v1::FlyReply& reply) {
    const std::lock_guard lock(mutex_);
    const auto found = sizes_.find(reply.sequence());
    if (found == sizes_.end()) {
      return absl::DataLossError(
          absl::StrCat("a frame came of viewpoint ", reply.sequence(), ", which does not wait"));
    }
    auto [width, height] = found->second;
    if (reply.reduced() && options_.while_moving) {
      width = Reduced(width, options_.while_moving->divisor);
      height = Reduced(height, options_.while_moving->divisor);
    }
    sizes_.erase(sizes_.begin(), found);  // overtaken, or done
    return FrameAssembler(width, height, options_.format);
  }

  void Deliver(const v1::FlyReply& reply, Frame frame) {
    on_frame_({reply.sequence(), reply.reduced(), reply.skipped(), std::move(frame)});
    ++frames_;
    const std::lock_guard lock(mutex_);
    waiting_since_ = Clock::now();
    if (!reply.reduced()) answered_ = reply.sequence() + 1;
    changed_.notify_all();
  }

  const Caller& caller_;
  v1::RadianceCache::Stub& stub_;
  const std::string scene_;
  const LiveOptions options_;
  const OnFrame on_frame_;

  std::mutex mutex_;
  std::condition_variable changed_;
  // Guarded by mutex_. Numbers are of viewpoints: all before this one.
  FrameRequest newest_;
  uint64_t looked_ = 0;
  uint64_t sent_ = 0;      // over the stream that is open
  uint64_t answered_ = 0;  // with a full frame, or overtaken by one that was
  std::map<uint64_t, std::pair<int, int>> sizes_;  // that were asked for, by viewpoint
  Clock::time_point waiting_since_ = Clock::now();
  grpc::ClientContext* context_ = nullptr;  // of the stream that is open
  bool stream_over_ = false;
  bool landing_ = false;
  bool given_up_ = false;
  bool timed_out_ = false;
  bool ended_ = false;
  absl::Status status_;

  std::string resume_token_;  // of the server's farewell; empty: none

  uint64_t frames_ = 0;  // of the reader
  std::thread reader_;   // last: it uses all of the above
};

}  // namespace

std::unique_ptr<LiveFlight> StartLiveFlight(const Caller& caller, v1::RadianceCache::Stub& stub,
                                            const std::string& scene, const LiveOptions& options,
                                            LiveFlight::OnFrame on_frame) {
  return std::make_unique<GrpcLiveFlight>(caller, stub, scene, options, std::move(on_frame));
}

}  // namespace linetree
