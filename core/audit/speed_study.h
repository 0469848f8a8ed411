// How fast the classical tracers are: the scalar and the packet tracer's frames in turn, in one
// process and one thread, so that what else the machine does meets both alike.
#pragma once

#include <cstdint>
#include <vector>

#include "core/packet/packet_tracer.h"

namespace linetree {

struct SpeedStudyOptions {
  int width = 512, height = 512;
  int repeats = 5;  // of which the median counts
  PathLimits limits;
};

// Nanoseconds per pixel.
struct SpeedSpread {
  double median = 0, least = 0, most = 0;
};

SpeedSpread SpreadOf(std::vector<double> ns);  // of at least one

struct SpeedStudy {
  size_t objects = 0, lights = 0;
  SpeedSpread scalar, packet;
  double ratio = 0;  // median of the repeats' scalar / packet
  uint64_t pixels = 0;
  uint64_t different_topology = 0;  // pixels whose ray trees are not isomorphic
  uint64_t different_counts = 0;    // 1 when the two count their rays differently
  // |packet - scalar| / max(scalar, RadianceFloor), and what PacketRadianceRounding allows.
  double largest_difference = 0, allowed_difference = 0;
  PacketCounts counts;  // of one frame
};

SpeedStudy StudySpeed(const Tracer& tracer, const PacketTracer& packets, const Camera& camera,
                      const SpeedStudyOptions& options);

}  // namespace linetree
