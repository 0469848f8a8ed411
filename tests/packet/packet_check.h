// Packets against the scalar tracer, decision by decision.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <vector>

#include "core/packet/packet_tracer.h"
#include "core/packet/topology.h"
#include "core/trace/shade.h"

namespace linetree::test {

// A ray with what it starts on.
struct StartedRay {
  Ray ray;
  RayStart start;
};

inline std::vector<StartedRay> Free(const std::vector<Ray>& rays) {
  std::vector<StartedRay> started;
  for (const Ray& ray : rays) started.push_back({ray, RayStart{}});
  return started;
}

// All rays on the paths of the given ones, as the scalar tracer follows them.
inline std::vector<StartedRay> WithSpawned(const Tracer& tracer, const std::vector<Ray>& rays,
                                           const PathLimits& limits) {
  std::vector<StartedRay> all;
  RayTree tree;
  RayCounts counts;
  for (const Ray& ray : rays) {
    tracer.Radiance(ray.origin, ray.direction, limits, counts, &tree);
    for (const RayTreeNode& node : tree.nodes) {
      if (node.kind == NodeKind::kCutOff) continue;
      StartedRay started{{node.origin, node.direction}, RayStart{}};
      if (node.parent >= 0) {
        const RayTreeNode& from = tree.nodes[static_cast<size_t>(node.parent)];
        started.start = {from.object, from.face, from.side};
        if (node.branch == Branch::kTransmitted) {
          const Shape& shape = tracer.scene().objects[static_cast<size_t>(from.object)].shape;
          const bool into = from.side == Side::kOutside && !IsPlanar(shape);
          started.start.side = into ? Side::kInside : Side::kOutside;
        }
      }
      all.push_back(started);
    }
  }
  return all;
}

inline PacketRays PacketOf(const std::vector<StartedRay>& rays, size_t first) {
  PacketRays packet;
  for (size_t i = first; i < std::min(rays.size(), first + kPacketLanes); ++i) {
    packet.SetRay(static_cast<int>(i - first), rays[i].ray.origin, rays[i].ray.direction,
                  rays[i].start);
  }
  return packet;
}

inline bool SameBits(const Vec3d& a, const Vec3d& b) {
  for (int i = 0; i < 3; ++i) {
    if (std::bit_cast<uint64_t>(a[i]) != std::bit_cast<uint64_t>(b[i])) return false;
  }
  return true;
}

inline bool SameHit(const Hit& a, const Hit& b) {
  if (a.object != b.object) return false;
  if (!a.IsHit()) return true;
  return a.face == b.face && a.side == b.side && a.first_on_line == b.first_on_line && a.t == b.t &&
         SameBits(a.point, b.point) && SameBits(a.normal, b.normal);
}

inline std::string TextOf(const Hit& hit) {
  char text[300];
  std::snprintf(text, sizeof(text),
                "object %d face %d side %d first %d t %.17g at %.17g %.17g %.17g "
                "normal %.17g %.17g %.17g",
                hit.object, hit.face, static_cast<int>(hit.side), hit.first_on_line, hit.t,
                hit.point.x, hit.point.y, hit.point.z, hit.normal.x, hit.normal.y, hit.normal.z);
  return text;
}

inline double LargestExponent(const Scene& scene) {
  double largest = 0;
  for (const Material& m : scene.materials) {
    if (!IsBlack(m.specular)) largest = std::max(largest, m.exponent);
  }
  return largest;
}

// How far two radiances are apart, as a share of what PacketRadianceRounding allows.
inline double ShareOfRounding(const Scene& scene, const Rgb& packet, const Rgb& scalar) {
  double share = 0;
  for (int c = 0; c < 3; ++c) {
    const double allowed =
        PacketRadianceRounding(LargestExponent(scene)) * std::max(scalar[c], RadianceFloor(scene));
    const double off = std::abs(packet[c] - scalar[c]);
    share = std::max(share, off <= 0 ? 0 : off / allowed);
    if (std::isnan(packet[c]) != std::isnan(scalar[c])) share = INFINITY;
  }
  return share;
}

struct CheckTotals {
  uint64_t hits = 0, shadows = 0, wrong = 0;
  double largest_share = 0;
  PacketCounts counts;
};

// Compares hits and light states of all rays, and radiance of those that start free. Reports the
// first few differences.
class PacketCheck {
 public:
  PacketCheck(const PacketTracer& packets, const PathLimits& limits, std::string name,
              CheckTotals& totals)
      : packets_(packets),
        tracer_(packets.tracer()),
        scene_(tracer_.scene()),
        limits_(limits),
        name_(std::move(name)),
        totals_(totals),
        shadows_(scene_.lights.size()) {}

  void Check(const std::vector<StartedRay>& rays, size_t first) {
    rays_ = PacketOf(rays, first);
    lanes_ = std::popcount(rays_.active);
    packets_.FindHits(rays_, hits_, totals_.counts);
    for (int lane = 0; lane < lanes_; ++lane) {
      const Hit hit =
          tracer_.Intersect(rays_.origin.At(lane), rays_.direction.At(lane), rays_.StartAt(lane));
      ++totals_.hits;
      if (!SameHit(hits_.At(lane), hit)) {
        Complain("ray " + std::to_string(first + static_cast<size_t>(lane)) + " expected " +
                 TextOf(hit) + " got " + TextOf(hits_.At(lane)));
      }
    }
    for (size_t i = 0; i < scene_.lights.size(); ++i) {
      packets_.CastShadows(hits_, kAllLanes, static_cast<int>(i), workspace_, shadows_[i],
                           totals_.counts);
      for (int lane = 0; lane < lanes_; ++lane) CheckShadow(i, lane);
    }
    PathLimits one_leg = limits_;
    one_leg.max_depth = 1;
    CheckRadiance(one_leg);
    CheckShade();
    CheckRadiance(limits_);
  }

 private:
  void Complain(const std::string& what) {
    if (++totals_.wrong <= 5) ADD_FAILURE() << name_ << ": " << what;
  }

  void CheckShadow(size_t light, int lane) {
    const Hit hit = hits_.At(lane);
    if (!hit.IsHit()) return;
    ++totals_.shadows;
    const PacketShadow& shadow = shadows_[light];
    const bool facing = Dot(hit.normal, ViewOf(scene_.lights[light], hit.point).to_light) > 0;
    if (facing != ((shadow.facing >> lane & 1) != 0)) Complain("facing");
    if (!facing) return;
    const auto cast =
        tracer_.CastShadow(hit.point, static_cast<int>(light), {hit.object, hit.face, hit.side});
    const bool lit = (shadow.lit >> lane & 1) != 0;
    const bool filtered = (shadow.filtered >> lane & 1) != 0;
    if ((cast.term.state == LightState::kLit) != lit || (cast.term.crossings != 0) != filtered) {
      Complain("light " + std::to_string(light) + " from " + TextOf(hit) + " lit " +
               std::to_string(lit) + " blocked by " + std::to_string(cast.term.occluder));
    }
    for (int c = 0; lit && filtered && c < 3; ++c) {
      const double off = std::abs(static_cast<double>(shadow.filter[c][lane]) - cast.filter[c]);
      if (off > 0x1p-20 * cast.filter[c] + 1e-37) Complain("filter");
    }
  }

  void CheckRadiance(const PathLimits& limits) {
    packets_.Radiance(rays_, limits, workspace_, radiance_, totals_.counts);
    for (int lane = 0; lane < lanes_; ++lane) {
      if (rays_.start_object[lane] != kNoObject) continue;
      RayCounts counts;
      const Rgb scalar =
          tracer_.Radiance(rays_.origin.At(lane), rays_.direction.At(lane), limits, counts);
      const Rgb rgb{radiance_.r[lane], radiance_.g[lane], radiance_.b[lane]};
      const double share = ShareOfRounding(scene_, rgb, scalar);
      totals_.largest_share = std::max(totals_.largest_share, share);
      if (!(share <= 1)) Complain("radiance off by " + std::to_string(share));
    }
  }

  // After CheckRadiance with one leg: visibility from elsewhere gives the same bits.
  void CheckShade() {
    PacketRgb sum;
    packets_.Shade(rays_, hits_, shadows_, sum);
    for (int lane = 0; lane < lanes_; ++lane) {
      if (rays_.start_object[lane] != kNoObject || !hits_.At(lane).IsHit()) continue;
      // Scenes that do not fit float are summed in double by the one and by lane by the other.
      if (!packets_.IsWide()) continue;
      if (sum.r[lane] != radiance_.r[lane] || sum.g[lane] != radiance_.g[lane] ||
          sum.b[lane] != radiance_.b[lane]) {
        Complain("Shade and Radiance differ");
      }
    }
  }

  const PacketTracer& packets_;
  const Tracer& tracer_;
  const Scene& scene_;
  const PathLimits& limits_;
  const std::string name_;
  CheckTotals& totals_;
  PacketWorkspace workspace_;
  int lanes_ = 0;
  PacketRays rays_;
  PacketHits hits_;
  std::vector<PacketShadow> shadows_;
  PacketRgb radiance_;
};

inline void CheckPackets(const PacketTracer& packets, const std::vector<StartedRay>& rays,
                         const PathLimits& limits, const std::string& name, CheckTotals& totals) {
  PacketCheck check(packets, limits, name, totals);
  for (size_t first = 0; first < rays.size(); first += kPacketLanes) check.Check(rays, first);
}

// A whole picture: topology, radiance, first hits and counts of every pixel.
inline void CheckPicture(const PacketTracer& packets, const Camera& camera, int width, int height,
                         const PathLimits& limits, const std::string& name, CheckTotals& totals) {
  const Tracer& tracer = packets.tracer();
  const EyeRays eye_rays(camera, width, height);
  const auto pixels = static_cast<size_t>(width * height);
  std::vector<float> radiance(3 * pixels), depth(pixels);
  std::vector<int32_t> object(pixels);
  std::vector<uint64_t> topology(pixels);
  const PixelTarget target = {radiance.data(), object.data(), depth.data(), topology.data()};
  PacketWorkspace workspace;
  PacketCounts counts;
  packets.RenderRegion(eye_rays, {0, 0, width, height}, limits, static_cast<size_t>(width), target,
                       workspace, counts);
  totals.counts += counts;
  RayTree tree;
  RayCounts scalar_counts;
  for (size_t p = 0; p < pixels; ++p) {
    const int x = static_cast<int>(p) % width, y = static_cast<int>(p) / width;
    const Ray ray = eye_rays.ThroughPixel(x, y);
    const Rgb scalar = tracer.Radiance(ray.origin, ray.direction, limits, scalar_counts, &tree);
    const Rgb rgb{radiance[3 * p], radiance[3 * p + 1], radiance[3 * p + 2]};
    const double share = ShareOfRounding(tracer.scene(), rgb, scalar);
    totals.largest_share = std::max(totals.largest_share, share);
    const bool same = TopologyDigest(tree) == topology[p] && object[p] == tree.nodes[0].object;
    if (!same || !(share <= 1)) {
      if (++totals.wrong <= 5) {
        ADD_FAILURE() << name << ": pixel " << x << " " << y << (same ? "" : " topology")
                      << " radiance off by " << share;
      }
    }
  }
  totals.hits += pixels;
  if (!(counts.rays == scalar_counts)) {
    ++totals.wrong;
    ADD_FAILURE() << name << ": counts differ";
  }
}

inline void Print(const char* what, const CheckTotals& t) {
  const auto share = [](uint64_t part, uint64_t all) {
    return all == 0 ? 0 : 100.0 * static_cast<double>(part) / static_cast<double>(all);
  };
  std::printf(
      "%s: %llu hits and %llu light states compared, %llu wrong; again in double: %.3f %% "
      "of hits, %.3f %% of shadow rays; radiance within %.2f of its bound\n",
      what, static_cast<unsigned long long>(t.hits), static_cast<unsigned long long>(t.shadows),
      static_cast<unsigned long long>(t.wrong),
      share(t.counts.hits_again, t.counts.rays.intersect - t.counts.rays.shadow),
      share(t.counts.shadows_again, t.counts.rays.shadow), t.largest_share);
}

}  // namespace linetree::test
