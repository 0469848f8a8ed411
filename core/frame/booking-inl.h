// What a packet's lights cost with surface trees and without, counted for the plan.
#if defined(LINETREE_CORE_FRAME_BOOKING_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_FRAME_BOOKING_INL_H_
#undef LINETREE_CORE_FRAME_BOOKING_INL_H_
#else
#define LINETREE_CORE_FRAME_BOOKING_INL_H_
#endif

#include <algorithm>
#include <bit>

#include "core/frame/booked_packets.h"
#include "core/frame/frame_plan.h"
#include "core/packet/follow-inl.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// Of one packet at a time: Begin, for every face a Visit and what is found there, Close.
class Booking {
 public:
  // `sums`: whether sums of diffuse light may be used.
  HWY_INLINE Booking(const PacketScene& scene, FramePlan& plan, bool sums)
      : scene_(scene), plan_(plan), sums_(sums) {}
  HWY_INLINE ~Booking() {}

  // Adds to `sum` and `done` what the classical tracer does, for the sake of counting it.
  void Begin(const PathPacket& packet, const PacketHits& hits, const HitPoints& at,
             const LaneMaterials& materials, LaneMask lanes, LightSum& sum,
             PacketWorkspace& workspace, PacketCounts& done) {
    lanes_ = lanes;
    visits_ = 0;
    SearchedLights searched(scene_, false, workspace, done);
    searched.Add(packet, hits, at, materials, lanes, sum);
    const uint64_t searches = done.shadow_packets * kShadowWork + done.shadow_tests * kTestWork;
    search_work_ = static_cast<uint32_t>(searches / std::max<uint64_t>(done.shadow_packets, 1));
    classical_ = static_cast<uint32_t>(scene_.lights().size() * kLightWork + searches);
  }
  // What Begin has counted, and the same for a packet of which it is known.
  void Note(const PathPacket& packet, const PacketHits& hits, BookedPacket& note) const {
    note.hits = hits;
    note.lanes = lanes_;
    note.active = packet.rays.active;
    note.is_tile = packet.is_tile;
    note.classical = classical_;
    note.search = search_work_;
  }
  void BeginAgain(const BookedPacket& packet) {
    lanes_ = packet.lanes;
    visits_ = 0;
    classical_ = packet.classical;
    search_work_ = packet.search;
  }

  // Lanes on one face. `is_sheet`: when they are not booked, they may be evaluated as a sheet.
  void Visit(int32_t object, LaneMask lanes, bool is_sheet) {
    visit_[visits_++] = {static_cast<size_t>(object), lanes, 0, 0, is_sheet};
  }
  // Of the last visit: it finds no tree; it finds the hits' places; it comes to a cell, which is
  // built or not.
  void AddUnknown() {
    Seen& visit = visit_[visits_ - 1];
    visit.work = (visit.is_sheet ? 0 : kPlaneWork) + WorkIn(nullptr, visit.is_sheet);
  }
  void AddPlaces(bool on_plane) {
    Seen& visit = visit_[visits_ - 1];
    visit.lookup = on_plane ? kPlaneWork : kCurveWork;
    visit.work = visit.is_sheet ? 0 : visit.lookup;
  }
  void AddCell(const CellLights* known) {
    Seen& visit = visit_[visits_ - 1];
    visit.work += WorkIn(known, visit.is_sheet);
    visit.lookup += kCellWork + (visit.is_sheet ? kSheetWork : 0);
  }

  // `known`: all lanes lie in cells that are built.
  void Close(bool known) {
    const auto all = static_cast<uint32_t>(std::popcount(lanes_));
    int skipped = 0, pay = 0;
    for (int i = 0; i < visits_; ++i) {
      skipped += plan_.Skips(visit_[i].object) ? 1 : 0;
      pay += plan_.Pays(visit_[i].object) ? 1 : 0;
    }
    for (int i = 0; i < visits_; ++i) {
      const Seen& visit = visit_[i];
      PacketWork work;
      work.points = static_cast<uint32_t>(std::popcount(visit.lanes));
      work.classical = classical_ * work.points / all;
      // Who shares a packet with lanes that are searched for saves nothing.
      const bool is_alone = skipped == (plan_.Skips(visit.object) ? 1 : 0);
      work.asked = is_alone ? visit.work : std::max(visit.work, work.classical);
      work.known = known;
      // With others that are not asked it is not asked either.
      const bool others_pay = pay + (plan_.Pays(visit.object) ? 0 : 1) == visits_;
      work.spent = !others_pay ? work.classical
                   : known     ? visit.work
                               : work.classical + visit.lookup;
      plan_.Book(visit.object, work);
    }
  }

 private:
  struct Seen {
    size_t object;
    LaneMask lanes;
    uint32_t work;    // once its cells are built
    uint32_t lookup;  // what it takes to find that they are not
    bool is_sheet;
  };

  // What a packet in a cell costs; in one that is not built yet, at least.
  uint32_t WorkIn(const CellLights* known, bool is_sheet) const {
    const size_t lights = scene_.lights().size();
    if (known == nullptr) {
      return is_sheet ? kSheetWork + SheetWorkOfUnknown(lights) : kCellWork + WorkOfUnknown(lights);
    }
    const auto leaves_open = [&](const LightTask& task) {
      return task.kind == LightTask::Kind::kUnknown ||
             (task.kind == LightTask::Kind::kListed && known->functions.empty());
    };
    if (is_sheet && std::none_of(known->tasks.begin(), known->tasks.end(), leaves_open)) {
      return kSheetWork + known->rest_of_tasks * kSheetLightWork;
    }
    uint32_t work = kCellWork + (is_sheet ? kSheetWork + kPlaneWork : 0);
    work += known->sums[0] || known->sums[1] ? kSumWork : 0;
    for (const LightTask& task : known->tasks) {
      if (task.kind == LightTask::Kind::kSummed && sums_) continue;
      work += kLightWork;
      if (task.kind == LightTask::Kind::kListed) work += kListWork + task.count * kCandidateWork;
      if (task.kind == LightTask::Kind::kUnknown) work += search_work_;
    }
    return work;
  }

  const PacketScene& scene_;
  FramePlan& plan_;
  const bool sums_;
  LaneMask lanes_ = 0;
  uint32_t classical_ = 0;
  uint32_t search_work_ = 0;  // of one light, without trees
  Seen visit_[kPacketLanes];
  int visits_ = 0;
};

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
