#include "core/packet/packet_scene.h"

#include <algorithm>
#include <cmath>

#include "core/packet/packet_shape.h"
#include "core/trace/intersect.h"

namespace linetree {
namespace {

// Collapses a binary hierarchy into nodes of sixteen.
class Collapser {
 public:
  Collapser(const Bvh& bvh, const Scene& scene, const Vec3d& reference, double pad,
            std::vector<PacketNode>& nodes)
      : bvh_(bvh), scene_(scene), reference_(reference), pad_(pad), nodes_(nodes) {}

  // Adds the node that stands for node `root` of the binary hierarchy; returns its index.
  int32_t Add(int32_t root) {
    std::vector<Child> children = {{root, -1}};
    while (Open(children)) {
    }
    const auto index = static_cast<int32_t>(nodes_.size());
    nodes_.emplace_back();
    Clear(nodes_.back());
    for (size_t i = 0; i < children.size(); ++i) {
      SetBox(BoxOf(children[i]), i, nodes_[static_cast<size_t>(index)]);
      const int32_t child = children[i].object >= 0 ? ~children[i].object : Add(children[i].node);
      nodes_[static_cast<size_t>(index)].child[i] = child;
    }
    return index;
  }

 private:
  struct Child {
    int32_t node = -1;
    int32_t object = -1;  // when not negative, it is this object alone
  };

  const Bvh::Node& NodeOf(const Child& child) const {
    return bvh_.nodes()[static_cast<size_t>(child.node)];
  }
  const Box3& BoxOf(const Child& child) const {
    return child.object >= 0 ? scene_.objects[static_cast<size_t>(child.object)].bounds
                             : NodeOf(child).box;
  }

  // Replaces the largest child that there is room for by its own children; false when there is
  // none.
  bool Open(std::vector<Child>& children) const {
    size_t best = children.size();
    double largest = -1;
    for (size_t i = 0; i < children.size(); ++i) {
      if (children[i].object >= 0) continue;
      const Bvh::Node& node = NodeOf(children[i]);
      const size_t parts = node.IsLeaf() ? static_cast<size_t>(node.count) : 2;
      if (children.size() - 1 + parts > kPacketLanes) continue;
      if (node.box.HalfArea() > largest) {
        largest = node.box.HalfArea();
        best = i;
      }
    }
    if (best == children.size()) return false;
    const int32_t at = children[best].node;
    const Bvh::Node& node = NodeOf(children[best]);
    children.erase(children.begin() + static_cast<std::ptrdiff_t>(best));
    if (!node.IsLeaf()) {
      children.push_back({at + 1, -1});
      children.push_back({node.first, -1});
      return true;
    }
    for (int32_t i = 0; i < node.count; ++i) {
      children.push_back({-1, bvh_.objects()[static_cast<size_t>(node.first + i)]});
    }
    return true;
  }

  static void Clear(PacketNode& node) {
    constexpr float kNowhere = std::numeric_limits<float>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
      std::fill(std::begin(node.low[axis]), std::end(node.low[axis]), kNowhere);
      std::fill(std::begin(node.high[axis]), std::end(node.high[axis]), -kNowhere);
    }
    std::fill(std::begin(node.child), std::end(node.child), 0);
  }

  void SetBox(const Box3& box, size_t i, PacketNode& node) const {
    for (int axis = 0; axis < 3; ++axis) {
      node.low[axis][i] = RoundedDown(box.min[axis] - reference_[axis] - pad_);
      node.high[axis][i] = RoundedUp(box.max[axis] - reference_[axis] + pad_);
    }
  }

  const Bvh& bvh_;
  const Scene& scene_;
  const Vec3d reference_;
  const double pad_;
  std::vector<PacketNode>& nodes_;
};

bool FitsFloat(double x) {
  const double size = std::abs(x);
  return size == 0 || (size < PacketScene::kMostOfFloat && size > 1 / PacketScene::kMostOfFloat);
}
// Coefficients are not negative: the error of a sum is relative to the sum.
bool FitsFloat(const Rgb& rgb) {
  return FitsFloat(rgb.r) && FitsFloat(rgb.g) && FitsFloat(rgb.b) && rgb.r >= 0 && rgb.g >= 0 &&
         rgb.b >= 0;
}

template <class T>
size_t HeapBytes(const std::vector<T>& items) {
  return items.capacity() * sizeof(T);
}

// The point does not matter.
Vec3d FlatNormalOf(const Shape& shape, int face) {
  const Vec3d outward =
      std::visit([&](const auto& s) { return OutwardNormal(s, face, Vec3d{}); }, shape);
  return Normalized(outward);
}

}  // namespace

PacketScene::PacketScene(const Tracer& tracer) : tracer_(tracer) {
  const Scene& scene = tracer.scene();
  const Box3 bounds = scene.WorldBounds();
  if (!scene.objects.empty()) reference_ = bounds.Center();
  least_length_ = RoundedUp(Length(reference_) * kReferenceShare);
  usable_ = IsUsable();
  if (!usable_) return;
  AddShapes();
  AddNormals();
  AddMaterials();
  AddLights();
  AddNodes();
}

bool PacketScene::IsUsable() const {
  const Scene& scene = this->scene();
  if (scene.objects.empty() || scene.objects.size() > (size_t{1} << 26)) return false;
  bool fits = FitsFloat(scene.background) && FitsFloat(scene.ambient);
  for (const Material& m : scene.materials) {
    fits = fits && FitsFloat(m.ambient) && FitsFloat(m.ambient * scene.ambient) &&
           FitsFloat(m.diffuse) && FitsFloat(m.specular) && FitsFloat(m.reflect) &&
           FitsFloat(m.transmit) && m.exponent >= 0 && m.exponent < 1e5;
  }
  for (const Light& light : scene.lights) {
    fits = fits && FitsFloat(light.irradiance);
    if (light.kind == LightKind::kPoint) {
      fits = fits && Length(light.position - reference_) < kMostOfFloat;
      fits = fits && FitsFloat(light.fade_distance) && light.fade_power <= 8;
    }
  }
  for (const Object& object : scene.objects) {
    const double extent = Length(object.bounds.Extent());
    fits = fits && extent < kMostOfFloat && extent > 1 / kMostOfFloat;
  }
  return fits && Length(scene.WorldBounds().Extent()) < kMostOfFloat;
}

void PacketScene::AddShapes() {
  for (size_t i = 0; i < scene().objects.size(); ++i) {
    PacketShape shape =
        MakePacketShape(scene().objects[i], static_cast<int32_t>(i), reference_, planes_);
    shape.opaque = IsBlack(scene().MaterialOf(static_cast<int>(i)).transmit);
    has_transparent_ = has_transparent_ || !shape.opaque;
    reach_ = std::max(reach_, shape.reach);
    shapes_.push_back(shape);
  }
}

void PacketScene::AddNormals() {
  for (const Object& object : scene().objects) {
    const bool curved = std::holds_alternative<SphereShape>(object.shape) ||
                        std::holds_alternative<TriangleShape>(object.shape);
    lateral_.push_back(std::holds_alternative<FrustumShape>(object.shape));
    first_normal_.push_back(curved ? kCurved : static_cast<int32_t>(normals_.size()));
    if (curved) continue;
    for (int face = 0; face < FaceCount(object.shape); ++face) {
      const bool flat = face > 0 || !lateral_.back();
      normals_.push_back(flat ? FlatNormalOf(object.shape, face) : Vec3d{});
    }
  }
}

void PacketScene::AddMaterials() {
  for (const Material& m : scene().materials) {
    const Rgb ambient = m.ambient * scene().ambient;
    for (int c = 0; c < 3; ++c) {
      materials_.ambient[c].push_back(static_cast<float>(ambient[c]));
      materials_.diffuse[c].push_back(static_cast<float>(m.diffuse[c]));
      materials_.specular[c].push_back(static_cast<float>(m.specular[c]));
    }
    materials_.exponent.push_back(static_cast<float>(m.exponent));
    materials_.uses_lights.push_back(!IsBlack(m.diffuse) || !IsBlack(m.specular));
    materials_.shines.push_back(!IsBlack(m.specular));
    materials_.spawns.push_back(!IsBlack(m.reflect) || !IsBlack(m.transmit));
  }
  for (const Object& object : scene().objects) material_of_.push_back(object.material);
}

void PacketScene::AddLights() {
  for (const Light& from : scene().lights) {
    PacketLight light;
    light.directional = from.kind == LightKind::kDirectional;
    for (int c = 0; c < 3; ++c) light.irradiance[c] = static_cast<float>(from.irradiance[c]);
    if (!light.directional && from.fade_distance > 0) {
      light.inverse_fade_distance = static_cast<float>(1 / from.fade_distance);
      light.fade_power = static_cast<float>(from.fade_power);
    }
    lights_.push_back(light);
  }
}

void PacketScene::AddNodes() {
  std::vector<Box3> boxes;
  for (const Object& object : scene().objects) boxes.push_back(object.bounds);
  const Bvh bvh(boxes);
  // Hits that the scalar tracer computes may lie off their boxes: see RaySlabs::kPad.
  const Box3 bounds = scene().WorldBounds();
  double magnitude = 0;
  for (int axis = 0; axis < 3; ++axis) {
    magnitude = std::max({magnitude, std::abs(bounds.min[axis]), std::abs(bounds.max[axis])});
  }
  Collapser(bvh, scene(), reference_, magnitude * RaySlabs<double>::kPad, nodes_).Add(0);
}

size_t PacketScene::ByteSize() const {
  size_t bytes = HeapBytes(shapes_) + HeapBytes(planes_) + HeapBytes(nodes_) +
                 HeapBytes(first_normal_) + HeapBytes(lateral_) + HeapBytes(normals_) +
                 HeapBytes(materials_.exponent) + HeapBytes(materials_.uses_lights) +
                 HeapBytes(materials_.shines) + HeapBytes(materials_.spawns) +
                 HeapBytes(material_of_) + HeapBytes(lights_);
  for (size_t c = 0; c < 3; ++c) {
    bytes += HeapBytes(materials_.ambient[c]) + HeapBytes(materials_.diffuse[c]) +
             HeapBytes(materials_.specular[c]);
  }
  return bytes;
}

}  // namespace linetree
