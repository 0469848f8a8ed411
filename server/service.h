// The RPCs behind the gate: bodies only translate between gRPC and the Backend.
#pragma once

#include "linetree/v1/service.grpc.pb.h"
#include "server/backend.h"
#include "server/fly_call.h"
#include "server/queued_call.h"

namespace linetree {

// All methods by callback, with requests and replies as bytes (see messages.h).
using RawService = v1::RadianceCache::WithRawCallbackMethod_LoadScene<
    v1::RadianceCache::WithRawCallbackMethod_ListScenes<
        v1::RadianceCache::WithRawCallbackMethod_DescribeScene<
            v1::RadianceCache::WithRawCallbackMethod_UnloadScene<
                v1::RadianceCache::WithRawCallbackMethod_RenderFrame<
                    v1::RadianceCache::WithRawCallbackMethod_Fly<
                        v1::RadianceCache::WithRawCallbackMethod_TraceRays<
                            v1::RadianceCache::WithRawCallbackMethod_GetStats<
                                v1::RadianceCache::WithRawCallbackMethod_GetLimits<
                                    v1::RadianceCache::WithRawCallbackMethod_UpdateScene<
                                        v1::RadianceCache::WithRawCallbackMethod_TuneCache<
                                            v1::RadianceCache::WithRawCallbackMethod_Explain<
                                                v1::RadianceCache::Service>>>>>>>>>>>>;

class Service final : public RawService {
 public:
  explicit Service(Backend& backend) : backend_(backend) {}

  // Ends the flights that are open or come.
  void Drain() { flights_.Drain(); }

  using Context = grpc::CallbackServerContext;
  using Bytes = grpc::ByteBuffer;
  grpc::ServerUnaryReactor* LoadScene(Context* context, const Bytes* request,
                                      Bytes* reply) override;
  grpc::ServerUnaryReactor* ListScenes(Context* context, const Bytes* request,
                                       Bytes* reply) override;
  grpc::ServerUnaryReactor* DescribeScene(Context* context, const Bytes* request,
                                          Bytes* reply) override;
  grpc::ServerUnaryReactor* UnloadScene(Context* context, const Bytes* request,
                                        Bytes* reply) override;
  grpc::ServerUnaryReactor* UpdateScene(Context* context, const Bytes* request,
                                        Bytes* reply) override;
  grpc::ServerWriteReactor<Bytes>* RenderFrame(Context* context, const Bytes* request) override;
  grpc::ServerBidiReactor<Bytes, Bytes>* Fly(Context* context) override;
  grpc::ServerUnaryReactor* TraceRays(Context* context, const Bytes* request,
                                      Bytes* reply) override;
  grpc::ServerUnaryReactor* GetStats(Context* context, const Bytes* request, Bytes* reply) override;
  grpc::ServerUnaryReactor* GetLimits(Context* context, const Bytes* request,
                                      Bytes* reply) override;
  grpc::ServerUnaryReactor* TuneCache(Context* context, const Bytes* request,
                                      Bytes* reply) override;
  grpc::ServerUnaryReactor* Explain(Context* context, const Bytes* request, Bytes* reply) override;

 private:
  // What changes scenes: one call after another.
  grpc::ServerUnaryReactor* OnLoader(const CallInfo& info, Context* context, Bytes* reply,
                                     QueuedCall::Work work);

  Backend& backend_;
  Flights flights_;
};

}  // namespace linetree
