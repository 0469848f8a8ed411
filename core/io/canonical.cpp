#include "core/io/canonical.h"

#include <xxhash.h>

#include <bit>
#include <memory>

#include "absl/strings/str_format.h"
#include "core/math/check.h"

namespace linetree {
namespace {

// Changes when the serialisation below or the making of shapes does.
constexpr std::string_view kFormat = "linetree scene 1";

class Hasher {
 public:
  Hasher() { LT_CHECK(XXH3_128bits_reset(state_.get()) == XXH_OK); }

  void Add(uint64_t value) {
    unsigned char bytes[8];
    for (size_t i = 0; i < 8; ++i) bytes[i] = static_cast<unsigned char>(value >> (8 * i));
    LT_CHECK(XXH3_128bits_update(state_.get(), bytes, sizeof(bytes)) == XXH_OK);
  }
  // Adding 0 makes one of the two zeros, which mean the same.
  void Add(double value) { Add(std::bit_cast<uint64_t>(value + 0.0)); }
  void Add(bool value) { Add(uint64_t{value}); }
  void Add(std::string_view text) {
    Add(uint64_t{text.size()});
    LT_CHECK(XXH3_128bits_update(state_.get(), text.data(), text.size()) == XXH_OK);
  }
  void Add(const Vec3d& v) {
    Add(v.x);
    Add(v.y);
    Add(v.z);
  }
  void Add(const Rgb& c) {
    Add(c.r);
    Add(c.g);
    Add(c.b);
  }
  void Add(const AffineFrame& f) {
    Add(f.center);
    for (const Vec3d& row : f.object_from_world.row) Add(row);
    for (const Vec3d& row : f.world_from_object.row) Add(row);
  }
  void Add(const Plane& p) {
    Add(p.normal);
    Add(p.point);
  }
  template <class T>
  void Add(const std::vector<T>& items) {
    Add(uint64_t{items.size()});
    for (const T& item : items) Add(item);
  }

  void Add(const SphereShape& s) { Add(s.frame); }
  void Add(const BoxShape& s) { Add(s.frame); }
  void Add(const FrustumShape& s) {
    Add(s.frame);
    Add(s.base_radius);
    Add(s.top_radius);
    Add(s.open);
  }
  void Add(const DiscShape& s) {
    Add(s.frame);
    Add(s.plane);
  }
  void Add(const PolygonShape& s) {
    Add(s.vertices);
    Add(s.plane);
  }
  void Add(const TriangleShape& s) {
    Add(s.polygon);
    for (const Vec3d& normal : s.normals) Add(normal);
  }
  void Add(const PolyhedronShape& s) { Add(s.faces); }

  void Add(const Material& m) {
    Add(std::string_view(m.name));
    for (const Rgb& c : {m.ambient, m.diffuse, m.specular, m.reflect, m.transmit}) Add(c);
    Add(m.exponent);
    Add(m.ior);
  }
  void Add(const Light& l) {
    Add(std::string_view(l.name));
    Add(uint64_t{l.kind == LightKind::kDirectional});
    Add(l.irradiance);
    Add(l.position);
    Add(l.to_light);
    Add(l.fade_distance);
    Add(l.fade_power);
  }
  void Add(const Object& o) {
    Add(std::string_view(o.name));
    Add(static_cast<uint64_t>(o.material));
    Add(uint64_t{o.shape.index()});
    std::visit([this](const auto& shape) { Add(shape); }, o.shape);
  }
  void Add(const Camera& c) {
    Add(std::string_view(c.name));
    for (const Vec3d& v : {c.eye, c.look_at, c.up}) Add(v);
    Add(c.fov_deg);
  }

  std::string Hex() const {
    const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
    return absl::StrFormat("%016x%016x", hash.high64, hash.low64);
  }

 private:
  struct Free {
    void operator()(XXH3_state_t* state) const { XXH3_freeState(state); }
  };
  std::unique_ptr<XXH3_state_t, Free> state_{XXH3_createState()};
};

}  // namespace

SceneVersion VersionOf(const Scene& scene) {
  Hasher hasher;
  hasher.Add(kFormat);
  hasher.Add(std::string_view(scene.name));
  hasher.Add(scene.background);
  hasher.Add(scene.ambient);
  hasher.Add(scene.white);
  hasher.Add(scene.materials);
  hasher.Add(scene.lights);
  hasher.Add(scene.objects);
  hasher.Add(scene.cameras);
  return hasher.Hex();
}

}  // namespace linetree
