// A scene's objects in an Embree hierarchy, and the two questions that a tracer asks it.
#pragma once

#include <embree3/rtcore.h>

#include <array>
#include <vector>

#include "core/scene/scene.h"
#include "core/trace/hit.h"
#include "core/trace/media.h"

namespace linetree {

// Thread safety: immutable once built.
class EmbreeScene {
 public:
  explicit EmbreeScene(const Scene& scene);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  const Scene& scene() const { return scene_; }
  const Media& media() const { return media_; }
  RTCDevice device() const { return device_; }

  // The nearest hit of a ray with a unit direction; `coherent` tells Embree that neighbouring rays
  // are alike.
  Hit Intersect(const Vec3d& origin, const Vec3d& direction, const RayStart& start,
                bool coherent) const;

  // What is left of light over `distance` along a unit direction: black when something opaque is in
  // between, else the product of transmit over the surfaces crossed.
  Rgb Transmittance(const Vec3d& origin, const Vec3d& direction, double distance,
                    const RayStart& start) const;

  // The object behind a primitive of the user geometry.
  int UserObject(unsigned primitive) const {
    return parts_[static_cast<size_t>(Kind::kUser)][primitive].object;
  }

 private:
  // One Embree geometry each; its number there.
  enum class Kind : unsigned { kSphere, kTriangles, kUser };
  static constexpr size_t kKinds = 3;
  // What of an object a primitive of Embree's is. User geometry reports the face itself.
  struct Part {
    int object = 0;
    int face = 0;
  };

  Kind KindOf(const Object& object) const;
  std::vector<Part>& PartsOf(Kind kind) { return parts_[static_cast<size_t>(kind)]; }
  void AddSpheres();
  void AddTriangles();
  void AddUserGeometry();
  void Attach(RTCGeometry geometry, Kind kind);
  // Where a ray from `start` begins for Embree's own geometry.
  float NearOf(const Vec3d& origin, const RayStart& start) const;

  const Scene& scene_;
  const Media media_;
  const double magnitude_;  // largest absolute coordinate
  RTCDevice device_;
  RTCScene embree_;
  std::array<std::vector<Part>, kKinds> parts_;  // by geometry, by primitive
};

}  // namespace linetree
