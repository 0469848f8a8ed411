// The same view by several peers, in turn, with what it took and how the pictures differ.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "peers/peer.h"
#include "peers/picture_difference.h"

namespace linetree {

struct PeerStudyOptions {
  Camera camera;
  int width = 512, height = 512;
  int repeats = 5;
  std::vector<int> thread_counts = {1};  // each peer once with each of them
  PathLimits limits;
};

struct PeerRow {
  std::string peer;
  int threads = 1;
  std::string version, timed;
  // OK, or why there is no picture; what follows is then empty.
  absl::Status status;
  std::vector<double> seconds;  // of every repetition, in their order
  std::vector<float> radiance;  // of the last one
  std::vector<std::string> differences;
  PictureDifference difference;  // from the first row's picture

  // Whether the peer was there and could render the scene, but failed.
  bool Failed() const;
};

// Nanoseconds a pixel: median, fastest and slowest.
struct PixelTime {
  double median_ns = 0, min_ns = 0, max_ns = 0;
};
PixelTime PixelTimeOf(const std::vector<double>& seconds, int width, int height);

// Renders repeats times, every time with one peer after the other, so that whatever else the
// machine does hits all of them. A peer that fails is not asked again. One row for each peer and
// thread count, in that order; the first of `kinds` is the reference. `progress` takes the share
// done.
std::vector<PeerRow> StudyPeers(const std::vector<PeerKind>& kinds,
                                const std::shared_ptr<const Scene>& scene,
                                const PeerStudyOptions& options,
                                const std::function<void(double)>& progress);

}  // namespace linetree
