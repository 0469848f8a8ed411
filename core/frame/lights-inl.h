// The lights at the hits of a packet, with what surface trees know of them in place of searches.
#if defined(LINETREE_CORE_FRAME_LIGHTS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_FRAME_LIGHTS_INL_H_
#undef LINETREE_CORE_FRAME_LIGHTS_INL_H_
#else
#define LINETREE_CORE_FRAME_LIGHTS_INL_H_
#endif

#include <algorithm>
#include <bit>
#include <cmath>

#include "core/cache/surface_cache.h"
#include "core/frame/booked_packets.h"
#include "core/frame/booking-inl.h"
#include "core/frame/frame_kernels.h"
#include "core/frame/frame_plan.h"
#include "core/frame/groups-inl.h"
#include "core/frame/listed-inl.h"
#include "core/frame/sheet-inl.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

// Lights of a Follower. `is_frame`: packets of eye rays are tiles of an image. Where work is
// booked, it is counted for the plan beside what it would be without the trees: of all packets
// under Asking::kBooked, else of those that `booked` names (null: none).
class CachedLights {
 public:
  static constexpr bool kHasSheets = true;

  HWY_INLINE CachedLights(const PacketScene& scene, const SurfaceCache::Reader& reader,
                          FramePlan& plan, Asking asking, BookedPackets* booked, bool is_frame,
                          PacketWorkspace& workspace, PacketCounts& counts)
      : scene_(scene),
        reader_(reader),
        plan_(plan),
        asking_(asking),
        booked_(booked),
        is_booked_(asking == Asking::kBooked),
        is_frame_(is_frame),
        workspace_(workspace),
        last_blockers_(workspace.LastBlockers(scene.lights().size())),
        counts_(counts),
        booking_(scene, plan, reader.epsilon() > 0),
        cells_(reader),
        sheet_(scene, reader, cells_) {
    cells_.CountUses(CountsOthers());
    // What is booked must not depend on what else this thread has done.
    if (booked != nullptr || is_booked_) std::fill_n(last_blockers_, scene.lights().size(), -1);
  }
  // Written down, because what is implicit is not compiled for this target.
  HWY_INLINE ~CachedLights() {}

  // Whether tiles of the block that see this face may be evaluated as a sheet.
  HWY_INLINE bool OpenSheet(const VisibleFace& face, const EyeRays& eye_rays,
                            const SquareBounds& block) {
    if (face.object == asked_face_.object && face.code == asked_face_.code) return has_sheet_;
    asked_face_ = face;
    const auto object = static_cast<size_t>(face.object);
    has_sheet_ = false;
    if (!(reader_.epsilon() > 0) || !Asks(object)) return false;
    const SurfaceTree* tree = reader_.TreeOf(object);
    return has_sheet_ = tree != nullptr && sheet_.Open(*tree, face, eye_rays, block);
  }
  // One of those tiles; false: it can't.
  HWY_INLINE bool EvaluateSheet(const PathPacket& packet, const Doubles& across, const Doubles& up,
                                Floats radiance[3], Floats& depth) {
    LaneUses uses;
    const LaneMask lanes = packet.rays.active;
    if (booked_ != nullptr && IsBookedTile(packet)) return false;
    if (!sheet_.Evaluate(across, up, lanes, radiance, depth, uses)) return false;
    MarkUses(packet, uses, workspace_);
    const auto pixels = static_cast<uint64_t>(std::popcount(lanes));
    counts_.rays.shade += pixels;
    counts_.rays.summed += static_cast<uint64_t>(std::popcount(uses.summed));
    return true;
  }

  void Add(const PathPacket& packet, const PacketHits& hits, const HitPoints& at,
           const LaneMaterials& materials, LaneMask lanes, LightSum& sum) {
    groups_ = 0;
    use_ = {};
    unknown_ = 0;
    for (Floats& light : summed_) light = Floats::All(0);
    next_unknown_ = 0;
    if (booked_ != nullptr) is_booked_ = IsBooked(packet);
    if (is_booked_) {
      AddBooked(packet, hits, at, materials, lanes, sum);
    } else if (!is_frame_ || !SkipsAny(hits, lanes)) {
      Collect(SetOf(packet), hits, lanes, &materials);
    } else {
      unknown_ = lanes;
    }
    if (IsSearched(lanes)) {
      use_ = {lanes, 0, 0};
      if (!is_booked_) {
        SearchedLights(scene_, false, workspace_, counts_)
            .Add(packet, hits, at, materials, lanes, sum);
      }
    } else {
      use_.searched |= unknown_;
      use_.listed = lanes & ~unknown_;
      counts_.rays.summed += static_cast<uint64_t>(std::popcount(use_.summed));
      sum.AddRadiance(summed_, use_.summed);
      AddTasks(hits, at, materials, sum);
    }
    MarkUses(packet, use_, workspace_);
  }

  // Books a packet as it would be now, and counts who asks for which cells once more.
  void BookAgain(const BookedPacket& packet) {
    booking_.BeginAgain(packet);
    Collect({packet.active, packet.is_tile}, packet.hits, packet.lanes, nullptr);
    booking_.Close(unknown_ == 0);
  }

 private:
  // What makes a packet one that may be evaluated as a sheet.
  struct LaneSet {
    LaneMask active;
    bool is_tile;
  };
  static HWY_INLINE LaneSet SetOf(const PathPacket& packet) {
    return {packet.rays.active, packet.is_tile};
  }

  HWY_INLINE bool CountsOthers() const { return booked_ == nullptr || booked_->others_count; }
  HWY_INLINE bool IsBookedTile(const PathPacket& packet) const {
    return (booked_->tiles >> (packet.pixel[0] / kPacketLanes) & 1) != 0;
  }
  HWY_INLINE bool IsBooked(const PathPacket& packet) {
    return packet.is_tile ? IsBookedTile(packet) : spawned_++ % booked_->one_in == 0;
  }
  // A search costs the same for one lane and for all. But which rays share a packet is for frames
  // to say; answers of a batch don't depend on it.
  HWY_INLINE bool IsSearched(LaneMask lanes) const {
    return unknown_ == lanes || (unknown_ != 0 && is_frame_);
  }

  // Collect, and the lights where they are searched for anyway.
  HWY_NOINLINE void AddBooked(const PathPacket& packet, const PacketHits& hits, const HitPoints& at,
                              const LaneMaterials& materials, LaneMask lanes, LightSum& sum) {
    LightSum searched = sum;
    PacketCounts done;
    booking_.Begin(packet, hits, at, materials, lanes, searched, workspace_, done);
    cells_.CountUses(true);
    Collect(SetOf(packet), hits, lanes, &materials);
    cells_.CountUses(CountsOthers());
    booking_.Close(unknown_ == 0);
    if (IsSearched(lanes)) {
      sum.SetTo(searched);
      counts_ += done;
    }
    if (booked_ != nullptr) booking_.Note(packet, hits, booked_->packets.emplace_back());
  }

  // Finds the cells of the lanes, and leaves those that are in none in unknown_. Without materials
  // nothing is evaluated.
  void Collect(const LaneSet& set, const PacketHits& hits, LaneMask lanes,
               const LaneMaterials* materials) {
    const Ints objects = Ints::Load(hits.object), faces = Ints::Load(hits.face);
    // A ray inside a solid asks the solid itself too.
    unknown_ = lanes & hits.inside;
    for (LaneMask left = lanes & ~unknown_; left != 0;) {
      const int lane = std::countr_zero(left);
      const int32_t object = hits.object[lane], face = hits.face[lane];
      const LaneMask same =
          BitsOf(OfFloats((objects == Ints::All(object)) & (faces == Ints::All(face)))) & left;
      left &= ~same;
      skipped_ = plan_.Skips(static_cast<size_t>(object));
      if (!is_booked_ && !Asks(static_cast<size_t>(object))) {
        unknown_ |= same;
        continue;
      }
      if (is_booked_) booking_.Visit(object, same, MayBeSheet(set, object, face, same));
      const SurfaceTree* tree = reader_.TreeOf(static_cast<size_t>(object));
      if (tree == nullptr) {
        if (is_booked_) booking_.AddUnknown();
        unknown_ |= same;
        continue;
      }
      const FaceForm& form = tree->FormOf(face);
      if (is_booked_) booking_.AddPlaces(form.kind == FaceForm::Kind::kPlane);
      PlaceHits(form, hits, same, places_);
      // A grazing ray's normal may be turned inwards by rounding.
      const LaneMask placed = places_.on & (tree->chart().IsThin() ? kAllLanes : places_.outward);
      unknown_ |= same & ~placed;
      CollectCells(*tree, hits, placed, materials);
    }
  }

  void CollectCells(const SurfaceTree& tree, const PacketHits& hits, LaneMask lanes,
                    const LaneMaterials* materials) {
    for (LaneMask left = lanes; left != 0;) {
      OpenCells::Entry& entry = cells_.Find(tree, places_, std::countr_zero(left));
      const SurfaceNode& node = *entry.node;
      LaneMask same = LanesIn(entry) & left;
      left &= ~same;
      if (!skipped_) cells_.AddUses(entry, same);
      const CellLights* known = node.payload.get();
      if (is_booked_) booking_.AddCell(known);
      if (known == nullptr) {
        unknown_ |= same;
        continue;
      }
      for (const Contact& contact : known->contacts) {
        const Doubles height =
            Dot(Load(hits.point) - Spread(contact.plane.point), Spread(contact.plane.normal));
        const LaneMask clear = BitsOf(height > Doubles::All(contact.clearance));
        unknown_ |= same & ~clear;
        same &= clear;
      }
      if (same != 0 && (unknown_ == 0 || !is_frame_) && materials != nullptr) {
        Open(node, same, tree.chart().IsThin(), *materials);
      }
    }
  }

  // Lanes on the same patch that lie in the cell.
  HWY_INLINE LaneMask LanesIn(const OpenCells::Entry& cell) const {
    const auto index = [&](const int32_t* of, int32_t wanted) HWY_ATTR {
      Truth<int32_t> r;
      const Ints x = Ints::Load(of);
      for (size_t k = 0; k < LanesOf<int32_t>::kVectors; ++k) {
        r.v[k] = hn::Eq(hn::ShiftRightSame(x.v[k], cell.shift), hn::Set(Ints::Tag(), wanted));
      }
      return r;
    };
    const Truth<int32_t> patch = Ints::Load(places_.patch) == Ints::All(cell.patch);
    return BitsOf(OfFloats(patch & index(places_.i, cell.i) & index(places_.j, cell.j)));
  }

  void Open(const SurfaceNode& node, LaneMask lanes, bool thin, const LaneMaterials& materials) {
    CellGroup& group = group_[groups_++];
    const CellLights& known = *node.payload;
    const LightTask* tasks = known.tasks.data();
    const LightTask *rest = tasks + known.rest_of_tasks, *end = tasks + known.tasks.size();
    group = {&known, lanes, 0, tasks, rest, rest, end};
    const double scale = static_cast<double>(1u << node.cell.depth);
    const auto local = [&](const double* x, uint32_t cell, float* to) HWY_ATTR {
      const Doubles in = Doubles::Load(x) * Doubles::All(scale) - Doubles::All(cell);
      const Floats f = Demoted(Clamped(in));
      Select(MaskOf(lanes), f, Floats::Load(to)).Store(to);
      return f;
    };
    const Floats s = local(places_.u, node.cell.i, s_), t = local(places_.v, node.cell.j, t_);
    if (!(reader_.epsilon() > 0)) return;
    const LaneMask outside = thin ? lanes & places_.outward : lanes;
    AddSum(group, 0, outside, s, t, materials);
    AddSum(group, 1, lanes & ~outside, s, t, materials);
    if (group.summed == lanes && (lanes & materials.shines) == 0) {
      group.next_summed = group.end_summed;
    }
  }

  HWY_INLINE void AddSum(CellGroup& group, size_t side, LaneMask lanes, const Floats& s,
                         const Floats& t, const LaneMaterials& materials) {
    const DiffuseSum* diffuse = group.known->sums[side].get();
    if (lanes == 0 || diffuse == nullptr || !(diffuse->spread <= reader_.epsilon())) return;
    Floats light[3];
    SumAt(*diffuse, s, t, light);
    const Mask which = MaskOf(lanes);
    for (size_t c = 0; c < 3; ++c) {
      summed_[c] = Select(which, light[c] * materials.diffuse[c], summed_[c]);
    }
    group.summed |= lanes;
    use_.summed |= lanes;
  }

  // Light by light, in order, as the classical tracer sums them.
  void AddTasks(const PacketHits& hits, const HitPoints& at, const LaneMaterials& materials,
                LightSum& sum) {
    const size_t count = scene_.lights().size();
    for (;;) {
      size_t light = unknown_ != 0 ? next_unknown_ : count;
      for (int g = 0; g < groups_; ++g) light = std::min(light, group_[g].NextLight(count));
      if (light >= count) return;
      LightWork work;
      if (unknown_ != 0) {
        work.search = unknown_;
        next_unknown_ = light + 1;
      }
      for (int g = 0; g < groups_; ++g) Take(light, group_[g], materials, work);
      AddLight(light, work, hits, at, sum);
    }
  }

  HWY_INLINE void Take(size_t light, CellGroup& group, const LaneMaterials& materials,
                       LightWork& work) {
    if (group.next != group.end && group.next->light == light) {
      Take(group, *group.next++, materials, work);
    } else if (group.next_summed != group.end_summed && group.next_summed->light == light) {
      Take(group, *group.next_summed++, materials, work);
    }
  }

  HWY_INLINE void Take(const CellGroup& group, const LightTask& task,
                       const LaneMaterials& materials, LightWork& work) {
    switch (task.kind) {
      case LightTask::Kind::kOn:
        work.on |= group.lanes;
        break;
      case LightTask::Kind::kSummed:
        work.on |= group.lanes & ~group.summed;
        work.shines |= group.summed & materials.shines;
        break;
      case LightTask::Kind::kListed:
        work.listed[work.lists++] = {&group, &task};
        work.listed_lanes |= group.lanes;
        break;
      case LightTask::Kind::kUnknown:
        work.search |= group.lanes;
        use_.searched |= group.lanes;
        break;
    }
  }

  HWY_INLINE void AddLight(size_t light, const LightWork& work, const PacketHits& hits,
                           const HitPoints& at, LightSum& sum) {
    const LaneMask asked = work.on | work.shines | work.search | work.listed_lanes;
    if (asked == 0) return;
    const LaneLight seen = LightAt(scene_, light, hits, at, asked, counts_.facing_again);
    PacketShadow shadow;
    shadow.facing = seen.facing;
    shadow.lit = shadow.filtered = 0;
    if ((seen.facing & work.search) != 0) {
      LaneLight searched = seen;
      searched.facing &= work.search;
      CastAt(scene_, hits, at, searched, static_cast<int>(light), last_blockers_[light], shadow,
             counts_);
      shadow.facing = seen.facing;
    }
    const LaneMask known = seen.facing & (work.on | work.shines | work.listed_lanes);
    counts_.rays.shadow += static_cast<uint64_t>(std::popcount(known));
    counts_.rays.listed += static_cast<uint64_t>(std::popcount(known));
    shadow.lit |= seen.facing & (work.on | work.shines);
    for (int i = 0; i < work.lists; ++i) {
      const LaneMask lanes = seen.facing & work.listed[i].group->lanes;
      if (lanes == 0) continue;
      const ListedShadows listed(scene_, *work.listed[i].group->known, *work.listed[i].task);
      listed.Cast(Floats::Load(s_), Floats::Load(t_), lanes, seen, hits, at, shadow, counts_);
    }
    sum.Add(light, seen, shadow, work.shines);
  }

  HWY_INLINE bool Asks(size_t object) const {
    return plan_.Pays(object) || (asking_ == Asking::kExploring && !plan_.Skips(object));
  }
  HWY_INLINE bool SkipsAny(const PacketHits& hits, LaneMask lanes) const {
    int32_t last = kNoObject;
    for (LaneMask left = lanes; left != 0; left &= left - 1) {
      const int32_t object = hits.object[std::countr_zero(left)];
      if (object != last && !Asks(static_cast<size_t>(object))) return true;
      last = object;
    }
    return false;
  }

  // Whether these lanes of a packet, when it is not booked, may be evaluated as a sheet.
  HWY_INLINE bool MayBeSheet(const LaneSet& set, int32_t object, int face, LaneMask lanes) const {
    const auto material = static_cast<size_t>(scene_.material_of()[static_cast<size_t>(object)]);
    const PacketMaterials& table = scene_.materials();
    return is_frame_ && set.is_tile && lanes == set.active && reader_.epsilon() > 0 &&
           table.spawns[material] == 0 && table.shines[material] == 0 &&
           scene_.IsFlat(object, face);
  }

  const PacketScene& scene_;
  const SurfaceCache::Reader& reader_;
  FramePlan& plan_;
  const Asking asking_;
  BookedPackets* const booked_;
  bool is_booked_;
  const bool is_frame_;
  PacketWorkspace& workspace_;
  int32_t* const last_blockers_;
  PacketCounts& counts_;
  bool skipped_ = false;  // the object that is looked at
  uint32_t spawned_ = 0;  // packets that are not of eye rays, so far
  Booking booking_;
  Places places_;
  OpenCells cells_;
  Sheet sheet_;
  VisibleFace asked_face_;                                         // whether it
  bool has_sheet_ = false;                                         // is a sheet
  alignas(64) float s_[kPacketLanes] = {}, t_[kPacketLanes] = {};  // within the lanes' cells
  CellGroup group_[kPacketLanes];
  int groups_ = 0;
  LaneMask unknown_ = 0;     // lanes in no cell
  size_t next_unknown_ = 0;  // light for which these are searched
  Floats summed_[3];         // light of sums
  LaneUses use_;
};

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
