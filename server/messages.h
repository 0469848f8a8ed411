// Requests and replies as gRPC carries them. Requests reach us unparsed: gRPC answers a malformed
// one with an empty UNIMPLEMENTED, and would build ten million rays before anybody can refuse them.
#pragma once

#include <google/protobuf/message.h>
#include <grpcpp/server_context.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/status.h>

#include "absl/status/status.h"
#include "server/call_info.h"
#include "server/limits.h"

namespace linetree {

// OK, or RESOURCE_EXHAUSTED naming the type for more than max_bytes.
absl::Status CheckSize(const grpc::ByteBuffer& bytes, size_t max_bytes,
                       const google::protobuf::Message& type);

// As CheckSize, and INVALID_ARGUMENT for what is not such a message.
absl::Status Parse(const grpc::ByteBuffer& bytes, size_t max_bytes,
                   google::protobuf::Message* message);

// How often the field stands at the top level; stops early at malformed bytes.
uint64_t CountField(const grpc::ByteBuffer& bytes, int field_number);

// The number that the field, which is no repeated one, stands for at the top level: the last one,
// as in parsing; 0 when there is none. Stops early at malformed bytes.
uint64_t LastVarint(const grpc::ByteBuffer& bytes, int field_number);

// How many messages parsing would build, the whole one included: two bytes may cost a hundred.
// Stops early at malformed bytes.
uint64_t CountMessages(const grpc::ByteBuffer& bytes, const google::protobuf::Message& type);

grpc::ByteBuffer Serialize(const google::protobuf::Message& message);

// The status for Finish. What is refused also tells the caller's gRPC when to try again, or not to.
// The request id goes back in the trailing metadata of an error.
grpc::Status Finished(const absl::Status& status, const CallInfo& info,
                      grpc::CallbackServerContext* context);

}  // namespace linetree
