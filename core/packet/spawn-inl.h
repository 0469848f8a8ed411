// Reflected and transmitted rays, in double: the operations of PathTracer (core/trace/path.cpp) in
// their order.
#if defined(LINETREE_CORE_PACKET_SPAWN_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_PACKET_SPAWN_INL_H_
#undef LINETREE_CORE_PACKET_SPAWN_INL_H_
#else
#define LINETREE_CORE_PACKET_SPAWN_INL_H_
#endif

#include <bit>

#include "core/packet/lanes-inl.h"
#include "core/packet/packet_scene.h"
#include "core/packet/packet_workspace.h"
#include "core/packet/topology.h"

HWY_BEFORE_NAMESPACE();
namespace linetree::HWY_NAMESPACE {

class Spawner {
 public:
  HWY_INLINE Spawner(const PacketScene& scene, const PathLimits& limits, PacketWorkspace& workspace,
                     PacketCounts& counts)
      : scene_(scene), limits_(limits), workspace_(workspace), counts_(counts) {}

  // The rays go to the queues of level depth mod 2, in the order of their lanes: how the rays of
  // one pixel follow each other, and so how their light is summed, must not depend on other
  // pixels'. Sets the lanes that reflect totally.
  void Spawn(const PathPacket& packet, const PacketHits& hits, int depth, LaneMask& total) {
    if (depth >= limits_.max_depth) return;
    level_ = depth % 2;
    reflected_.lanes = transmitted_.lanes = transmitted_into_ = 0;
    for (LaneMask left = hits.hit; left != 0;) {
      const int32_t object = hits.object[std::countr_zero(left)];
      const LaneMask same = BitsOf(Ints::Load(hits.object) == Ints::All(object)) & left;
      left &= ~same;
      if (scene_.materials()
              .spawns[static_cast<size_t>(scene_.material_of()[static_cast<size_t>(object)])] !=
          0) {
        SpawnFrom(packet, hits, object, same, total);
      }
    }
    Append(packet, hits, reflected_, Branch::kReflected, hits.inside);
    Append(packet, hits, transmitted_, Branch::kTransmitted, transmitted_into_);
  }

 private:
  // The rays of one branch.
  struct Leg {
    LaneMask lanes = 0;
    PacketVectors direction;
    const Rgb* coefficient[kPacketLanes];

    void Add(const WideVectors& along, LaneMask more, const Rgb& k) {
      if (more == 0) return;
      Store(lanes == 0 ? along : Select(TruthOf<double>(more), along, Load(direction)), direction);
      lanes |= more;
      for (; more != 0; more &= more - 1) coefficient[std::countr_zero(more)] = &k;
    }
  };

  // Lanes whose branch with coefficient k is cast: PathLimits::Allow.
  HWY_INLINE LaneMask Allowed(const PathPacket& packet, const Rgb& k, LaneMask lanes) const {
    if (IsBlack(k)) return 0;
    const Doubles weight = Doubles::Load(packet.weight) * Doubles::All(MaxChannel(k));
    return BitsOf(weight >= Doubles::All(limits_.min_weight)) & lanes;
  }

  void SpawnFrom(const PathPacket& packet, const PacketHits& hits, int32_t object, LaneMask lanes,
                 LaneMask& total) {
    const Material& material = scene_.scene().MaterialOf(object);
    const Shape& shape = scene_.scene().objects[static_cast<size_t>(object)].shape;
    const WideVectors d = Load(packet.rays.direction), n = Load(hits.normal);
    const LaneMask asked = Allowed(packet, material.transmit, lanes);
    LaneMask reflects_all = 0;
    WideVectors through = d;
    if (asked != 0 && IsSolid(shape)) {
      through = Refract(d, n, hits, object, material.ior, asked, reflects_all);
    }
    total |= reflects_all;
    const LaneMask reflects = Allowed(packet, material.reflect, lanes) & ~reflects_all;
    if ((reflects | reflects_all) != 0) {
      const Doubles twice = Doubles::All(2) * Dot(n, d);
      const WideVectors mirrored = d - n * twice;
      reflected_.Add(mirrored, reflects, material.reflect);
      reflected_.Add(mirrored, reflects_all, kAll);
    }
    if (!IsPlanar(shape)) transmitted_into_ |= lanes & ~hits.inside;
    transmitted_.Add(through, asked & ~reflects_all, material.transmit);
  }

  // As Refracted, with the indices that each lane finds; sets the lanes of total reflection.
  HWY_INLINE WideVectors Refract(const WideVectors& d, const WideVectors& n, const PacketHits& hits,
                                 int32_t object, double ior, LaneMask lanes,
                                 LaneMask& total) const {
    const Media& media = scene_.tracer().media();
    alignas(64) double around[kPacketLanes];
    for (double& x : around) x = 1;
    if (!media.Neighbours(object).empty()) {
      for (LaneMask left = lanes; left != 0; left &= left - 1) {
        const int lane = std::countr_zero(left);
        around[lane] = media.IorAround(scene_.scene(), object, hits.point.At(lane));
      }
    }
    const WideMask inside = TruthOf<double>(hits.inside);
    const Doubles outer = Doubles::Load(around), inner = Doubles::All(ior), one = Doubles::All(1);
    const Doubles from = Select(inside, inner, outer), into = Select(inside, outer, inner);
    const Doubles eta = from / into;
    const Doubles cosine = -Dot(n, d);
    const Doubles squared = one - eta * eta * (one - cosine * cosine);
    const WideMask bends = Without(one <= one, from == into);
    total = BitsOf(bends & (squared < Doubles::All(0))) & lanes;
    const WideVectors bent = d * eta + n * (eta * cosine - Sqrt(squared));
    return Select(bends, bent, d);
  }

  // `inside`: lanes whose rays leave into the inside.
  void Append(const PathPacket& packet, const PacketHits& hits, const Leg& leg, Branch branch,
              LaneMask inside) {
    if (leg.lanes == 0) return;
    const bool reflected = branch == Branch::kReflected;
    (reflected ? counts_.rays.reflected : counts_.rays.refracted) +=
        static_cast<uint64_t>(std::popcount(leg.lanes));
    PacketWorkspace::Queue& queue = workspace_.queue(level_, reflected ? 0 : 1);
    for (LaneMask left = leg.lanes; left != 0; left &= left - 1) {
      const int lane = std::countr_zero(left);
      PathPacket& to = queue.Room();
      const int at = queue.lanes++;
      const Side side = (inside >> lane & 1) != 0 ? Side::kInside : Side::kOutside;
      to.rays.SetRay(at, hits.point.At(lane), leg.direction.At(lane),
                     {hits.object[lane], hits.face[lane], side});
      const Rgb& k = *leg.coefficient[lane];
      to.weight[at] = packet.weight[lane] * MaxChannel(k);
      for (int c = 0; c < 3; ++c) {
        to.throughput[c][at] = packet.throughput[c][lane] * static_cast<float>(k[c]);
      }
      to.pixel[at] = packet.pixel[lane];
      to.path[at] = PathOf(packet.path[lane], branch);
    }
  }

  static constexpr Rgb kAll{1, 1, 1};

  const PacketScene& scene_;
  const PathLimits& limits_;
  PacketWorkspace& workspace_;
  PacketCounts& counts_;
  int level_ = 0;
  Leg reflected_, transmitted_;
  LaneMask transmitted_into_ = 0;  // of the transmitted: those that leave into the inside
};

}  // namespace linetree::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
