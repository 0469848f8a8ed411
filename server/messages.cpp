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

namespace {

using pb::internal::WireFormatLite;

// As deep as protobuf itself goes.
constexpr int kMaxNesting = 100;

// Counts the messages inside one of this type, up to the stream's limit.
uint64_t CountInside(pb::io::CodedInputStream& stream, const pb::Descriptor* type, int nesting) {
  uint64_t count = 0;
  while (const uint32_t tag = stream.ReadTag()) {
    const auto* field = type->FindFieldByNumber(WireFormatLite::GetTagFieldNumber(tag));
    const bool is_message =
        field != nullptr && field->message_type() != nullptr && nesting < kMaxNesting &&
        WireFormatLite::GetTagWireType(tag) == WireFormatLite::WIRETYPE_LENGTH_DELIMITED;
    if (!is_message) {
      if (!WireFormatLite::SkipField(&stream, tag)) break;
      continue;
    }
    int length = 0;
    if (!stream.ReadVarintSizeAsInt(&length)) break;
    const auto outer = stream.PushLimit(length);
    count += 1 + CountInside(stream, field->message_type(), nesting + 1);
    if (!stream.CheckEntireMessageConsumedAndPopLimit(outer)) break;
  }
  return count;
}

// visit(tag, stream) for the fields at the top level, until it says that it could not read one.
template <class Fn>
void ForEachField(const grpc::ByteBuffer& bytes, Fn&& visit) {
  grpc::ByteBuffer copy = bytes;
  grpc::ProtoBufferReader reader(&copy);
  if (!reader.status().ok()) return;
  pb::io::CodedInputStream stream(&reader);
  stream.SetTotalBytesLimit(std::numeric_limits<int>::max());
  while (const uint32_t tag = stream.ReadTag()) {
    if (!visit(tag, stream)) return;
  }
}

}  // namespace

absl::Status CheckSize(const grpc::ByteBuffer& bytes, size_t max_bytes, const pb::Message& type) {
  if (bytes.Length() <= max_bytes) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat(type.GetDescriptor()->name(),
                                                   ": expected at most ", max_bytes, " bytes, got ",
                                                   bytes.Length()));
}

absl::Status Parse(const grpc::ByteBuffer& bytes, size_t max_bytes, pb::Message* message) {
  if (auto status = CheckSize(bytes, max_bytes, *message); !status.ok()) return status;
  grpc::ByteBuffer copy = bytes;  // references the same memory; a reader needs one it may change
  grpc::ProtoBufferReader reader(&copy);
  if (!reader.status().ok() || !message->ParseFromZeroCopyStream(&reader)) {
    return absl::InvalidArgumentError(absl::StrCat(
        message->GetDescriptor()->name(), ": expected a well-formed message of this type"));
  }
  return absl::OkStatus();
}

uint64_t CountMessages(const grpc::ByteBuffer& bytes, const pb::Message& type) {
  grpc::ByteBuffer copy = bytes;
  grpc::ProtoBufferReader reader(&copy);
  if (!reader.status().ok()) return 0;
  pb::io::CodedInputStream stream(&reader);
  stream.SetTotalBytesLimit(std::numeric_limits<int>::max());
  return 1 + CountInside(stream, type.GetDescriptor(), 0);
}

uint64_t CountField(const grpc::ByteBuffer& bytes, int field_number) {
  uint64_t count = 0;
  ForEachField(bytes, [&](uint32_t tag, pb::io::CodedInputStream& stream) {
    if (WireFormatLite::GetTagFieldNumber(tag) == field_number) ++count;
    return WireFormatLite::SkipField(&stream, tag);
  });
  return count;
}

uint64_t LastVarint(const grpc::ByteBuffer& bytes, int field_number) {
  uint64_t last = 0;
  ForEachField(bytes, [&](uint32_t tag, pb::io::CodedInputStream& stream) {
    if (tag == WireFormatLite::MakeTag(field_number, WireFormatLite::WIRETYPE_VARINT)) {
      return stream.ReadVarint64(&last);
    }
    return WireFormatLite::SkipField(&stream, tag);
  });
  return last;
}

grpc::ByteBuffer Serialize(const pb::Message& message) {
  grpc::ByteBuffer bytes;
  bool own_buffer = false;
  const grpc::Status status =
      grpc::SerializationTraits<pb::Message>::Serialize(message, &bytes, &own_buffer);
  LT_CHECK(status.ok());
  return bytes;
}

grpc::Status Finished(const absl::Status& status, const CallInfo& info,
                      grpc::CallbackServerContext* context) {
  if (!status.ok()) context->AddTrailingMetadata(kRequestIdKey, info.request_id);
  if (absl::IsResourceExhausted(status)) {
    const auto delay_ms = RetryAfter(status);
    context->AddTrailingMetadata(kRetryPushbackKey,
                                 absl::StrCat(delay_ms ? delay_ms->count() : -1));
  }
  return ToGrpc(status);
}

}  // namespace linetree
