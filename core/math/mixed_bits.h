// Hashing of numbers to numbers.
#pragma once

#include <cstdint>

namespace linetree {

// splitmix64's finaliser: spreads 64 bits over 64 bits, one to one.
inline uint64_t MixedBits(uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

}  // namespace linetree
