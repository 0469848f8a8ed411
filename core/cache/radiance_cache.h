#pragma once
#include <cstdint>
namespace linetree {
struct CacheOptions {
  uint64_t memory_bytes = uint64_t{256} << 20;
};
class RadianceCache {};
}  // namespace linetree
