#include "server/service.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "server/frame_call.h"
#include "server/messages.h"
#include "server/queued_call.h"

namespace linetree {
namespace {

// Parses, hands over, serializes.
template <class Request, class Handler>
absl::StatusOr<grpc::ByteBuffer> Handle(const grpc::ByteBuffer& bytes, size_t max_bytes,
                                        const Handler& handler) {
  Request request;
  if (auto status = Parse(bytes, max_bytes, &request); !status.ok()) return status;
  auto reply = handler(std::move(request));
  if (!reply.ok()) return reply.status();
  return Serialize(*reply);
}

// A call that is light enough to be answered where it arrives.
template <class Request, class Handler>
grpc::ServerUnaryReactor* AnswerNow(grpc::CallbackServerContext* context,
                                    const grpc::ByteBuffer& bytes, size_t max_bytes,
                                    grpc::ByteBuffer* reply, const Handler& handler) {
  auto result = Handle<Request>(bytes, max_bytes, handler);
  if (result.ok()) *reply = *std::move(result);
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(Finished(result.status(), context));
  return reactor;
}

}  // namespace

grpc::ServerUnaryReactor* Service::LoadScene(Context* context, const Bytes* request, Bytes* reply) {
  const auto work = [this, request](const CancelToken&) {
    return Handle<v1::LoadSceneRequest>(
        *request, backend_.limits().max_scene_bytes,
        [this](v1::LoadSceneRequest&& r) { return backend_.LoadScene(std::move(r)); });
  };
  return QueuedCall::Start(backend_.loads(), context, reply, work, backend_.Busy("loader"));
}

grpc::ServerUnaryReactor* Service::ListScenes(Context* context, const Bytes* request,
                                              Bytes* reply) {
  return AnswerNow<v1::ListScenesRequest>(
      context, *request, backend_.limits().max_request_bytes, reply,
      [this](const v1::ListScenesRequest&) -> absl::StatusOr<v1::ListScenesReply> {
        return backend_.ListScenes();
      });
}

grpc::ServerUnaryReactor* Service::DescribeScene(Context* context, const Bytes* request,
                                                 Bytes* reply) {
  return AnswerNow<v1::DescribeSceneRequest>(
      context, *request, backend_.limits().max_request_bytes, reply,
      [this](const v1::DescribeSceneRequest& r) { return backend_.DescribeScene(r); });
}

grpc::ServerUnaryReactor* Service::UnloadScene(Context* context, const Bytes* request,
                                               Bytes* reply) {
  return AnswerNow<v1::UnloadSceneRequest>(
      context, *request, backend_.limits().max_request_bytes, reply,
      [this](const v1::UnloadSceneRequest& r) { return backend_.UnloadScene(r); });
}

grpc::ServerWriteReactor<grpc::ByteBuffer>* Service::RenderFrame(Context* context,
                                                                 const Bytes* request) {
  return FrameCall::Start(backend_, context, *request);
}

grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* Service::Fly(Context* context) {
  const auto flight = FlyCall::Start(backend_, context);
  flights_.Add(flight);
  return flight.get();
}

grpc::ServerUnaryReactor* Service::TraceRays(Context* context, const Bytes* request, Bytes* reply) {
  const auto work = [this, request](const CancelToken& cancel) -> absl::StatusOr<Bytes> {
    const uint64_t rays = CountField(*request, v1::TraceRaysRequest::kRaysFieldNumber);
    const uint64_t max_rays = backend_.limits().render.max_rays;
    if (rays > max_rays) {
      return absl::ResourceExhaustedError(
          absl::StrCat("rays: expected at most ", max_rays, ", got ", rays));
    }
    return Handle<v1::TraceRaysRequest>(
        *request, static_cast<size_t>(backend_.limits().max_message_bytes),
        [&](const v1::TraceRaysRequest& r) { return backend_.TraceRays(r, cancel); });
  };
  return QueuedCall::Start(backend_.renders(), context, reply, work, backend_.Busy("render slot"));
}

grpc::ServerUnaryReactor* Service::GetStats(Context* context, const Bytes* request, Bytes* reply) {
  return AnswerNow<v1::GetStatsRequest>(
      context, *request, backend_.limits().max_request_bytes, reply,
      [this](const v1::GetStatsRequest& r) { return backend_.GetStats(r); });
}

}  // namespace linetree
