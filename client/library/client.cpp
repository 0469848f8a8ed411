#include "client/library/client.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/support/channel_arguments.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/library/status.h"
#include "core/io/wire.h"
#include "core/io/wire_frame.h"
#include "linetree/v1/service.grpc.pb.h"

namespace linetree {
namespace {

// Viewpoints that Fly sends ahead of the frames: enough to keep the server busy, far less than it
// holds.
constexpr size_t kViewpointsAhead = 8;
// Calls of more bytes than this are not repeated: gRPC has to keep them for it.
constexpr int kRetryBufferBytes = 64 << 20;

using Clock = std::chrono::system_clock;

// gRPC repeats calls itself, with back-off and jitter, and heeds the server's hints.
std::string ServiceConfig(int max_attempts) {
  if (max_attempts < 2) return "{}";
  return absl::StrCat(R"({"methodConfig": [{"name": [{"service": ")",
                      v1::RadianceCache::service_full_name(),
                      R"("}], "retryPolicy": {"maxAttempts": )", max_attempts,
                      R"(, "initialBackoff": "0.1s", "maxBackoff": "2s", "backoffMultiplier": 2,)",
                      R"( "retryableStatusCodes": ["UNAVAILABLE", "RESOURCE_EXHAUSTED"]}}]})");
}

std::shared_ptr<grpc::Channel> MakeChannel(const std::string& address,
                                           const ClientOptions& options) {
  grpc::ChannelArguments arguments;
  arguments.SetServiceConfigJSON(ServiceConfig(options.max_attempts));
  arguments.SetMaxReceiveMessageSize(std::numeric_limits<int>::max());
  arguments.SetInt(GRPC_ARG_PER_RPC_RETRY_BUFFER_SIZE, kRetryBufferBytes);
  // Each client its own connection, as clients on different machines would have.
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  return grpc::CreateCustomChannel(address, grpc::InsecureChannelCredentials(), arguments);
}

// A context whose deadline is `count` calls away.
class Context : public grpc::ClientContext {
 public:
  explicit Context(std::chrono::milliseconds timeout_ms, size_t count = 1) {
    set_deadline(Clock::now() + timeout_ms * static_cast<int64_t>(std::max<size_t>(count, 1)));
  }
};

class GrpcClient final : public Client {
 public:
  GrpcClient(const std::shared_ptr<grpc::Channel>& channel, const ClientOptions& options)
      : options_(options), stub_(v1::RadianceCache::NewStub(channel)) {}

  absl::StatusOr<v1::SceneInfo> LoadScene(const std::string& name, const v1::Scene& scene,
                                          bool replace) override {
    v1::LoadSceneRequest request;
    request.set_name(name);
    *request.mutable_scene() = scene;
    request.set_replace(replace);
    return Call<v1::SceneInfo>(&Stub::LoadScene, request);
  }

  absl::StatusOr<std::vector<v1::SceneInfo>> ListScenes() override {
    auto reply = Call<v1::ListScenesReply>(&Stub::ListScenes, v1::ListScenesRequest());
    if (!reply.ok()) return reply.status();
    return std::vector<v1::SceneInfo>(reply->scenes().begin(), reply->scenes().end());
  }

  absl::StatusOr<v1::SceneInfo> DescribeScene(const std::string& name) override {
    v1::DescribeSceneRequest request;
    request.set_scene(name);
    return Call<v1::SceneInfo>(&Stub::DescribeScene, request);
  }

  absl::Status UnloadScene(const std::string& name) override {
    v1::UnloadSceneRequest request;
    request.set_scene(name);
    return Call<v1::UnloadSceneReply>(&Stub::UnloadScene, request).status();
  }

  absl::StatusOr<RayBatch> TraceRays(const std::string& scene, const std::vector<Ray>& rays,
                                     const RenderOptions& options) override {
    auto reply = Call<v1::TraceRaysReply>(&Stub::TraceRays, RaysToWire(scene, rays, options));
    if (!reply.ok()) return reply.status();
    return RayBatchFromWire(*reply);
  }

  absl::StatusOr<v1::GetStatsReply> GetStats(const std::string& scene) override {
    v1::GetStatsRequest request;
    request.set_scene(scene);
    return Call<v1::GetStatsReply>(&Stub::GetStats, request);
  }

  absl::StatusOr<Frame> RenderFrame(const std::string& scene, const FrameRequest& request,
                                    const std::string& camera_name, bool all_layers,
                                    const Progress& progress) override;
  absl::Status Fly(const std::string& scene, const std::vector<FrameRequest>& requests,
                   bool all_layers,
                   const std::function<void(size_t index, Frame frame)>& on_frame) override;

 private:
  using Stub = v1::RadianceCache::Stub;
  using FlyStream = grpc::ClientReaderWriter<v1::FlyRequest, v1::FlyReply>;

  template <class Reply, class Request, class Method>
  absl::StatusOr<Reply> Call(Method method, const Request& request) {
    Context context(options_.call_timeout_ms);
    Reply reply;
    const grpc::Status status = (stub_.get()->*method)(&context, request, &reply);
    if (!status.ok()) return FromGrpc(status);
    return reply;
  }

  // Reads one frame; OutOfRange when the stream ends before it is complete.
  static absl::StatusOr<Frame> ReadFrame(FlyStream& stream, uint64_t sequence,
                                         const FrameRequest& request, bool all_layers);

  const ClientOptions options_;
  const std::unique_ptr<Stub> stub_;
};

// Whether a frame of this size can be put together at all; the server has limits of its own.
absl::Status CheckSize(const FrameRequest& request) {
  return ValidateSize(request.width, request.height, RenderLimits());
}

absl::StatusOr<Frame> GrpcClient::RenderFrame(const std::string& scene, const FrameRequest& request,
                                              const std::string& camera_name, bool all_layers,
                                              const Progress& progress) {
  if (auto status = CheckSize(request); !status.ok()) return status;
  Context context(options_.call_timeout_ms);
  const auto stream =
      stub_->RenderFrame(&context, FrameRequestToWire(scene, request, camera_name, all_layers));
  std::optional<FrameAssembler> assembler;  // once the server has agreed to the size
  v1::FrameChunk chunk;
  while (stream->Read(&chunk)) {
    if (!assembler) assembler.emplace(request.width, request.height, all_layers);
    if (auto status = assembler->Add(chunk); !status.ok()) {
      context.TryCancel();
      stream->Finish();
      return status;
    }
    if (progress) progress(assembler->share_done());
  }
  if (auto status = FromGrpc(stream->Finish()); !status.ok()) return status;
  if (!assembler || !assembler->complete()) {
    return absl::DataLossError("the server ended the call before the frame was complete");
  }
  return assembler->Take();
}

absl::StatusOr<Frame> GrpcClient::ReadFrame(FlyStream& stream, uint64_t sequence,
                                            const FrameRequest& request, bool all_layers) {
  FrameAssembler assembler(request.width, request.height, all_layers);
  v1::FlyReply reply;
  while (!assembler.complete()) {
    if (!stream.Read(&reply) || reply.has_farewell()) {
      return absl::OutOfRangeError("the server ended the flight early");
    }
    if (reply.sequence() != sequence) {
      return absl::DataLossError(absl::StrCat("expected a chunk of frame ", sequence,
                                              ", got one of frame ", reply.sequence()));
    }
    if (auto status = assembler.Add(reply.chunk()); !status.ok()) return status;
  }
  return assembler.Take();
}

absl::Status GrpcClient::Fly(const std::string& scene, const std::vector<FrameRequest>& requests,
                             bool all_layers,
                             const std::function<void(size_t index, Frame frame)>& on_frame) {
  for (const FrameRequest& request : requests) {
    if (auto status = CheckSize(request); !status.ok()) return status;
  }
  Context context(options_.call_timeout_ms, requests.size());
  const auto stream = stub_->Fly(&context);
  bool writable = true;
  size_t sent = 0;
  for (size_t index = 0; index < requests.size(); ++index) {
    for (; writable && sent < std::min(requests.size(), index + kViewpointsAhead); ++sent) {
      v1::FlyRequest message;
      message.set_sequence(sent);
      message.set_pacing(v1::PACING_EVERY);
      *message.mutable_frame() = FrameRequestToWire(scene, requests[sent], "", all_layers);
      writable = stream->Write(message);
    }
    auto frame = ReadFrame(*stream, index, requests[index], all_layers);
    if (absl::IsOutOfRange(frame.status())) {
      auto status = FromGrpc(stream->Finish());
      return status.ok() ? frame.status() : status;
    }
    if (!frame.ok()) {
      context.TryCancel();
      stream->Finish();
      return frame.status();
    }
    on_frame(index, *std::move(frame));
  }
  stream->WritesDone();
  return FromGrpc(stream->Finish());
}

}  // namespace

absl::StatusOr<std::unique_ptr<Client>> Client::Connect(const std::string& address,
                                                        const ClientOptions& options) {
  const auto channel = MakeChannel(address, options);
  if (!channel->WaitForConnected(Clock::now() + options.connect_timeout_ms)) {
    return absl::UnavailableError(absl::StrCat("nobody answers at ", address, " within ",
                                               options.connect_timeout_ms.count(), " ms"));
  }
  return std::make_unique<GrpcClient>(channel, options);
}

}  // namespace linetree
