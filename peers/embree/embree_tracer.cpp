#include "peers/embree/embree_tracer.h"

#include <limits>
#include <optional>

#include "absl/strings/str_cat.h"
#include "core/trace/shade.h"
#include "peers/embree/embree_scene.h"

namespace linetree {
namespace {

// One ray of a path.
struct Leg {
  Vec3d origin, direction;
  RayStart start;
  int depth = 1;
  double weight = 1;
};

class Path {
 public:
  Path(const EmbreeScene& embree, const PathLimits& limits)
      : embree_(embree), scene_(embree.scene()), limits_(limits) {}

  Rgb Follow(const Leg& leg) const {
    const Hit hit = embree_.Intersect(leg.origin, leg.direction, leg.start, leg.depth == 1);
    if (!hit.IsHit()) return scene_.background;
    const Material& material = scene_.MaterialOf(hit.object);
    Rgb radiance = AmbientTerm<double>(material, scene_.ambient);
    AddLights(leg, hit, material, radiance);
    AddBranches(leg, hit, material, radiance);
    return radiance;
  }

 private:
  void AddLights(const Leg& leg, const Hit& hit, const Material& material, Rgb& radiance) const {
    if (!UsesLights(material)) return;
    const RayStart start{hit.object, hit.face, hit.side};
    for (const Light& light : scene_.lights) {
      const LightView<double> view = ViewOf(light, hit.point);
      const double cosine = Dot(hit.normal, view.to_light);
      if (!(cosine > 0)) continue;
      const double distance = light.kind == LightKind::kPoint
                                  ? Length(hit.point - light.position)
                                  : std::numeric_limits<double>::infinity();
      const Rgb filter = embree_.Transmittance(hit.point, view.to_light, distance, start);
      if (IsBlack(filter)) continue;
      radiance +=
          filter * LightTermRadiance(material, light, view, cosine, hit.normal, -leg.direction);
    }
  }

  void AddBranches(const Leg& leg, const Hit& hit, const Material& material, Rgb& radiance) const {
    const bool transmits = limits_.Allow(leg.depth, leg.weight, material.transmit);
    std::optional<Vec3d> onwards;
    if (transmits) {
      onwards = TransmittedDirection(leg, hit, material);
      if (!onwards) {
        radiance += Follow(Reflection(leg, hit, leg.weight));
        return;
      }
    }
    if (limits_.Allow(leg.depth, leg.weight, material.reflect)) {
      const double weight = leg.weight * MaxChannel(material.reflect);
      radiance += material.reflect * Follow(Reflection(leg, hit, weight));
    }
    if (!transmits) return;
    const bool into_inside = hit.side == Side::kOutside &&
                             !IsPlanar(scene_.objects[static_cast<size_t>(hit.object)].shape);
    const Leg child{hit.point,
                    *onwards,
                    {hit.object, hit.face, into_inside ? Side::kInside : Side::kOutside},
                    leg.depth + 1,
                    leg.weight * MaxChannel(material.transmit)};
    radiance += material.transmit * Follow(child);
  }

  // Nothing under total internal reflection.
  std::optional<Vec3d> TransmittedDirection(const Leg& leg, const Hit& hit,
                                            const Material& material) const {
    if (!IsSolid(scene_.objects[static_cast<size_t>(hit.object)].shape)) return leg.direction;
    const double around = embree_.media().IorAround(scene_, hit.object, hit.point);
    const bool entering = hit.side == Side::kOutside;
    return Refracted(leg.direction, hit.normal, entering ? around : material.ior,
                     entering ? material.ior : around);
  }

  static Leg Reflection(const Leg& leg, const Hit& hit, double weight) {
    return {hit.point,
            Reflected(leg.direction, hit.normal),
            {hit.object, hit.face, hit.side},
            leg.depth + 1,
            weight};
  }

  const EmbreeScene& embree_;
  const Scene& scene_;
  const PathLimits& limits_;
};

}  // namespace

EmbreeTracer::EmbreeTracer(const Scene& scene)
    : scene_(std::make_unique<const EmbreeScene>(scene)) {}

EmbreeTracer::~EmbreeTracer() = default;

std::string EmbreeTracer::Version() const {
  const auto part = [this](RTCDeviceProperty property) {
    return rtcGetDeviceProperty(scene_->device(), property);
  };
  return absl::StrCat(part(RTC_DEVICE_PROPERTY_VERSION_MAJOR), ".",
                      part(RTC_DEVICE_PROPERTY_VERSION_MINOR), ".",
                      part(RTC_DEVICE_PROPERTY_VERSION_PATCH));
}

Rgb EmbreeTracer::Radiance(const Ray& ray, const PathLimits& limits) const {
  return Path(*scene_, limits).Follow({ray.origin, ray.direction, {}});
}

}  // namespace linetree
