#include "core/packet/packet_shape.h"

#include <algorithm>

namespace linetree {
namespace {

// How far a map may be from a multiple of a rotation for its sphere to pass as a ball: 2^-30 is far
// below what float tells apart, and far above what rounding does to the map of a ball.
constexpr double kBallTolerance = 0x1p-30;

class Maker {
 public:
  Maker(const Vec3d& reference, PacketShape& shape, std::vector<FloatPlane>& planes)
      : reference_(reference), shape_(shape), planes_(planes) {}

  void operator()(const SphereShape& s) {
    SetFrame(s.frame);
    shape_.kind = PacketKind::kEllipsoid;
    const auto& rows = s.frame.object_from_world.row;
    const double scale = Length(rows[0]);
    const double off =
        std::max({std::abs(Length(rows[1]) - scale), std::abs(Length(rows[2]) - scale),
                  std::abs(Dot(rows[0], rows[1])) / scale, std::abs(Dot(rows[1], rows[2])) / scale,
                  std::abs(Dot(rows[2], rows[0])) / scale});
    if (off > scale * kBallTolerance) return;
    shape_.kind = PacketKind::kSphere;
    shape_.radius = static_cast<float>(1 / scale);
  }

  void operator()(const BoxShape& s) {
    SetFrame(s.frame);
    shape_.kind = IsAlongAxes(s) ? PacketKind::kBox : PacketKind::kSlab;
  }

  void operator()(const FrustumShape& s) {
    SetFrame(s.frame);
    shape_.kind = PacketKind::kFrustum;
    shape_.open = s.open;
    shape_.base_radius = static_cast<float>(s.base_radius);
    shape_.taper = static_cast<float>(s.top_radius - s.base_radius);
  }

  void operator()(const DiscShape& s) {
    SetFrame(s.frame);
    shape_.kind = PacketKind::kDisc;
    shape_.plane = PlaneOf(s.plane);
  }

  void operator()(const PolygonShape& s) {
    shape_.kind = PacketKind::kPolygon;
    shape_.plane = PlaneOf(s.plane);
    const Vec3d& n = s.plane.normal;
    int w = 0;
    for (int i = 1; i < 3; ++i) {
      if (std::abs(n[i]) > std::abs(n[w])) w = i;
    }
    const int u = (w + 1) % 3, v = (w + 2) % 3;
    shape_.u = static_cast<uint8_t>(u);
    shape_.v = static_cast<uint8_t>(v);
    shape_.first = static_cast<int32_t>(planes_.size());
    shape_.count = static_cast<int32_t>(s.edges.size());
    // On the polygon's plane x[w] = (offset - n[u] x[u] - n[v] x[v]) / n[w].
    const double offset = Dot(s.plane.point - reference_, n);
    for (const Plane& edge : s.edges) {
      const Vec3d& e = edge.normal;
      const double by_w = e[w] / n[w];
      planes_.push_back({static_cast<float>(e[u] - by_w * n[u]),
                         static_cast<float>(e[v] - by_w * n[v]),
                         static_cast<float>(by_w * offset - Dot(edge.point - reference_, e)), 0});
    }
  }

  void operator()(const TriangleShape& s) { (*this)(s.polygon); }

  void operator()(const PolyhedronShape& s) {
    shape_.kind = PacketKind::kPolyhedron;
    shape_.first = static_cast<int32_t>(planes_.size());
    shape_.count = static_cast<int32_t>(s.faces.size());
    for (const Plane& face : s.faces) planes_.push_back(PlaneOf(face));
  }

 private:
  FloatPlane PlaneOf(const Plane& plane) const {
    const Vec3d& n = plane.normal;
    return {static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z),
            static_cast<float>(-Dot(plane.point - reference_, n))};
  }

  void SetFrame(const AffineFrame& frame) {
    double square = 0;
    for (int i = 0; i < 3; ++i) {
      const Vec3d& row = frame.object_from_world.row[static_cast<size_t>(i)];
      square += LengthSquared(row);
      shape_.center[i] = static_cast<float>(frame.center[i] - reference_[i]);
      for (int j = 0; j < 3; ++j) shape_.map[3 * i + j] = static_cast<float>(row[j]);
    }
    shape_.map_norm = RoundedUp(std::sqrt(square) * (1 + 0x1p-40));
  }

  // Whether every object axis is one of the world's; if so, sets planes and faces.
  bool IsAlongAxes(const BoxShape& s) {
    for (int i = 0; i < 3; ++i) {
      const Vec3d& row = s.frame.object_from_world.row[static_cast<size_t>(i)];
      int axis = -1;
      for (int j = 0; j < 3; ++j) {
        if (row[j] == 0) continue;
        if (axis >= 0) return false;
        axis = j;
      }
      if (axis < 0) return false;
      const double half = 1 / std::abs(row[axis]);
      const double middle = s.frame.center[axis] - reference_[axis];
      shape_.low[axis] = static_cast<float>(middle - half);
      shape_.high[axis] = static_cast<float>(middle + half);
      const bool flipped = row[axis] < 0;
      const auto at = static_cast<size_t>(2 * axis);
      shape_.faces[at] = static_cast<uint8_t>(2 * i + (flipped ? 1 : 0));
      shape_.faces[at + 1] = static_cast<uint8_t>(2 * i + (flipped ? 0 : 1));
    }
    return true;
  }

  const Vec3d& reference_;
  PacketShape& shape_;
  std::vector<FloatPlane>& planes_;
};

}  // namespace

PacketShape MakePacketShape(const Object& object, int32_t index, const Vec3d& reference,
                            std::vector<FloatPlane>& planes) {
  PacketShape shape;
  shape.object = index;
  Vec3d far;
  for (int i = 0; i < 3; ++i) {
    far[i] = std::max(std::abs(object.bounds.min[i] - reference[i]),
                      std::abs(object.bounds.max[i] - reference[i]));
  }
  shape.reach = RoundedUp(Length(far) * (1 + 0x1p-40));
  std::visit(Maker(reference, shape, planes), object.shape);
  return shape;
}

}  // namespace linetree
