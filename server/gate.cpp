#include "server/gate.h"

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "server/call_info.h"
#include "server/messages.h"

namespace linetree {
namespace {

constexpr absl::string_view kScheme = "Bearer ";

// A call that ends before it begins.
template <class Reactor>
class Refused final : public Reactor {
 public:
  explicit Refused(const grpc::Status& status) { this->Finish(status); }
  void OnDone() override { delete this; }
};

}  // namespace

std::vector<absl::string_view> Authorization(
    const std::multimap<grpc::string_ref, grpc::string_ref>& metadata) {
  std::vector<absl::string_view> values;
  const auto [begin, end] = metadata.equal_range("authorization");
  for (auto it = begin; it != end; ++it) values.emplace_back(it->second.data(), it->second.size());
  return values;
}

absl::Status CheckCaller(const Tokens& tokens, const std::vector<absl::string_view>& authorization,
                         Role needed, absl::string_view what) {
  const auto unauthenticated = [](absl::string_view got) {
    return absl::UnauthenticatedError(absl::StrCat(
        "authorization: expected 'Bearer TOKEN' with a token of this server, got ", got));
  };
  if (authorization.empty()) return unauthenticated("none");
  if (authorization.size() > 1) return unauthenticated("several values");
  if (!absl::StartsWithIgnoreCase(authorization[0], kScheme)) {
    return unauthenticated("another scheme");
  }
  const auto role = tokens.RoleOf(authorization[0].substr(kScheme.size()));
  if (!role) return unauthenticated("an unknown token");
  if (needed == Role::kAdmin && *role != Role::kAdmin) {
    return absl::PermissionDeniedError(
        absl::StrCat("authorization: ", what,
                     " expects a token of the role admin, got one of the role ", RoleName(*role)));
  }
  return absl::OkStatus();
}

template <class Reactor, class Call>
Reactor* Gate::Pass(Context* context, Role needed, absl::string_view what, const Call& call) const {
  absl::Status status;
  if (closed_) {
    status = absl::UnavailableError("the server is stopping");
  } else if (const auto tokens = secrets_.tokens()) {
    status = CheckCaller(*tokens, Authorization(context->client_metadata()), needed, what);
  }
  if (status.ok()) return call();
  return new Refused<Reactor>(Finished(status, ReadCallInfo(context), context));
}

grpc::ServerUnaryReactor* Gate::LoadScene(Context* context, const Bytes* request, Bytes* reply) {
  return Pass<grpc::ServerUnaryReactor>(context, Role::kAdmin, "LoadScene", [&] {
    return service_.LoadScene(context, request, reply);
  });
}

grpc::ServerUnaryReactor* Gate::ListScenes(Context* context, const Bytes* request, Bytes* reply) {
  return Pass<grpc::ServerUnaryReactor>(context, Role::kViewer, "ListScenes", [&] {
    return service_.ListScenes(context, request, reply);
  });
}

grpc::ServerUnaryReactor* Gate::DescribeScene(Context* context, const Bytes* request,
                                              Bytes* reply) {
  return Pass<grpc::ServerUnaryReactor>(context, Role::kViewer, "DescribeScene", [&] {
    return service_.DescribeScene(context, request, reply);
  });
}

grpc::ServerUnaryReactor* Gate::UnloadScene(Context* context, const Bytes* request, Bytes* reply) {
  return Pass<grpc::ServerUnaryReactor>(context, Role::kAdmin, "UnloadScene", [&] {
    return service_.UnloadScene(context, request, reply);
  });
}

grpc::ServerUnaryReactor* Gate::UpdateScene(Context* context, const Bytes* request, Bytes* reply) {
  return Pass<grpc::ServerUnaryReactor>(context, Role::kAdmin, "UpdateScene", [&] {
    return service_.UpdateScene(context, request, reply);
  });
}

grpc::ServerWriteReactor<grpc::ByteBuffer>* Gate::RenderFrame(Context* context,
                                                              const Bytes* request) {
  return Pass<grpc::ServerWriteReactor<Bytes>>(context, Role::kViewer, "RenderFrame", [&] {
    return service_.RenderFrame(context, request);
  });
}

grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* Gate::Fly(Context* context) {
  return Pass<grpc::ServerBidiReactor<Bytes, Bytes>>(context, Role::kViewer, "Fly",
                                                     [&] { return service_.Fly(context); });
}

grpc::ServerUnaryReactor* Gate::TraceRays(Context* context, const Bytes* request, Bytes* reply) {
  return Pass<grpc::ServerUnaryReactor>(context, Role::kViewer, "TraceRays", [&] {
    return service_.TraceRays(context, request, reply);
  });
}

grpc::ServerUnaryReactor* Gate::GetStats(Context* context, const Bytes* request, Bytes* reply) {
  return Pass<grpc::ServerUnaryReactor>(context, Role::kViewer, "GetStats",
                                        [&] { return service_.GetStats(context, request, reply); });
}

grpc::ServerUnaryReactor* Gate::GetLimits(Context* context, const Bytes* request, Bytes* reply) {
  return Pass<grpc::ServerUnaryReactor>(context, Role::kViewer, "GetLimits", [&] {
    return service_.GetLimits(context, request, reply);
  });
}

grpc::ServerUnaryReactor* Gate::TuneCache(Context* context, const Bytes* request, Bytes* reply) {
  return Pass<grpc::ServerUnaryReactor>(context, Role::kAdmin, "TuneCache", [&] {
    return service_.TuneCache(context, request, reply);
  });
}

grpc::ServerUnaryReactor* Gate::Explain(Context* context, const Bytes* request, Bytes* reply) {
  return Pass<grpc::ServerUnaryReactor>(context, Role::kViewer, "Explain",
                                        [&] { return service_.Explain(context, request, reply); });
}

}  // namespace linetree
