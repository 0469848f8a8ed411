// When items are used again, learnt from when they were: in frames, by classes of items.
//
// Of spells between two uses, those that ended are counted by their gap, those that are still open
// by the age that they have reached; together they give the chance that a spell of some age ends in
// the next frame (Kaplan, Meier, 1958), whether or not the item was kept. Classes with few spells
// lean on all others.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

namespace linetree {

class ReuseTimes {
 public:
  // Ages are exact up to kExactAges frames, and four to an octave from there on.
  static constexpr uint32_t kExactAges = 16;
  static constexpr size_t kAges = 64;
  static size_t BinOf(uint32_t age) {
    if (age <= kExactAges) return age == 0 ? 0 : age - 1;
    const auto octave = static_cast<uint32_t>(std::bit_width(age) - 1);  // 4 or more
    const size_t bin = kExactAges + 4 * (octave - 4) + ((age >> (octave - 2)) & 3);
    return std::min(bin, kAges - 1);
  }

  explicit ReuseTimes(size_t classes)
      : ended_(classes), open_(classes), worth_(classes), fresh_(classes) {}

  void Ended(size_t kind, uint32_t gap) {
    ended_[kind][BinOf(gap)] += 1;
    ++ended_count_;
  }
  // Between Begin and Learn: the spells that are open now. What has ended fades away beside them.
  void Begin(size_t items) {
    if (ended_count_ > kMemory * static_cast<double>(items + kAges)) {
      for (Bins& bins : ended_) {
        for (double& count : bins) count *= 0.5;
      }
      ended_count_ *= 0.5;
    }
    for (Bins& bins : open_) bins.fill(0);
  }
  void Open(size_t kind, uint32_t age) { open_[kind][BinOf(age)] += 1; }
  void Learn();

  // The most uses in a frame that an item of this class and age promises, over the time that makes
  // the best of it: the index of Gittins (1979), by which keeping the best is optimal. At an age of
  // 0 it has been used in this frame and cannot be before the next; at 1 it may still be in this
  // one.
  double UsesPerFrame(size_t kind, uint32_t age) const {
    return age == 0 ? fresh_[kind] : worth_[kind][BinOf(age)];
  }
  uint64_t ByteSize() const { return 3 * ended_.capacity() * sizeof(Bins); }
  // Nine of ten spells that ended were not longer.
  uint32_t usual_gap() const { return usual_gap_; }

 private:
  using Bins = std::array<double, kAges>;
  static constexpr double kMemory = 16;  // ended spells for each item
  static constexpr double kLeanOn = 30;  // spells of all classes that a class counts beside its own

  static uint32_t FirstAge(size_t bin);
  static double Index(const Bins& hazard, size_t from, double wait);

  std::vector<Bins> ended_, open_, worth_;
  std::vector<double> fresh_;  // at age 0
  double ended_count_ = 0;
  uint32_t usual_gap_ = 1;
};

}  // namespace linetree
