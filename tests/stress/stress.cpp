#include "tests/stress/stress.h"

#include <cstdio>
#include <cstdlib>
#include <functional>
#include <utility>

namespace linetree::stress {
namespace {

uint64_t ReadSeed() {
  const char* text = std::getenv("LINETREE_STRESS_SEED");
  const uint64_t seed = text != nullptr ? std::strtoull(text, nullptr, 10) : kDefaultSeed;
  std::printf("LINETREE_STRESS_SEED=%llu%s\n", static_cast<unsigned long long>(seed),
              IsLong() ? ", long form" : "");
  return seed;
}

// FNV-1a: the same on every machine.
uint64_t HashOf(const std::string& text) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

}  // namespace

uint64_t Seed() {
  static const uint64_t seed = ReadSeed();
  return seed;
}

bool IsLong() {
  const char* text = std::getenv("LINETREE_STRESS_LONG");
  return text != nullptr && std::string(text) != "0" && std::string(text) != "";
}

test::Random RandomFor(const std::string& name) { return test::Random(Seed() ^ HashOf(name)); }

Largest::Largest(std::string name, double bound, std::string unit)
    : name_(std::move(name)), bound_(bound), unit_(std::move(unit)) {
  Seed();
}

Largest::~Largest() {
  std::printf("%-44s largest error %.3g, bound %.3g%s%s, %llu cases\n", name_.c_str(), error_,
              bound_, unit_.empty() ? "" : " ", unit_.c_str(),
              static_cast<unsigned long long>(count_));
}

bool Largest::Add(double error) {
  ++count_;
  if (!(error <= error_)) error_ = error;  // NaN sticks
  return error <= bound_;
}

}  // namespace linetree::stress
