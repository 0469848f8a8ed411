// One flight of a client: viewpoints out, frames in, over as many streams as it takes.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "client/library/channel.h"
#include "linetree/v1/service.grpc.pb.h"

namespace linetree {

// What Client::Fly was asked.
struct FlightPlan {
  const std::string& scene;
  const std::vector<FrameRequest>& requests;
  const FrameFormat& format;
  const std::function<void(size_t index, Frame frame)>& on_frame;
};

class Flight {
 public:
  Flight(const Caller& caller, v1::RadianceCache::Stub& stub, const FlightPlan& plan)
      : caller_(caller), stub_(stub), plan_(plan) {}

  // All frames, or the first error that is no reason to try again.
  absl::Status Run();

 private:
  using Stream = grpc::ClientReaderWriter<v1::FlyRequest, v1::FlyReply>;

  // From the first frame that is missing, over one stream, as far as it goes.
  absl::Status RunOneStream(Caller::Deadline deadline);
  // Those that may be sent before the next frame has come. False when the stream takes no more.
  bool SendAhead(Stream& stream);
  v1::FlyRequest RequestFor(size_t index) const;
  // Reads the next frame; OutOfRange when the stream ends before it is complete.
  absl::StatusOr<Frame> ReadFrame(Stream& stream);

  const Caller& caller_;
  v1::RadianceCache::Stub& stub_;
  const FlightPlan plan_;
  size_t next_ = 0;           // the first frame that is missing
  std::string resume_token_;  // of the server's farewell; empty: none
  size_t sent_ = 0;           // over the stream that is open: viewpoints before this one
};

}  // namespace linetree
