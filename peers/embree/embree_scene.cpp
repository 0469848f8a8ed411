#include "peers/embree/embree_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/math/check.h"
#include "core/trace/intersect.h"
#include "peers/embree/embree_tracer.h"

namespace linetree {
namespace {

// What callbacks must know of a ray beyond Embree's floats. Embree hands the context through.
struct Query {
  RTCIntersectContext context;  // first, so that a pointer to it is one to the whole
  const EmbreeScene* scene;
  Vec3d origin, direction;
  RayStart start;
  Rgb transmittance{1, 1, 1};  // of shadow rays
};

Query MakeQuery(const EmbreeScene& scene, const Vec3d& origin, const Vec3d& direction,
                const RayStart& start) {
  Query query;
  rtcInitIntersectContext(&query.context);
  query.scene = &scene;
  query.origin = origin;
  query.direction = direction;
  query.start = start;
  return query;
}

float Below(double x) {
  return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity());
}
float Above(double x) {
  return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}

void UserBounds(const RTCBoundsFunctionArguments* arguments) {
  const auto& scene = *static_cast<const EmbreeScene*>(arguments->geometryUserPtr);
  const Box3& box =
      scene.scene().objects[static_cast<size_t>(scene.UserObject(arguments->primID))].bounds;
  RTCBounds& out = *arguments->bounds_o;
  out.lower_x = Below(box.min.x);
  out.lower_y = Below(box.min.y);
  out.lower_z = Below(box.min.z);
  out.upper_x = Above(box.max.x);
  out.upper_y = Above(box.max.y);
  out.upper_z = Above(box.max.z);
}

Crossings<double> CrossingsOf(const Query& query, int object) {
  return RayCrossings(query.scene->scene().objects[static_cast<size_t>(object)].shape, object,
                      query.origin, query.direction, query.start);
}

void UserIntersect(const RTCIntersectFunctionNArguments* arguments) {
  if (arguments->valid[0] == 0) return;
  const auto& query = *reinterpret_cast<const Query*>(arguments->context);
  auto& found = *reinterpret_cast<RTCRayHit*>(arguments->rayhit);
  const int object = query.scene->UserObject(arguments->primID);
  for (const Crossing<double>& crossing : CrossingsOf(query, object)) {
    const auto t = static_cast<float>(crossing.t);
    if (!(t < found.ray.tfar)) continue;
    found.ray.tfar = t;
    found.hit.geomID = arguments->geomID;
    found.hit.primID = arguments->primID;
    // Embree keeps u for the caller: the face travels in it.
    found.hit.u = static_cast<float>(crossing.face);
    return;
  }
}

void UserOccluded(const RTCOccludedFunctionNArguments* arguments) {
  if (arguments->valid[0] == 0) return;
  auto& query = *reinterpret_cast<Query*>(arguments->context);
  auto& ray = *reinterpret_cast<RTCRay*>(arguments->ray);
  const int object = query.scene->UserObject(arguments->primID);
  const Rgb& transmit = query.scene->scene().MaterialOf(object).transmit;
  for (const Crossing<double>& crossing : CrossingsOf(query, object)) {
    if (!(crossing.t < ray.tfar)) continue;
    if (IsBlack(transmit)) {
      ray.tfar = -std::numeric_limits<float>::infinity();
      return;
    }
    query.transmittance = query.transmittance * transmit;
  }
}

// Whether an object is a ball, equally wide in all directions but for roundings.
bool IsBall(const Shape& shape) {
  const auto* sphere = std::get_if<SphereShape>(&shape);
  if (sphere == nullptr) return false;
  constexpr double kRoundTolerance = 1e-9;
  const auto& rows = sphere->frame.object_from_world.row;
  const double square = LengthSquared(rows[0]);
  for (size_t i = 0; i < 3; ++i) {
    if (std::abs(LengthSquared(rows[i]) - square) > kRoundTolerance * square) return false;
    if (std::abs(Dot(rows[i], rows[(i + 1) % 3])) > kRoundTolerance * square) return false;
  }
  return true;
}

// The corners of a shape's planar faces, each a convex polygon; empty for shapes that go to user
// geometry.
struct FacePolygon {
  int face = 0;
  std::vector<Vec3d> corners;
};
std::vector<FacePolygon> FacesOf(const Shape& shape) {
  std::vector<FacePolygon> faces;
  if (const auto* polygon = std::get_if<PolygonShape>(&shape)) faces = {{0, polygon->vertices}};
  if (const auto* triangle = std::get_if<TriangleShape>(&shape)) {
    faces = {{0, triangle->polygon.vertices}};
  }
  if (const auto* box = std::get_if<BoxShape>(&shape)) {
    for (int face = 0; face < 6; ++face) {
      const int axis = face / 2;
      FacePolygon polygon{face, {}};
      for (const auto& [u, v] :
           {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
        Vec3d p;
        p[axis] = face % 2 == 0 ? -1 : 1;
        p[(axis + 1) % 3] = u;
        p[(axis + 2) % 3] = v;
        polygon.corners.push_back(box->frame.center + box->frame.world_from_object * p);
      }
      faces.push_back(std::move(polygon));
    }
  }
  return faces;
}

double MagnitudeOf(const Scene& scene) {
  const Box3 box = scene.WorldBounds();
  double magnitude = 0;
  if (box.IsEmpty()) return magnitude;
  for (int i = 0; i < 3; ++i) {
    magnitude = std::max({magnitude, std::abs(box.min[i]), std::abs(box.max[i])});
  }
  return magnitude;
}

RTCRay MakeRay(const Vec3d& origin, const Vec3d& direction, float near, float far) {
  RTCRay ray{};
  ray.org_x = static_cast<float>(origin.x);
  ray.org_y = static_cast<float>(origin.y);
  ray.org_z = static_cast<float>(origin.z);
  ray.dir_x = static_cast<float>(direction.x);
  ray.dir_y = static_cast<float>(direction.y);
  ray.dir_z = static_cast<float>(direction.z);
  ray.tnear = near;
  ray.tfar = far;
  ray.mask = std::numeric_limits<unsigned>::max();
  return ray;
}

}  // namespace

EmbreeScene::EmbreeScene(const Scene& scene)
    : scene_(scene),
      media_(scene),
      magnitude_(MagnitudeOf(scene)),
      device_(rtcNewDevice(nullptr)),
      embree_(nullptr) {
  LT_CHECK(device_ != nullptr);
  embree_ = rtcNewScene(device_);
  AddSpheres();
  AddTriangles();
  AddUserGeometry();
  rtcCommitScene(embree_);
  LT_CHECK(rtcGetDeviceError(device_) == RTC_ERROR_NONE);
}

EmbreeScene::~EmbreeScene() {
  rtcReleaseScene(embree_);
  rtcReleaseDevice(device_);
}

EmbreeScene::Kind EmbreeScene::KindOf(const Object& object) const {
  const Material& material = scene_.materials[static_cast<size_t>(object.material)];
  if (!IsBlack(material.transmit)) return Kind::kUser;
  if (IsBall(object.shape)) return Kind::kSphere;
  return FacesOf(object.shape).empty() ? Kind::kUser : Kind::kTriangles;
}

void EmbreeScene::Attach(RTCGeometry geometry, Kind kind) {
  rtcCommitGeometry(geometry);
  rtcAttachGeometryByID(embree_, geometry, static_cast<unsigned>(kind));
  rtcReleaseGeometry(geometry);
}

void EmbreeScene::AddSpheres() {
  std::vector<Part>& parts = PartsOf(Kind::kSphere);
  std::vector<float> values;
  for (size_t i = 0; i < scene_.objects.size(); ++i) {
    if (KindOf(scene_.objects[i]) != Kind::kSphere) continue;
    parts.push_back({static_cast<int>(i), 0});
    const AffineFrame& frame = std::get<SphereShape>(scene_.objects[i].shape).frame;
    const double radius = 1 / Length(frame.object_from_world.row[0]);
    for (const double value : {frame.center.x, frame.center.y, frame.center.z, radius}) {
      values.push_back(static_cast<float>(value));
    }
  }
  if (parts.empty()) return;
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_SPHERE_POINT);
  auto* buffer = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, 4 * sizeof(float), parts.size()));
  std::copy(values.begin(), values.end(), buffer);
  Attach(geometry, Kind::kSphere);
}

void EmbreeScene::AddTriangles() {
  std::vector<Part>& parts = PartsOf(Kind::kTriangles);
  std::vector<float> vertices;
  std::vector<unsigned> indices;
  for (size_t i = 0; i < scene_.objects.size(); ++i) {
    if (KindOf(scene_.objects[i]) != Kind::kTriangles) continue;
    for (const FacePolygon& face : FacesOf(scene_.objects[i].shape)) {
      const auto first = static_cast<unsigned>(vertices.size() / 3);
      for (const Vec3d& v : face.corners) {
        for (int k = 0; k < 3; ++k) vertices.push_back(static_cast<float>(v[k]));
      }
      for (unsigned k = 1; k + 1 < face.corners.size(); ++k) {
        indices.insert(indices.end(), {first, first + k, first + k + 1});
        parts.push_back({static_cast<int>(i), face.face});
      }
    }
  }
  if (parts.empty()) return;
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                             RTC_FORMAT_FLOAT3, 3 * sizeof(float),
                                                             vertices.size() / 3));
  std::copy(vertices.begin(), vertices.end(), points);
  auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), parts.size()));
  std::copy(indices.begin(), indices.end(), corners);
  Attach(geometry, Kind::kTriangles);
}

void EmbreeScene::AddUserGeometry() {
  std::vector<Part>& parts = PartsOf(Kind::kUser);
  for (size_t i = 0; i < scene_.objects.size(); ++i) {
    if (KindOf(scene_.objects[i]) == Kind::kUser) parts.push_back({static_cast<int>(i), 0});
  }
  if (parts.empty()) return;
  RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(parts.size()));
  rtcSetGeometryUserData(geometry, this);
  rtcSetGeometryBoundsFunction(geometry, UserBounds, nullptr);
  rtcSetGeometryIntersectFunction(geometry, UserIntersect);
  rtcSetGeometryOccludedFunction(geometry, UserOccluded);
  Attach(geometry, Kind::kUser);
}

float EmbreeScene::NearOf(const Vec3d& origin, const RayStart& start) const {
  if (start.object == kNoObject) return 0;
  const double magnitude =
      std::max({magnitude_, std::abs(origin.x), std::abs(origin.y), std::abs(origin.z)});
  return static_cast<float>(magnitude * kEmbreeStart);
}

Hit EmbreeScene::Intersect(const Vec3d& origin, const Vec3d& direction, const RayStart& start,
                           bool coherent) const {
  Query query = MakeQuery(*this, origin, direction, start);
  if (coherent) query.context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  RTCRayHit found;
  found.ray =
      MakeRay(origin, direction, NearOf(origin, start), std::numeric_limits<float>::infinity());
  found.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  rtcIntersect1(embree_, &query.context, &found);
  Hit hit;
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  const Part& part = parts_[found.hit.geomID][found.hit.primID];
  const bool is_user = found.hit.geomID == static_cast<unsigned>(Kind::kUser);
  hit.object = part.object;
  hit.face = is_user ? static_cast<int>(found.hit.u) : part.face;
  hit.t = found.ray.tfar;
  hit.point = origin + direction * hit.t;
  const Shape& shape = scene_.objects[static_cast<size_t>(part.object)].shape;
  hit.normal = FacingNormal(shape, hit.face, hit.point, direction);
  const Vec3d outward =
      std::visit([&](const auto& s) { return OutwardNormal(s, hit.face, hit.point); }, shape);
  if (!IsPlanar(shape) && Dot(outward, direction) > 0) hit.side = Side::kInside;
  return hit;
}

Rgb EmbreeScene::Transmittance(const Vec3d& origin, const Vec3d& direction, double distance,
                               const RayStart& start) const {
  Query query = MakeQuery(*this, origin, direction, start);
  RTCRay ray = MakeRay(origin, direction, NearOf(origin, start), static_cast<float>(distance));
  rtcOccluded1(embree_, &query.context, &ray);
  return ray.tfar < 0 ? Rgb{} : query.transmittance;
}

}  // namespace linetree
