// Sixteen rays that are traced together, and what they meet: plain arrays, one entry for every
// lane.
//
// Masks hold one bit for every lane, lane 0 the lowest. What arrays hold in lanes outside the mask
// that goes with them is not specified.
#pragma once

#include <cstdint>

#include "core/trace/counts.h"
#include "core/trace/hit.h"

namespace linetree {

inline constexpr int kPacketLanes = 16;
using LaneMask = uint32_t;
inline constexpr LaneMask kAllLanes = 0xffff;

// World coordinates, one array for each axis.
struct alignas(64) PacketVectors {
  double x[kPacketLanes], y[kPacketLanes], z[kPacketLanes];

  Vec3d At(int lane) const { return {x[lane], y[lane], z[lane]}; }
  void Set(int lane, const Vec3d& v) {
    x[lane] = v.x;
    y[lane] = v.y;
    z[lane] = v.z;
  }
};

struct alignas(64) PacketRays {
  PacketVectors origin;
  PacketVectors direction;  // unit length
  // RayStart of every lane; kNoObject where the ray starts anywhere.
  int32_t start_object[kPacketLanes];
  int32_t start_face[kPacketLanes];
  LaneMask start_inside = 0;  // lanes that leave into Side::kInside
  LaneMask active = 0;

  RayStart StartAt(int lane) const {
    return {start_object[lane], start_face[lane],
            (start_inside >> lane & 1) != 0 ? Side::kInside : Side::kOutside};
  }
  void SetRay(int lane, const Vec3d& from, const Vec3d& along, const RayStart& start) {
    origin.Set(lane, from);
    direction.Set(lane, along);
    start_object[lane] = start.object;
    start_face[lane] = start.face;
    const LaneMask bit = LaneMask{1} << lane;
    start_inside = start.side == Side::kInside ? start_inside | bit : start_inside & ~bit;
    active |= bit;
  }
};

// Bit by bit what Tracer::Intersect returns for the same rays.
struct alignas(64) PacketHits {
  int32_t object[kPacketLanes];  // kNoObject where nothing is met
  int32_t face[kPacketLanes];
  double t[kPacketLanes];
  PacketVectors point;
  PacketVectors normal;
  LaneMask hit = 0;            // lanes that meet something
  LaneMask inside = 0;         // of these: Side::kInside
  LaneMask first_on_line = 0;  // of these

  Hit At(int lane) const {
    Hit h;
    if ((hit >> lane & 1) == 0) return h;
    h.object = object[lane];
    h.face = face[lane];
    h.side = (inside >> lane & 1) != 0 ? Side::kInside : Side::kOutside;
    h.first_on_line = (first_on_line >> lane & 1) != 0;
    h.t = t[lane];
    h.point = point.At(lane);
    h.normal = normal.At(lane);
    return h;
  }
  void Set(int lane, const Hit& h) {
    const LaneMask bit = LaneMask{1} << lane;
    const auto put = [bit](LaneMask& mask, bool on) { mask = on ? mask | bit : mask & ~bit; };
    object[lane] = h.object;
    face[lane] = h.face;
    t[lane] = h.t;
    point.Set(lane, h.point);
    normal.Set(lane, h.normal);
    put(hit, h.IsHit());
    put(inside, h.IsHit() && h.side == Side::kInside);
    put(first_on_line, h.IsHit() && h.first_on_line);
  }
};

// One light as seen from the hits of a packet.
struct alignas(64) PacketShadow {
  LaneMask facing = 0;    // n.l > 0
  LaneMask lit = 0;       // of these: nothing opaque in between
  LaneMask filtered = 0;  // of these: transparent surfaces in between, see `filter`
  // Product of their coefficients, per channel; only in the lanes of `filtered`.
  alignas(64) float filter[3][kPacketLanes];
};

// Linear RGB.
struct alignas(64) PacketRgb {
  float r[kPacketLanes], g[kPacketLanes], b[kPacketLanes];
};

struct PacketCounts {
  RayCounts rays;               // as the scalar tracer counts
  uint64_t packets = 0;         // searched for hits
  uint64_t seen = 0;            // eye rays that were not searched for: see sight-inl.h
  uint64_t on_sheets = 0;       // eye rays whose hits were not computed: Lights::EvaluateSheet
  uint64_t hits_again = 0;      // rays whose hit was decided again in double
  uint64_t shadow_packets = 0;  // one for every light and packet with a lane that faces it
  uint64_t shadow_tests = 0;    // of nodes and shapes, by those
  uint64_t shadows_again = 0;   // shadow rays decided again in double
  uint64_t facing_again = 0;    // lights that lie close to the horizon, looked at again

  PacketCounts& operator+=(const PacketCounts& o) {
    rays += o.rays;
    packets += o.packets;
    seen += o.seen;
    on_sheets += o.on_sheets;
    hits_again += o.hits_again;
    shadow_packets += o.shadow_packets;
    shadow_tests += o.shadow_tests;
    shadows_again += o.shadows_again;
    facing_again += o.facing_again;
    return *this;
  }
};

}  // namespace linetree
