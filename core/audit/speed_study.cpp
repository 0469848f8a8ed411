#include "core/audit/speed_study.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/audit/clock.h"
#include "core/packet/topology.h"

namespace linetree {
namespace {

// Frames of both tracers, one after the other.
class Racer {
 public:
  Racer(const Tracer& tracer, const PacketTracer& packets, const Camera& camera,
        const SpeedStudyOptions& options)
      : tracer_(tracer),
        packets_(packets),
        options_(options),
        eye_rays_(camera, options.width, options.height),
        pixels_(static_cast<size_t>(options.width) * static_cast<size_t>(options.height)),
        scalar_(3 * pixels_),
        packet_(3 * pixels_),
        topology_(pixels_) {}

  // Nanoseconds per pixel.
  double Scalar() {
    RayCounts counts;
    const double begin_us = NowUs();
    ForPixels([&](size_t p, const Ray& ray) {
      const Rgb rgb = tracer_.Radiance(ray.origin, ray.direction, options_.limits, counts);
      for (int c = 0; c < 3; ++c) {
        scalar_[3 * p + static_cast<size_t>(c)] = static_cast<float>(rgb[c]);
      }
    });
    return NsPerPixel(begin_us);
  }

  double Packet() {
    PacketCounts counts;
    const double begin_us = NowUs();
    Render({packet_.data()}, counts);
    return NsPerPixel(begin_us);
  }

  // Not timed: every ray tree of both.
  void Compare(SpeedStudy& study) {
    PacketCounts counts;
    Render({packet_.data(), nullptr, nullptr, topology_.data()}, counts);
    RayCounts scalar_counts;
    RayTree tree;
    const double floor = RadianceFloor(tracer_.scene());
    ForPixels([&](size_t p, const Ray& ray) {
      const Rgb rgb =
          tracer_.Radiance(ray.origin, ray.direction, options_.limits, scalar_counts, &tree);
      study.different_topology += TopologyDigest(tree) != topology_[p] ? 1 : 0;
      for (int c = 0; c < 3; ++c) {
        const double off =
            std::abs(static_cast<double>(packet_[3 * p + static_cast<size_t>(c)]) - rgb[c]);
        study.largest_difference =
            std::max(study.largest_difference, off / std::max(rgb[c], floor));
      }
    });
    study.different_counts = counts.rays == scalar_counts ? 0 : 1;
    study.counts = counts;
    study.pixels = pixels_;
  }

 private:
  template <class Fn>
  void ForPixels(Fn&& fn) {
    size_t p = 0;
    for (int y = 0; y < options_.height; ++y) {
      for (int x = 0; x < options_.width; ++x, ++p) fn(p, eye_rays_.ThroughPixel(x, y));
    }
  }
  void Render(const PixelTarget& target, PacketCounts& counts) {
    packets_.RenderRegion(eye_rays_, {0, 0, options_.width, options_.height}, options_.limits,
                          static_cast<size_t>(options_.width), target, workspace_, counts);
  }
  double NsPerPixel(double begin_us) const {
    return 1000 * (NowUs() - begin_us) / static_cast<double>(pixels_);
  }

  const Tracer& tracer_;
  const PacketTracer& packets_;
  const SpeedStudyOptions& options_;
  const EyeRays eye_rays_;
  const size_t pixels_;
  std::vector<float> scalar_, packet_;
  std::vector<uint64_t> topology_;
  PacketWorkspace workspace_;
};

}  // namespace

SpeedSpread SpreadOf(std::vector<double> ns) {
  std::sort(ns.begin(), ns.end());
  const size_t half = ns.size() / 2;
  const double median = ns.size() % 2 == 1 ? ns[half] : (ns[half - 1] + ns[half]) / 2;
  return {median, ns.front(), ns.back()};
}

SpeedStudy StudySpeed(const Tracer& tracer, const PacketTracer& packets, const Camera& camera,
                      const SpeedStudyOptions& options) {
  SpeedStudy study;
  study.objects = tracer.scene().objects.size();
  study.lights = tracer.scene().lights.size();
  study.allowed_difference = packets.radiance_rounding();
  Racer racer(tracer, packets, camera, options);
  racer.Compare(study);
  std::vector<double> scalar, packet, ratio;
  for (int i = 0; i < options.repeats; ++i) {
    scalar.push_back(racer.Scalar());
    packet.push_back(racer.Packet());
    ratio.push_back(scalar.back() / packet.back());
  }
  study.scalar = SpreadOf(std::move(scalar));
  study.packet = SpreadOf(std::move(packet));
  study.ratio = SpreadOf(std::move(ratio)).median;
  return study;
}

}  // namespace linetree
