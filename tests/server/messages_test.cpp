#include "server/messages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "linetree/v1/service.pb.h"

namespace linetree {
namespace {

// The bytes in pieces of `piece`, as they may come from the network.
grpc::ByteBuffer InPieces(const std::string& bytes, size_t piece) {
  std::vector<grpc::Slice> slices;
  for (size_t i = 0; i < bytes.size(); i += piece) slices.emplace_back(bytes.substr(i, piece));
  return grpc::ByteBuffer(slices.data(), slices.size());
}

v1::TraceRaysRequest ThreeRays() {
  v1::TraceRaysRequest request;
  request.set_scene("ball");
  for (int i = 0; i < 3; ++i) request.add_rays()->mutable_origin()->set_x(i + 1);
  request.mutable_options()->set_max_depth(2);
  return request;
}

TEST(MessagesTest, WhatIsSerializedIsParsedBack) {
  v1::TraceRaysRequest back;
  ASSERT_TRUE(Parse(Serialize(ThreeRays()), 1000, &back).ok());
  EXPECT_EQ(back.SerializeAsString(), ThreeRays().SerializeAsString());
}

TEST(MessagesTest, PiecesDoNotMatter) {
  const std::string bytes = ThreeRays().SerializeAsString();
  for (size_t piece = 1; piece < bytes.size(); ++piece) {
    const auto buffer = InPieces(bytes, piece);
    v1::TraceRaysRequest back;
    ASSERT_TRUE(Parse(buffer, 1000, &back).ok()) << piece;
    EXPECT_EQ(back.rays_size(), 3);
    EXPECT_EQ(CountField(buffer, v1::TraceRaysRequest::kRaysFieldNumber), 3u) << piece;
  }
}

TEST(MessagesTest, EveryHalfMessageIsInvalidOrAShorterOne) {
  const std::string bytes = ThreeRays().SerializeAsString();
  for (size_t length = 0; length < bytes.size(); ++length) {
    v1::TraceRaysRequest back;
    const auto status = Parse(InPieces(bytes.substr(0, length), 7), 1000, &back);
    EXPECT_TRUE(status.ok() || absl::IsInvalidArgument(status));
    EXPECT_LE(CountField(InPieces(bytes.substr(0, length), 7), 2), 3u);
  }
}

TEST(MessagesTest, MessagesAreCountedAtEveryDepth) {
  v1::LoadSceneRequest request;
  EXPECT_EQ(CountMessages(Serialize(request), request), 1u);
  request.set_name("a name is none");
  for (int i = 0; i < 5; ++i) {
    request.mutable_scene()->add_objects()->mutable_polygon()->add_vertices()->set_x(1);
  }
  // The request, the scene, and five times an object, its polygon and a vertex.
  EXPECT_EQ(CountMessages(Serialize(request), request), 17u);
  EXPECT_EQ(CountMessages(InPieces(request.SerializeAsString(), 3), request), 17u);
  for (size_t length = 0; length < request.SerializeAsString().size(); ++length) {
    const auto half = InPieces(request.SerializeAsString().substr(0, length), 7);
    EXPECT_LE(CountMessages(half, request), 17u);
  }
}

TEST(MessagesTest, TooManyBytesAreRefusedByTheTypesName) {
  v1::TraceRaysRequest back;
  const auto status = Parse(Serialize(ThreeRays()), 10, &back);
  EXPECT_TRUE(absl::IsResourceExhausted(status));
  EXPECT_THAT(std::string(status.message()), testing::StartsWith("TraceRaysRequest:"));
}

TEST(MessagesTest, OneNumberIsReadWithoutTheRest) {
  v1::TraceRaysRequest request = ThreeRays();
  const auto priority_of = [](const grpc::ByteBuffer& bytes) {
    return LastVarint(bytes, v1::TraceRaysRequest::kPriorityFieldNumber);
  };
  EXPECT_EQ(priority_of(Serialize(request)), 0u);
  request.set_priority(v1::PRIORITY_BACKGROUND);
  const std::string bytes = request.SerializeAsString();
  for (size_t piece = 1; piece < bytes.size(); ++piece) {
    EXPECT_EQ(priority_of(InPieces(bytes, piece)), 3u) << piece;
  }
  // The last one counts, as in parsing; the number in a field of another type is none.
  request.set_priority(v1::PRIORITY_BATCH);
  EXPECT_EQ(priority_of(InPieces(bytes + request.SerializeAsString(), 5)), 2u);
  v1::TraceRaysRequest back;
  ASSERT_TRUE(back.ParseFromString(bytes + request.SerializeAsString()));
  EXPECT_EQ(back.priority(), v1::PRIORITY_BATCH);
  EXPECT_EQ(priority_of(InPieces("\x22\x01\x02", 1)), 0u);
  EXPECT_EQ(priority_of(InPieces("\x20", 1)), 0u);
}

TEST(MessagesTest, AnEmptyMessageIsOne) {
  v1::TraceRaysRequest back;
  EXPECT_TRUE(Parse(Serialize(back), 10, &back).ok());
  EXPECT_EQ(CountField(Serialize(back), 2), 0u);
}

}  // namespace
}  // namespace linetree
