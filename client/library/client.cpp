#include "client/library/client.h"

#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/library/channel.h"
#include "client/library/flight.h"
#include "client/library/status.h"
#include "client/library/steer.h"
#include "core/io/wire.h"
#include "core/io/wire_frame.h"
#include "linetree/v1/service.grpc.pb.h"

namespace linetree {
namespace {

class GrpcClient final : public Client {
 public:
  GrpcClient(const std::shared_ptr<grpc::Channel>& channel, const ClientOptions& options)
      : caller_(channel, options), stub_(v1::RadianceCache::NewStub(channel)) {}

  absl::StatusOr<v1::SceneInfo> LoadScene(const std::string& name, const v1::Scene& scene,
                                          bool replace) override {
    v1::LoadSceneRequest request;
    request.set_name(name);
    *request.mutable_scene() = scene;
    request.set_replace(replace);
    return Call<v1::SceneInfo>(&Stub::LoadScene, request,
                               replace ? Repeat::kIfRefused : Repeat::kAlways);
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
    return Call<v1::UnloadSceneReply>(&Stub::UnloadScene, request, Repeat::kIfRefused).status();
  }

  absl::StatusOr<v1::UpdateSceneReply> UpdateScene(const v1::UpdateSceneRequest& request) override {
    return Call<v1::UpdateSceneReply>(&Stub::UpdateScene, request, Repeat::kIfRefused);
  }

  absl::StatusOr<RayBatch> TraceRays(const std::string& scene, const std::vector<Ray>& rays,
                                     const RenderOptions& options) override {
    v1::TraceRaysRequest request = RaysToWire(scene, rays, options);
    request.set_priority(caller_.options().priority);
    auto reply = Call<v1::TraceRaysReply>(&Stub::TraceRays, request);
    if (!reply.ok()) return reply.status();
    return RayBatchFromWire(*reply);
  }

  absl::StatusOr<v1::GetStatsReply> GetStats(const std::string& scene) override {
    v1::GetStatsRequest request;
    request.set_scene(scene);
    return Call<v1::GetStatsReply>(&Stub::GetStats, request);
  }

  absl::StatusOr<v1::GetLimitsReply> GetLimits() override {
    return Call<v1::GetLimitsReply>(&Stub::GetLimits, v1::GetLimitsRequest());
  }

  absl::StatusOr<v1::TuneCacheReply> TuneCache(const v1::TuneCacheRequest& request) override {
    return Call<v1::TuneCacheReply>(&Stub::TuneCache, request);
  }

  absl::StatusOr<v1::ExplainReply> Explain(const v1::ExplainRequest& request) override {
    return Call<v1::ExplainReply>(&Stub::Explain, request);
  }

  absl::StatusOr<Frame> RenderFrame(const std::string& scene, const FrameRequest& request,
                                    const std::string& camera_name, const FrameFormat& format,
                                    const Progress& progress) override;
  absl::Status Fly(const std::string& scene, const std::vector<FrameRequest>& requests,
                   const FrameFormat& format,
                   const std::function<void(size_t index, Frame frame)>& on_frame) override;
  std::unique_ptr<LiveFlight> Steer(const std::string& scene, const LiveOptions& options,
                                    LiveFlight::OnFrame on_frame) override {
    return StartLiveFlight(caller_, *stub_, scene, options, std::move(on_frame));
  }

 private:
  using Stub = v1::RadianceCache::Stub;
  using Repeat = Caller::Repeat;

  template <class Reply, class Request, class Method>
  absl::StatusOr<Reply> Call(Method method, const Request& request,
                             Repeat repeat = Repeat::kAlways) {
    Reply reply;
    const auto attempt = [&](grpc::ClientContext& context) {
      return (stub_.get()->*method)(&context, request, &reply);
    };
    if (auto status = caller_.Call(attempt, repeat); !status.ok()) return status;
    return reply;
  }

  const Caller caller_;
  const std::unique_ptr<Stub> stub_;
};

// Whether a frame of this size can be put together at all; the server has limits of its own.
absl::Status CheckSize(const FrameRequest& request) {
  return ValidateSize(request.width, request.height, RenderLimits());
}

absl::StatusOr<Frame> GrpcClient::RenderFrame(const std::string& scene, const FrameRequest& request,
                                              const std::string& camera_name,
                                              const FrameFormat& format, const Progress& progress) {
  if (auto status = CheckSize(request); !status.ok()) return status;
  v1::RenderFrameRequest message = FrameRequestToWire(scene, request, camera_name, format);
  message.set_priority(caller_.options().priority);
  std::optional<FrameAssembler> assembler;  // once the server has agreed to the size
  absl::Status bad;                         // of what the server sends
  const auto attempt = [&](grpc::ClientContext& context) {
    assembler.reset();
    const auto stream = stub_->RenderFrame(&context, message);
    v1::FrameChunk chunk;
    while (bad.ok() && stream->Read(&chunk)) {
      if (!assembler) assembler.emplace(request.width, request.height, format);
      bad = assembler->Add(chunk);
      if (!bad.ok()) context.TryCancel();
      if (bad.ok() && progress) progress(assembler->share_done());
    }
    const grpc::Status ended = stream->Finish();
    return bad.ok() ? ended : ToGrpc(bad);
  };
  if (auto status = caller_.Call(attempt); !status.ok()) return status;
  if (!assembler || !assembler->complete()) {
    return absl::DataLossError("the server ended the call before the frame was complete");
  }
  return assembler->Take();
}

absl::Status GrpcClient::Fly(const std::string& scene, const std::vector<FrameRequest>& requests,
                             const FrameFormat& format,
                             const std::function<void(size_t index, Frame frame)>& on_frame) {
  for (const FrameRequest& request : requests) {
    if (auto status = CheckSize(request); !status.ok()) return status;
  }
  return Flight(caller_, *stub_, {scene, requests, format, on_frame}).Run();
}

}  // namespace

absl::StatusOr<std::unique_ptr<Client>> Client::Connect(const std::string& address,
                                                        const ClientOptions& options) {
  const auto channel = MakeChannel(address, options);
  if (!channel->WaitForConnected(std::chrono::system_clock::now() + options.connect_timeout_ms)) {
    return absl::UnavailableError(absl::StrCat("nobody answers at ", address, " within ",
                                               options.connect_timeout_ms.count(), " ms"));
  }
  return std::make_unique<GrpcClient>(channel, options);
}

}  // namespace linetree
