#include "server/token_processor.h"

#include "absl/strings/match.h"
#include "client/library/status.h"
#include "server/gate.h"
#include "server/log_format.h"

namespace linetree {

grpc::Status TokenProcessor::Process(const InputMetadata& metadata, grpc::AuthContext*,
                                     OutputMetadata*, OutputMetadata*) {
  const auto path = metadata.find(":path");
  const std::string method =
      path == metadata.end() ? "" : std::string(path->second.data(), path->second.size());
  if (absl::StartsWith(method, "/grpc.")) return grpc::Status::OK;
  const auto status =
      CheckCaller(*secrets_.tokens(), Authorization(metadata), Role::kViewer, method);
  if (status.ok()) return grpc::Status::OK;
  metrics_->Count(method, grpc::StatusCode::UNAUTHENTICATED, std::chrono::seconds(0));
  const LogFields fields({{"rpc", method}, {"code", "UNAUTHENTICATED"}});
  log_->info("call");
  return ToGrpc(status);
}

}  // namespace linetree
