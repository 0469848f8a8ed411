// Which objects' surface trees are worth asking: a planner that goes by counted work, so that what
// it decides does not depend on clocks, threads or the machine.
//
// Of some packets all is counted, what the lights cost with the trees as they are, with trees that
// know every place, and without any, and booked to the objects that the packets lie on. Trees are
// asked where they pay as they are. They grow where they are to pay; there, so that they learn
// where, some packets ask them all the same. A share of the others' packets is tried, too, frame
// after frame, so that they may come back.
//
// Thread safety: every method may be called from any thread.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "core/tree/light_certifier.h"

namespace linetree {

// Work of packets, in about nanoseconds of the machine it was calibrated on (AVX-512, 2.6 GHz):
// what counts are the proportions.
inline constexpr uint32_t kLightWork = 14;   // one light: where it is and what it adds
inline constexpr uint32_t kShadowWork = 28;  // one search for what is in between, whatever it meets
inline constexpr uint32_t kTestWork = 9;     // one node or shape on the way
inline constexpr uint32_t kPlaneWork = 35;   // places of hits on a plane
inline constexpr uint32_t kCurveWork = 400;  // on a curved face
inline constexpr uint32_t kCellWork = 36;    // one cell: found, its lanes collected
inline constexpr uint32_t kSumWork = 20;     // one sum of diffuse light
inline constexpr uint32_t kListWork = 12;    // one list of candidates
inline constexpr uint32_t kCandidateWork = 8;

// A tile that is evaluated as a sheet: a cell on the way, beyond what its hits would have cost, and
// there one light that is not in the sum.
inline constexpr uint32_t kSheetWork = 25;
inline constexpr uint32_t kSheetLightWork = 10;

// What a packet is going to cost in cells that are still to be built, beside kCellWork: mostly it
// lies in more than one, six lights in ten are on and not in a sum, one in seven has a list.
inline uint32_t WorkOfUnknown(size_t lights) {
  return 45 + static_cast<uint32_t>(lights) * kLightWork;
}

// The same of a sheet: three lights in ten are not in a sum.
inline uint32_t SheetWorkOfUnknown(size_t lights) {
  return 3 * kSheetLightWork * static_cast<uint32_t>(lights) / 10;
}

// What it takes to have trees asked at all, at each shading point of a frame, those included where
// no tree pays: 2 ns a pixel in tetra_6, where next to nothing is saved.
inline constexpr double kAskWork = 2;

// What is asked of a surface cell before it is built.
struct CellTask {
  size_t lights = 0, objects = 0;  // of the scene
  bool curved = false;
  const CellLights* parent =
      nullptr;  // what is known of the cell it is a quarter of; null: none is
};
// Of a new cell: every light that is not decided costs a look at its candidates, which at first are
// what a search of the scene finds, and on curves a sum its jets. Fitted to 184,000 cells of twelve
// scenes.
inline double WorkOfCell(const CellTask& task) {
  const double search =
      500 + (task.curved ? 15.0 : 90.0) * static_cast<double>(std::min<size_t>(task.objects, 200));
  const double sum = task.curved ? 370 : 30;
  if (task.parent == nullptr) return 2000 + (search + sum) * static_cast<double>(task.lights);
  double work = task.curved ? 1500 : 600;
  for (const LightList& light : task.parent->lights) {
    if (light.knowledge == LightKnowledge::kOn) work += sum;
    if (light.IsDecided()) continue;
    const bool is_listed = light.knowledge == LightKnowledge::kListed;
    work += is_listed
                ? 250 + (task.curved ? 450.0 : 150.0) * static_cast<double>(light.candidates.size())
                : search / 2;
  }
  return work;
}

// Trees that save less than this share are left alone: counts are not that exact. Where they do so
// as they are, they are asked.
inline constexpr double kLeastSaving = 0.2;

// Of a packet's lights, in cells that are all known or not.
struct PacketWork {
  uint32_t points = 0;     // lanes
  uint32_t asked = 0;      // the trees, and what is left to do, once all cells are built
  uint32_t classical = 0;  // without trees
  uint32_t spent = 0;      // the trees as they are, and what is left to do
  bool known = true;
};

class FramePlan {
 public:
  // `always`: no tree is skipped, and every cell is worth its price.
  explicit FramePlan(size_t objects, bool always = false) : always_(always), accounts_(objects) {}

  bool always() const { return always_; }

  // Whether its trees are worth growing, and worth asking as they are.
  bool Skips(size_t object) const { return !(SavedPerPoint(object) > 0); }
  bool Pays(size_t object) const {
    return always_ || accounts_[object].pays.load(std::memory_order_relaxed);
  }
  // Work that the trees save at one shading point, as far as is known; not positive: none. Of
  // objects that have not been seen yet, what the others' save.
  double SavedPerPoint(size_t object) const {
    if (always_) return kPriceless;
    const float saved = accounts_[object].saved.load(std::memory_order_relaxed);
    return saved == kUnseen ? usual_.load(std::memory_order_relaxed) : saved;
  }

  // Work that the trees would have saved at all points that were booked of late.
  double SavedInAll(size_t object) const {
    if (always_) return kPriceless;
    return SavedPerPoint(object) * accounts_[object].points.load(std::memory_order_relaxed);
  }

  void Book(size_t object, const PacketWork& work) {
    Account& account = accounts_[object];
    booked_.fetch_add(work.classical, std::memory_order_relaxed);
    booked_points_.fetch_add(work.points, std::memory_order_relaxed);
    const int64_t gain = int64_t{work.classical} - int64_t{work.asked};
    if (work.known) {
      account.gained.fetch_add(gain, std::memory_order_relaxed);
    } else if (gain > 0) {
      promised_.fetch_add(gain, std::memory_order_relaxed);
    }
    account.points.fetch_add(work.points, std::memory_order_relaxed);
    account.asked.fetch_add(work.asked, std::memory_order_relaxed);
    account.spent.fetch_add(work.spent, std::memory_order_relaxed);
    account.classical.fetch_add(work.classical, std::memory_order_relaxed);
  }

  // The object's trees are not worth planting; until it is booked again.
  void Skip(size_t object) {
    accounts_[object].saved.store(0, std::memory_order_relaxed);
    accounts_[object].pays.store(false, std::memory_order_relaxed);
  }

  // What was booked since the last Decide: work without trees, what they save of it where they are
  // asked from now on, and what cells promise that are still to be built or are not asked.
  struct Booked {
    double classical = 0, saved = 0, promised = 0;
  };

  // Takes what was booked into account.
  Booked Decide() {
    std::lock_guard lock(decide_mutex_);
    Booked booked = {static_cast<double>(booked_.exchange(0, std::memory_order_relaxed)), 0,
                     static_cast<double>(promised_.exchange(0, std::memory_order_relaxed))};
    const auto booked_points = static_cast<double>(booked_points_.exchange(0));
    bool wants_any = false, hopes_any = false;
    uint64_t points = 0, asked = 0, classical = 0;
    for (size_t object = 0; object < accounts_.size(); ++object) {
      Account& account = accounts_[object];
      const uint32_t own_points = account.points.load(std::memory_order_relaxed);
      if (own_points == 0) continue;
      const uint32_t own_asked = account.asked.load(std::memory_order_relaxed);
      const uint32_t own_classical = account.classical.load(std::memory_order_relaxed);
      const float saved = SavedOf(own_points, own_asked, own_classical);
      account.saved.store(saved, std::memory_order_relaxed);
      const uint32_t own_spent = account.spent.load(std::memory_order_relaxed);
      const bool pays = SavedOf(own_points, own_spent, own_classical) > 0;
      account.pays.store(pays, std::memory_order_relaxed);
      const auto gained = static_cast<double>(account.gained.exchange(0));
      booked.saved += pays ? gained : 0;
      booked.promised += pays ? 0 : std::max(gained, 0.0);
      wants_any = wants_any || saved > 0;
      hopes_any = hopes_any || (saved > 0 && !pays);
      points += own_points;
      asked += own_asked;
      classical += own_classical;
      // What is old counts less and less.
      account.points.store(own_points / 2, std::memory_order_relaxed);
      account.asked.store(own_asked / 2, std::memory_order_relaxed);
      account.spent.store(own_spent / 2, std::memory_order_relaxed);
      account.classical.store(own_classical / 2, std::memory_order_relaxed);
    }
    if (points > 0) usual_ = SavedOf(points, asked, classical);
    if (points > 0) {
      wants_any_ = wants_any;
      if (booked_points > 0) pays_any_ = booked.saved > kAskWork * booked_points;
      hopes_any_ = hopes_any;
    }
    ++decisions_;
    return booked;
  }
  // Takes over what a former scene's planner knew of the objects that are still there: `now` by
  // object there, negative for those that are not. Before anybody asks.
  void Inherit(const FramePlan& former, std::span<const int32_t> now) {
    for (size_t object = 0; object < now.size(); ++object) {
      if (now[object] < 0) continue;
      accounts_[static_cast<size_t>(now[object])].Copy(former.accounts_[object]);
    }
    usual_ = former.usual_.load();
    wants_any_ = former.wants_any_.load();
    pays_any_ = former.pays_any_.load();
    hopes_any_ = former.hopes_any_.load();
    is_promising_ = former.is_promising_.load();
  }

  // Whether some object's trees are worth growing; pay as they are, together enough for trees to be
  // asked at all; are worth growing, but do not pay yet.
  bool WantsAny() const { return always_ || wants_any_; }
  bool PaysAny() const { return always_ || pays_any_; }
  bool HopesAny() const { return always_ || hopes_any_; }
  // Whether it is worth looking for what is promised before the next frame is rendered; at first it
  // is.
  bool IsPromising() const { return always_ || is_promising_; }
  void SetPromising(bool is_promising) { is_promising_ = is_promising; }
  // How often it was decided.
  uint32_t decisions() const { return decisions_; }

  // What is known of an object, as far as it still counts: older frames' work counts less.
  struct Known {
    bool decided = false;  // booked before the last Decide, or skipped by Skip
    uint32_t points = 0;
    uint32_t asked = 0, classical = 0;  // work with the trees and without, of all these points
    bool pays = false;                  // by that work alone
  };
  Known KnownOf(size_t object) const {
    const Account& account = accounts_[object];
    Known known;
    known.decided = account.saved.load(std::memory_order_relaxed) != kUnseen;
    known.points = account.points.load(std::memory_order_relaxed);
    known.asked = account.asked.load(std::memory_order_relaxed);
    known.classical = account.classical.load(std::memory_order_relaxed);
    known.pays = known.points > 0 && SavedOf(known.points, known.asked, known.classical) > 0;
    return known;
  }
  size_t objects() const { return accounts_.size(); }
  uint64_t ByteSize() const { return sizeof(FramePlan) + accounts_.capacity() * sizeof(Account); }

  size_t CountSkipped() const {
    size_t count = 0;
    for (size_t object = 0; object < accounts_.size(); ++object) count += Skips(object) ? 1 : 0;
    return count;
  }

 private:
  static constexpr float kUnseen = -1;
  static constexpr double kPriceless = 1e9;

  static float SavedOf(uint64_t points, uint64_t asked, uint64_t classical) {
    const double all = static_cast<double>(classical);
    const double saved = all - static_cast<double>(asked);
    return saved > kLeastSaving * all ? static_cast<float>(saved / static_cast<double>(points)) : 0;
  }

  struct Account {
    std::atomic<uint32_t> points{0}, asked{0}, classical{0}, spent{0};
    std::atomic<int64_t> gained{0};     // by cells that are known, since the last Decide
    std::atomic<float> saved{kUnseen};  // per point
    std::atomic<bool> pays{false};

    void Copy(const Account& other) {
      points = other.points.load();
      asked = other.asked.load();
      classical = other.classical.load();
      spent = other.spent.load();
      saved = other.saved.load();
      pays = other.pays.load();
    }
  };
  const bool always_;
  std::vector<Account> accounts_;  // by object
  std::atomic<float> usual_{1};    // saved per point, of all objects together
  std::atomic<bool> wants_any_{true}, pays_any_{false}, hopes_any_{true};
  std::atomic<bool> is_promising_{true};
  std::atomic<int64_t> booked_{0}, booked_points_{0}, promised_{0};
  std::atomic<uint32_t> decisions_{0};
  std::mutex decide_mutex_;
};

}  // namespace linetree
