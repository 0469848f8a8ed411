// In front of all RPCs: who calls, and whether they may. gRPC knows the gate only, so a method that
// the gate does not name is not there.
//
// Without tokens everybody may do everything. With them, a caller shows one in the metadata
// "authorization" as "Bearer TOKEN": an admin's may do everything, a viewer's what does not change
// the scenes that are loaded.
#pragma once

#include <atomic>
#include <map>
#include <vector>

#include "server/secrets.h"
#include "server/service.h"

namespace linetree {

class Gate final : public RawService {
 public:
  // Both must outlive the gate.
  Gate(linetree::Service& service, const Secrets& secrets) : service_(service), secrets_(secrets) {}

  // Lets nobody in any more: calls end with UNAVAILABLE.
  void Close() { closed_ = true; }

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
  // Lets the call through, or ends it.
  template <class Reactor, class Call>
  Reactor* Pass(Context* context, Role needed, absl::string_view what, const Call& call) const;

  linetree::Service& service_;
  const Secrets& secrets_;
  std::atomic<bool> closed_{false};
};

// The values of a call's metadata of this name; they live as long as it does.
std::vector<absl::string_view> Authorization(
    const std::multimap<grpc::string_ref, grpc::string_ref>& metadata);

// OK, UNAUTHENTICATED without one of the tokens, PERMISSION_DENIED for a viewer who wants to do
// what an admin may. `authorization` holds the values of the metadata of this name; `what` is the
// call.
absl::Status CheckCaller(const Tokens& tokens, const std::vector<absl::string_view>& authorization,
                         Role needed, absl::string_view what);

}  // namespace linetree
