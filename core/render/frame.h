// A rendered picture with its layers and counters: plain values.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/render/pixel_layer.h"
#include "core/scene/camera.h"
#include "core/scene/pixel_samples.h"
#include "core/scene/scene.h"
#include "core/trace/counts.h"
#include "core/tree/verdict.h"

namespace linetree {

// Where an answer came from. Values are those of the wire format.
enum class Source : uint8_t {
  kBackground = 0,
  kInterpolated = 1,
  kTraced = 2,    // without any help of the cache
  kReplayed = 3,  // evaluated anew, without any search of the scene but for the eye ray's hit
  kResidual = 4,  // evaluated anew, with some searches saved
};
inline constexpr int kSourceCount = 5;

// Counters of one frame or batch. interpolated + traced + background == pixels.
struct FrameStats {
  uint64_t pixels = 0;  // answers: where a pixel has several samples, each counts as one
  uint64_t interpolated = 0;
  uint64_t traced = 0;    // the three sources that are evaluated anew
  uint64_t replayed = 0;  // of these: see Source
  uint64_t residual = 0;  // of these
  uint64_t background = 0;
  RayCounts base;                                  // to answer (eye rays included)
  RayCounts ip;                                    // to build interpolants
  std::array<uint64_t, kVerdictCount> verdicts{};  // pixels by verdict
  uint64_t cells_tried = 0;
  uint64_t cells_accepted = 0;
  uint64_t cells_unkept = 0;  // that found no room; the host's own, which no reply tells
  uint64_t cells_evicted = 0;
  uint64_t cache_bytes = 0;  // after the frame
  double wall_ms = 0;
  double cpu_ms = 0;  // summed over the threads that worked on it

  // Sums counters and times; cache_bytes is taken from `o`.
  FrameStats& operator+=(const FrameStats& o);
};

// Of wall_ms, in frames by packets (0 in others): what a cached frame spends on learning.
struct FrameStages {
  double probe_ms = 0;  // first blocks, of which some packets are booked, and booking those again
  double learn_ms = 0;  // cells certified
};

// Where a server's time for a frame went: FrameTiming in service.proto.
struct FrameTiming {
  double queue_ms = 0;
  double render_ms = 0;
  double encode_ms = 0;
};

// Row-major, row 0 on top. Where a pixel has several samples, its radiance is their mean
// (sample_mean.h), and its other layers are those of one of them (ShownSample).
struct Frame {
  int width = 0;
  int height = 0;
  PixelLayer<float> radiance;  // 3 * width * height, linear RGB
  PixelLayer<int32_t> object;  // index of the object seen, -1 for the background
  PixelLayer<Source> source;
  PixelLayer<Verdict> verdict;
  // Distance from the eye, infinity for the background; by packets above epsilon 0 within 2^-20 of
  // it.
  PixelLayer<float> depth;
  Camera camera;
  Sampling sampling;
  double max_relative_error = 0;
  // What arithmetic in float may add to that (PacketRadianceRounding); 0 for frames in double.
  double lane_rounding = 0;
  double white = 1;  // Scene::white: what a picture shows as white
  SceneVersion scene_version;
  FrameStats stats;
  FrameStages stages;
  // Of frames that a server has sent; else 0.
  FrameTiming timing;
  uint64_t wire_bytes = 0;  // of its messages
  // The file, where it was asked for as one (FrameCodec); as a picture it has no radiance.
  std::string file{};
};

}  // namespace linetree
