// What a thread needs to trace packets and keeps from one packet to the next. It never changes a
// result. Not thread safe: one for every thread.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "core/packet/packet.h"

namespace linetree {

// Sixteen rays anywhere on their paths.
struct alignas(64) PathPacket {
  PacketRays rays;
  double weight[kPacketLanes];        // product of the largest coefficients on the way
  float throughput[3][kPacketLanes];  // product of the coefficients on the way
  int32_t pixel[kPacketLanes];        // of the block that is being traced
  uint32_t path[kPacketLanes];        // see TopologyDigest
  bool is_tile = false;               // lane i's pixel is number pixel[0] + i
};

// What was done for a pixel, anywhere on its paths.
enum PixelUse : uint8_t {
  kSearched = 1,  // the scene was searched, other than for the eye ray's hit
  kListed = 2,    // a search was spared
  kSummed = 4,    // diffuse light came from a sum
  kMissed = 8,    // the eye ray hits nothing
};
inline constexpr int kPixelUses = 16;  // combinations

// Sides of the blocks of pixels whose secondary rays are collected into packets.
inline constexpr int kBlockSide = 32;
inline constexpr int kBlockPixels = kBlockSide * kBlockSide;

class PacketWorkspace {
 public:
  PacketWorkspace() : sums_(std::make_unique<Sums>()) {}

  // Per light, the shape that was in between last; -1: none yet.
  int32_t* LastBlockers(size_t lights) {
    if (last_blocker_.size() != lights) last_blocker_.assign(lights, -1);
    return last_blocker_.data();
  }

  // Rays of the next leg: reflected ones, and transmitted ones.
  struct Queue {
    std::vector<PathPacket> packets;
    int lanes = kPacketLanes;  // of the last packet that are taken

    void Clear() {
      packets.clear();
      lanes = kPacketLanes;
    }
    // The packet whose lane `lanes` is free.
    PathPacket& Room() {
      if (lanes == kPacketLanes) {
        packets.emplace_back();
        packets.back().rays.active = packets.back().rays.start_inside = 0;
        lanes = 0;
      }
      return packets.back();
    }
  };
  Queue& queue(int level, int branch) { return queues_[level][branch]; }

  // Sums of the block, by pixel: kBlockPixels for each channel.
  float* radiance() { return sums_->radiance; }
  uint64_t* digest() { return sums_->digest; }
  // Of the last block, kPacketLanes for every tile.
  uint8_t* uses() { return sums_->uses; }

 private:
  std::vector<int32_t> last_blocker_;
  Queue queues_[2][2];
  struct alignas(64) Sums {
    float radiance[3 * kBlockPixels] = {};
    uint64_t digest[kBlockPixels] = {};
    uint8_t uses[kBlockPixels] = {};  // PixelUse
  };
  std::unique_ptr<Sums> sums_;
};

}  // namespace linetree
