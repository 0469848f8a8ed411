#include "server/service.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "server/call_info.h"
#include "server/frame_call.h"
#include "server/log_format.h"
#include "server/messages.h"
#include "server/queued_call.h"
#include "server/wire_priority.h"

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

grpc::ServerUnaryReactor* Finish(grpc::CallbackServerContext* context, const CallInfo& info,
                                 const absl::Status& status) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  if (status.ok()) SendIdBack(info, context);
  reactor->Finish(Finished(status, info, context));
  return reactor;
}

// A call that is light enough to be answered where it arrives.
template <class Request, class Handler>
grpc::ServerUnaryReactor* AnswerNow(grpc::CallbackServerContext* context,
                                    const grpc::ByteBuffer& bytes, size_t max_bytes,
                                    grpc::ByteBuffer* reply, const Handler& handler) {
  auto result = Handle<Request>(bytes, max_bytes, handler);
  if (result.ok()) *reply = *std::move(result);
  return Finish(context, ReadCallInfo(context), result.status());
}

// The rays of a batch that may be parsed. Counted before anything is built from it: a ray takes
// several times more memory than bytes.
absl::StatusOr<uint64_t> CheckBatch(const grpc::ByteBuffer& bytes, const ServerLimits& limits) {
  const uint64_t rays = CountField(bytes, v1::TraceRaysRequest::kRaysFieldNumber);
  if (rays > limits.render.max_rays) {
    return absl::ResourceExhaustedError(
        absl::StrCat("rays: expected at most ", limits.render.max_rays, ", got ", rays));
  }
  const auto status = CheckSize(bytes, limits.max_batch_bytes, v1::TraceRaysRequest());
  if (!status.ok()) return status;
  return rays;
}

// Read without the rest, which is parsed, and refused for what it is, in its turn.
Priority PriorityOfBatch(const grpc::ByteBuffer& bytes) {
  const uint64_t asked = LastVarint(bytes, v1::TraceRaysRequest::kPriorityFieldNumber);
  return PriorityFromWire(static_cast<v1::Priority>(static_cast<int32_t>(asked)), Priority::kBatch,
                          "priority")
      .value_or(Priority::kBatch);
}

absl::Status CheckMessages(const grpc::ByteBuffer& bytes, const google::protobuf::Message& type,
                           const ServerLimits& limits) {
  const uint64_t messages = CountMessages(bytes, type);
  if (messages <= limits.max_scene_messages) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat("scene: expected at most ",
                                                   limits.max_scene_messages,
                                                   " messages within it, got ", messages));
}

}  // namespace

grpc::ServerUnaryReactor* Service::OnLoader(const CallInfo& info, Context* context, Bytes* reply,
                                            QueuedCall::Work work) {
  const JobInfo job{.session = info.session, .deadline = info.deadline};
  return QueuedCall::Start(backend_.open_calls(), backend_.loads(), job, info, context, reply,
                           std::move(work));
}

grpc::ServerUnaryReactor* Service::LoadScene(Context* context, const Bytes* request, Bytes* reply) {
  const CallInfo info = ReadCallInfo(context);
  // What is refused for its size does not wait in the queue.
  const size_t max_bytes = backend_.limits().max_scene_bytes;
  const auto status = CheckSize(*request, max_bytes, v1::LoadSceneRequest());
  if (!status.ok()) return Finish(context, info, status);
  const auto work = [this, request, max_bytes,
                     id = info.request_id](const CancelToken&) -> absl::StatusOr<Bytes> {
    const LogFields fields(LogFields::Fields{{"request_id", id}});
    const auto counted = CheckMessages(*request, v1::LoadSceneRequest(), backend_.limits());
    if (!counted.ok()) return counted;
    return Handle<v1::LoadSceneRequest>(*request, max_bytes, [this](v1::LoadSceneRequest&& r) {
      return backend_.LoadScene(std::move(r));
    });
  };
  return OnLoader(info, context, reply, work);
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

// What changes the scenes is done one after the other.
grpc::ServerUnaryReactor* Service::UnloadScene(Context* context, const Bytes* request,
                                               Bytes* reply) {
  const CallInfo info = ReadCallInfo(context);
  const auto work = [this, request, id = info.request_id](const CancelToken&) {
    const LogFields fields(LogFields::Fields{{"request_id", id}});
    return Handle<v1::UnloadSceneRequest>(
        *request, backend_.limits().max_request_bytes,
        [this](const v1::UnloadSceneRequest& r) { return backend_.UnloadScene(r); });
  };
  return OnLoader(info, context, reply, work);
}

grpc::ServerUnaryReactor* Service::UpdateScene(Context* context, const Bytes* request,
                                               Bytes* reply) {
  const CallInfo info = ReadCallInfo(context);
  const size_t max_bytes = backend_.limits().max_scene_bytes;
  const auto status = CheckSize(*request, max_bytes, v1::UpdateSceneRequest());
  if (!status.ok()) return Finish(context, info, status);
  const auto work = [this, request, max_bytes,
                     id = info.request_id](const CancelToken& cancel) -> absl::StatusOr<Bytes> {
    const LogFields fields(LogFields::Fields{{"request_id", id}});
    const auto counted = CheckMessages(*request, v1::UpdateSceneRequest(), backend_.limits());
    if (!counted.ok()) return counted;
    return Handle<v1::UpdateSceneRequest>(
        *request, max_bytes,
        [&](const v1::UpdateSceneRequest& r) { return backend_.UpdateScene(r, cancel); });
  };
  return OnLoader(info, context, reply, work);
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
  const CallInfo info = ReadCallInfo(context);
  const auto rays = CheckBatch(*request, backend_.limits());
  if (!rays.ok()) return Finish(context, info, rays.status());
  const auto timer = std::make_shared<FrameTimer>();
  timer->Enter(FrameTimer::Stage::kQueue);
  const auto work = [this, request, timer, id = info.request_id](const CancelToken& cancel) {
    timer->Enter(FrameTimer::Stage::kRender);
    return Handle<v1::TraceRaysRequest>(*request, backend_.limits().max_batch_bytes,
                                        [&](const v1::TraceRaysRequest& r) {
                                          auto answer = backend_.TraceRays(r, cancel, *timer);
                                          if (!answer.ok()) return answer;
                                          answer->set_request_id(id);
                                          *answer->mutable_timing() = timer->ToWire();
                                          return answer;
                                        });
  };
  const JobInfo job{.priority = PriorityOfBatch(*request),
                    .session = info.session,
                    .work_rays = std::max<uint64_t>(*rays, 1),
                    .deadline = info.deadline};
  return QueuedCall::Start(backend_.open_calls(), backend_.renders(), job, info, context, reply,
                           work);
}

grpc::ServerUnaryReactor* Service::GetStats(Context* context, const Bytes* request, Bytes* reply) {
  return AnswerNow<v1::GetStatsRequest>(
      context, *request, backend_.limits().max_request_bytes, reply,
      [this](const v1::GetStatsRequest& r) { return backend_.GetStats(r); });
}

grpc::ServerUnaryReactor* Service::GetLimits(Context* context, const Bytes* request, Bytes* reply) {
  return AnswerNow<v1::GetLimitsRequest>(
      context, *request, backend_.limits().max_request_bytes, reply,
      [this](const v1::GetLimitsRequest&) -> absl::StatusOr<v1::GetLimitsReply> {
        return backend_.GetLimits();
      });
}

grpc::ServerUnaryReactor* Service::TuneCache(Context* context, const Bytes* request, Bytes* reply) {
  const CallInfo info = ReadCallInfo(context);
  const auto work = [this, request, id = info.request_id](const CancelToken&) {
    const LogFields fields(LogFields::Fields{{"request_id", id}});
    return Handle<v1::TuneCacheRequest>(
        *request, backend_.limits().max_request_bytes,
        [this](const v1::TuneCacheRequest& r) { return backend_.TuneCache(r); });
  };
  return OnLoader(info, context, reply, work);
}

grpc::ServerUnaryReactor* Service::Explain(Context* context, const Bytes* request, Bytes* reply) {
  const auto work = [this, request](const CancelToken&) {
    return Handle<v1::ExplainRequest>(
        *request, backend_.limits().max_request_bytes,
        [this](const v1::ExplainRequest& r) { return backend_.Explain(r); });
  };
  return OnLoader(ReadCallInfo(context), context, reply, work);
}

}  // namespace linetree
