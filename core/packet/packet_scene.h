// The scene as packets search it: shapes and boxes in float, relative to one reference point, under
// a hierarchy with sixteen children to a node.
//
// Thread safety: immutable once built.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/packet/packet.h"
#include "core/trace/tracer.h"

namespace linetree {

enum class PacketKind : uint8_t {
  kSphere,     // a ball in world space
  kEllipsoid,  // the image of one
  kBox,        // along the world's axes
  kSlab,       // the image of one: a box in object space
  kFrustum,
  kPolygon,
  kDisc,
  kPolyhedron,
};

// A plane's or edge's distance: x * at[0] + y * at[1] + z * at[2] + at[3].
using FloatPlane = std::array<float, 4>;

struct alignas(64) PacketShape {
  PacketKind kind = PacketKind::kSphere;
  bool opaque = true;
  bool open = false;     // kFrustum
  uint8_t u = 0, v = 1;  // kPolygon: the axes of the plane that its edges are projected to
  std::array<uint8_t, 6> faces{};  // kBox: the shape's face on the world's side -x +x -y +y -z +z
  int32_t object = 0;
  int32_t first = 0, count = 0;  // kPolygon, kPolyhedron: planes
  float reach = 0;               // no point of the shape is farther from the reference point
  float center[3] = {};
  float radius = 1;                  // kSphere
  float map[9] = {};                 // object_from_world, row by row
  float map_norm = 1;                // Frobenius norm of the same, rounded up
  FloatPlane plane{};                // kPolygon, kDisc
  float low[3] = {}, high[3] = {};   // kBox: its planes
  float base_radius = 1, taper = 0;  // kFrustum
};

// Boxes of up to sixteen children, rounded outwards; unused ones are empty.
struct alignas(64) PacketNode {
  float low[3][kPacketLanes];
  float high[3][kPacketLanes];
  int32_t child[kPacketLanes];  // a node, or ~ of a shape
};

// A material's coefficients, one array entry for each material.
struct PacketMaterials {
  std::vector<float> ambient[3];  // times the scene's ambient light
  std::vector<float> diffuse[3];
  std::vector<float> specular[3];
  std::vector<float> exponent;
  // Whether there is any diffuse or specular; any specular; any reflect or transmit.
  std::vector<uint8_t> uses_lights, shines, spawns;
};

struct PacketLight {
  bool directional = false;
  float irradiance[3] = {};
  float inverse_fade_distance = 0;  // 0: no fall-off
  float fade_power = 2;
};

// Whether a point lies outside the object's bounds by more than rounding does.
inline bool IsClearOf(const Object& object, const Vec3d& point) {
  const Vec3d extent = object.bounds.Extent(), centre = object.bounds.Center();
  for (int i = 0; i < 3; ++i) {
    const double slack = 0x1p-20 * (std::abs(centre[i]) + extent[i] + std::abs(point[i]));
    if (std::abs(point[i] - centre[i]) > 0.5 * extent[i] + slack) return true;
  }
  return false;
}

class PacketScene {
 public:
  // The reference may be off by this share of its own length for all that rounding in double does.
  static constexpr double kReferenceShare = 0x1p-20;
  // Lengths and coefficients beyond this, and other than zero below its reciprocal, may overflow or
  // vanish in float: such a scene is traced by the scalar tracer, lane by lane.
  static constexpr double kMostOfFloat = 1e9;

  explicit PacketScene(const Tracer& tracer);

  const Tracer& tracer() const { return tracer_; }
  const Scene& scene() const { return tracer_.scene(); }
  bool usable() const { return usable_; }
  const Vec3d& reference() const { return reference_; }
  // What every sum of lengths that scales a margin starts with.
  float least_length() const { return least_length_; }
  // The largest of the shapes'.
  float reach() const { return reach_; }

  const std::vector<PacketShape>& shapes() const { return shapes_; }
  const std::vector<FloatPlane>& planes() const { return planes_; }
  const std::vector<PacketNode>& nodes() const { return nodes_; }
  const PacketMaterials& materials() const { return materials_; }
  // Per object, its material.
  const std::vector<int32_t>& material_of() const { return material_of_; }
  const std::vector<PacketLight>& lights() const { return lights_; }
  // Unit outward normals of flat faces, as the scalar tracer has them.
  bool IsFlat(int32_t object, int face) const {
    const int32_t first = first_normal_[static_cast<size_t>(object)];
    return first != kCurved && (face > 0 || !lateral_[static_cast<size_t>(object)]);
  }
  const Vec3d& FlatNormal(int32_t object, int face) const {
    return normals_[static_cast<size_t>(first_normal_[static_cast<size_t>(object)] + face)];
  }
  // Whether some object lets light through.
  bool has_transparent() const { return has_transparent_; }
  size_t ByteSize() const;  // without the object itself

 private:
  void AddShapes();
  void AddNormals();
  void AddMaterials();
  void AddLights();
  void AddNodes();
  bool IsUsable() const;

  const Tracer& tracer_;
  Vec3d reference_;
  float least_length_ = 0;
  float reach_ = 0;
  bool usable_ = false;
  bool has_transparent_ = false;
  std::vector<PacketShape> shapes_;  // shape i is that of object i
  std::vector<FloatPlane> planes_;
  std::vector<PacketNode> nodes_;
  static constexpr int32_t kCurved = -1;
  std::vector<int32_t> first_normal_;  // per object, of face 0; kCurved: no face is flat
  std::vector<uint8_t> lateral_;       // per object: face 0 is not flat
  std::vector<Vec3d> normals_;
  PacketMaterials materials_;
  std::vector<int32_t> material_of_;
  std::vector<PacketLight> lights_;
};

}  // namespace linetree
