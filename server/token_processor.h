// Refuses callers without a token before anything of their request is read, which the gate cannot:
// gRPC hands it whole requests. Only connections by TLS have it (gRPC wants credentials for it);
// the gate asks everybody, and for the role.
#pragma once

#include <grpcpp/security/auth_metadata_processor.h>
#include <spdlog/logger.h>

#include <memory>

#include "server/metrics.h"
#include "server/secrets.h"

namespace linetree {

// Thread safety: all methods may be called from any thread.
class TokenProcessor final : public grpc::AuthMetadataProcessor {
 public:
  // `secrets`, which has tokens, must outlive this. Refused calls have no other place to be counted
  // and logged.
  TokenProcessor(const Secrets& secrets, std::shared_ptr<CallMetrics> metrics,
                 std::shared_ptr<spdlog::logger> log)
      : secrets_(secrets), metrics_(std::move(metrics)), log_(std::move(log)) {}

  bool IsBlocking() const override { return false; }
  // Calls of other services than ours (health, reflection) pass.
  grpc::Status Process(const InputMetadata& metadata, grpc::AuthContext* context,
                       OutputMetadata* consumed, OutputMetadata* response) override;

 private:
  const Secrets& secrets_;
  const std::shared_ptr<CallMetrics> metrics_;
  const std::shared_ptr<spdlog::logger> log_;
};

}  // namespace linetree
