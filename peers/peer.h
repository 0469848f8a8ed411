// Ray tracers that render the same view for the sake of comparison, behind one small interface.
//
// To add one: derive from Peer, and name it in AllPeers (peers.cpp).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "core/scene/scene.h"
#include "core/trace/tracer.h"

namespace linetree {

// What a peer is made for. Building its own structures for the scene is not timed.
struct PeerSetup {
  std::shared_ptr<const Scene> scene;
  PathLimits limits;
  int threads = 1;  // at least 1
};

struct PeerPicture {
  double seconds = 0;           // of what Peer::Timed says
  std::vector<float> radiance;  // 3 * width * height, linear RGB, rows from the top
  // What the picture shows otherwise than the classical tracer's on purpose, each in words.
  std::vector<std::string> differences;
};

class Peer {
 public:
  virtual ~Peer() = default;
  // Of the program or library behind it.
  virtual std::string Version() const = 0;
  // What the seconds of a picture are, in a few words.
  virtual std::string Timed() const = 0;
  // Renders the setup's scene with the setup's threads. An error says what failed, with the last
  // lines that a program wrote.
  virtual absl::StatusOr<PeerPicture> Render(const Camera& camera, int width, int height) = 0;
};

struct PeerKind {
  std::string name;
  // UNAVAILABLE where the peer is not installed, naming the package that has it; UNIMPLEMENTED
  // where it cannot render the scene.
  std::function<absl::StatusOr<std::unique_ptr<Peer>>(const PeerSetup&)> make;
};

// The classical tracer first: the picture that the others are compared with.
std::vector<PeerKind> AllPeers();

}  // namespace linetree
