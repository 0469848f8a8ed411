#include "server/messages.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/wire_format_lite.h>
#include <grpcpp/impl/codegen/proto_utils.h>
#include <grpcpp/support/proto_buffer_reader.h>

#include <limits>

#include "absl/strings/str_cat.h"
#include "client/library/status.h"
#include "core/math/check.h"

namespace linetree {

namespace pb = google::protobuf;

absl::Status Parse(const grpc::ByteBuffer& bytes, size_t max_bytes, pb::Message* message) {
  const std::string& type = message->GetDescriptor()->name();
  if (bytes.Length() > max_bytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat(type, ": expected at most ", max_bytes, " bytes, got ", bytes.Length()));
  }
  grpc::ByteBuffer copy = bytes;  // references the same memory; a reader needs one it may change
  grpc::ProtoBufferReader reader(&copy);
  if (!reader.status().ok() || !message->ParseFromZeroCopyStream(&reader)) {
    return absl::InvalidArgumentError(
        absl::StrCat(type, ": expected a well-formed message of this type"));
  }
  return absl::OkStatus();
}

uint64_t CountField(const grpc::ByteBuffer& bytes, int field_number) {
  using pb::internal::WireFormatLite;
  grpc::ByteBuffer copy = bytes;
  grpc::ProtoBufferReader reader(&copy);
  if (!reader.status().ok()) return 0;
  pb::io::CodedInputStream stream(&reader);
  stream.SetTotalBytesLimit(std::numeric_limits<int>::max());
  uint64_t count = 0;
  while (const uint32_t tag = stream.ReadTag()) {
    if (WireFormatLite::GetTagFieldNumber(tag) == field_number) ++count;
    if (!WireFormatLite::SkipField(&stream, tag)) break;
  }
  return count;
}

grpc::ByteBuffer Serialize(const pb::Message& message) {
  grpc::ByteBuffer bytes;
  bool own_buffer = false;
  const grpc::Status status =
      grpc::SerializationTraits<pb::Message>::Serialize(message, &bytes, &own_buffer);
  LT_CHECK(status.ok());
  return bytes;
}

grpc::Status Finished(const absl::Status& status, grpc::CallbackServerContext* context) {
  if (absl::IsResourceExhausted(status)) {
    const auto delay_ms = RetryAfter(status);
    context->AddTrailingMetadata(kRetryPushbackKey,
                                 absl::StrCat(delay_ms ? delay_ms->count() : -1));
  }
  return ToGrpc(status);
}

}  // namespace linetree
