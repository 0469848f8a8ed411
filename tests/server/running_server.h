// A server in this process on a free port, with one small scene, and a client of it.
#pragma once

#include <gmock/gmock.h>
#include <google/protobuf/text_format.h>
#include <grpcpp/create_channel.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "client/library/client.h"
#include "core/io/load_scene.h"
#include "core/math/check.h"
#include "linetree/v1/service.grpc.pb.h"
#include "server/server.h"

namespace linetree::test {

inline constexpr char kBallText[] = R"(
  name: "ball"
  background { r: 0.1 g: 0.2 b: 0.3 }
  ambient { r: 0.2 g: 0.2 b: 0.2 }
  materials { name: "matte" ambient { r: 0.5 g: 0.5 b: 0.5 } diffuse { r: 0.6 g: 0.5 b: 0.3 } }
  materials { name: "mirror" diffuse { r: 0.1 g: 0.1 b: 0.1 } reflect { r: 0.7 g: 0.7 b: 0.7 } }
  lights { name: "lamp" point { position { x: 4 y: 8 z: 6 } } }
  objects { name: "ball" material: "mirror" sphere { center { y: 1 } radius: 1 } }
  objects { name: "floor" material: "matte" polygon {
    vertices { x: -5 z: -5 } vertices { x: -5 z: 5 } vertices { x: 5 z: 5 } vertices { x: 5 z: -5 } } }
  cameras { name: "front" eye { y: 3 z: 8 } look_at { y: 1 } }
  cameras { name: "left" eye { x: -7 y: 2 z: 3 } look_at { y: 1 } }
)";

inline v1::Scene BallScene() {
  v1::Scene scene;
  LT_CHECK(google::protobuf::TextFormat::ParseFromString(kBallText, &scene));
  return scene;
}

inline std::shared_ptr<const Scene> BuiltBallScene() {
  auto scene = BuildScene(*SceneFromMessage(BallScene()));
  LT_CHECK(scene.ok());
  return *scene;
}

class RunningServer {
 public:
  // Listens on a free port whatever the options say. `client` is how client() connects.
  explicit RunningServer(
      ServerOptions options = {},
      std::shared_ptr<spdlog::logger> log = std::make_shared<spdlog::logger>("no sinks"),
      const ClientOptions& client = {}) {
    options.listen = "127.0.0.1:0";
    options.threads = 2;
    auto server = Server::Start(options, std::move(log));
    LT_CHECK(server.ok());
    server_ = *std::move(server);
    client_ = NewClient(client);
    LT_CHECK(client_->LoadScene("ball", BallScene(), /*replace=*/false).ok());
    channel_ = grpc::CreateChannel(server_->address(), grpc::InsecureChannelCredentials());
    stub_ = v1::RadianceCache::NewStub(channel_);
  }

  std::unique_ptr<Client> NewClient(const ClientOptions& options = {}) const {
    auto client = Client::Connect(server_->address(), options);
    LT_CHECK(client.ok());
    return *std::move(client);
  }

  Server& server() { return *server_; }
  Client& client() { return *client_; }
  // For what a well-behaved client would not send.
  v1::RadianceCache::Stub& stub() { return *stub_; }
  const std::shared_ptr<grpc::Channel>& channel() { return channel_; }

  // That the server goes on serving.
  void ExpectServing() {
    FrameRequest request;
    request.width = request.height = 16;
    const auto frame = client_->RenderFrame("ball", request, "front", {}, nullptr);
    EXPECT_TRUE(frame.ok()) << frame.status();
  }

 private:
  std::unique_ptr<Server> server_;
  std::unique_ptr<Client> client_;
  std::shared_ptr<grpc::Channel> channel_;
  std::unique_ptr<v1::RadianceCache::Stub> stub_;
};

// A request that is fine.
inline v1::RenderFrameRequest SmallFrame(uint32_t width = 16, uint32_t height = 16) {
  v1::RenderFrameRequest request;
  request.set_scene("ball");
  request.set_width(width);
  request.set_height(height);
  return request;
}

// Takes seconds to render: whatever ends it early shows.
inline v1::RenderFrameRequest EndlessFrame() {
  v1::RenderFrameRequest request = SmallFrame(4000, 4000);
  request.mutable_options()->set_mode(v1::CLASSICAL);
  request.mutable_options()->set_max_depth(16);
  request.mutable_options()->set_min_weight(0);
  return request;
}

}  // namespace linetree::test
