#include "core/io/validate.h"

#include <array>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "core/io/scene_source.h"
#include "core/scene/make_shape.h"

namespace linetree {
namespace {

// Ranges of scene.proto.
constexpr double kMaxExponent = 1e6;
constexpr double kMinIor = 0.05;
constexpr double kMaxIor = 20;
constexpr double kMaxFadePower = 8;

// Whether `text` is well-formed UTF-8 (RFC 3629: no overlong forms, no surrogates).
bool IsUtf8(absl::string_view text) {
  const auto byte = [&](size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  for (size_t i = 0; i < text.size();) {
    const unsigned lead = byte(i);
    const size_t more = lead < 0x80 ? 0 : lead < 0xc2 ? 9 : lead < 0xe0 ? 1 : lead < 0xf0 ? 2 : 3;
    if (more == 9 || lead > 0xf4) return false;
    for (size_t k = 1; k <= more; ++k) {
      if ((byte(i + k) & 0xc0) != 0x80) return false;
    }
    const unsigned second = byte(i + 1);
    if ((lead == 0xe0 && second < 0xa0) || (lead == 0xed && second > 0x9f) ||
        (lead == 0xf0 && second < 0x90) || (lead == 0xf4 && second > 0x8f)) {
      return false;
    }
    i += more + 1;
  }
  return true;
}

absl::Status ReadPoint(const SceneSource& source, const std::string& path, const v1::PointLight& p,
                       Light& light) {
  light.kind = LightKind::kPoint;
  light.position = ToVec3(p.position());
  if (auto s = InField(source, path, CheckPoint("position", light.position)); !s.ok()) return s;
  light.fade_distance = p.fade_distance();
  if (light.fade_distance != 0) {
    if (auto s = InField(source, path, CheckLength("fade_distance", light.fade_distance)); !s.ok())
      return s;
  }
  light.fade_power = p.has_fade_power() ? p.fade_power() : 2;
  if (light.fade_power > 0 && light.fade_power <= kMaxFadePower) return absl::OkStatus();
  return FieldError(
      source, path + ".fade_power",
      absl::StrCat("expected a number in (0, ", kMaxFadePower, "], got ", light.fade_power));
}

absl::Status ReadDirectional(const SceneSource& source, const std::string& path,
                             const v1::DirectionalLight& d, Light& light) {
  light.kind = LightKind::kDirectional;
  const Vec3d direction = ToVec3(d.direction());
  if (auto s = InField(source, path, CheckDirection("direction", direction)); !s.ok()) return s;
  light.to_light = -Unit(direction);
  return absl::OkStatus();
}

Camera ToCamera(const v1::Camera& message) {
  Camera camera;
  camera.name = message.name();
  camera.eye = ToVec3(message.eye());
  camera.look_at = ToVec3(message.look_at());
  if (message.has_up()) camera.up = ToVec3(message.up());
  if (message.has_fov_deg()) camera.fov_deg = message.fov_deg();
  return camera;
}

absl::StatusOr<AffineMap> ReadMatrix(const SceneSource& source, const std::string& path,
                                     const v1::Matrix& matrix) {
  const auto& m = matrix.row_major_3x4();
  const std::string field = path + ".row_major_3x4";
  if (m.size() != 12) {
    return FieldError(source, field, absl::StrCat("expected 12 numbers, got ", m.size()));
  }
  AffineMap map;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      const int i = 4 * row + column;
      const std::string element = absl::StrCat(field, "[", i, "]");
      if (auto s = CheckNumber(source, element, m[i], -kMaxMagnitude, kMaxMagnitude); !s.ok())
        return s;
      (column < 3 ? map.linear.row[static_cast<size_t>(row)][column] : map.translation[row]) = m[i];
    }
  }
  return map;
}

absl::StatusOr<AffineMap> ReadStep(const SceneSource& source, const std::string& path,
                                   const v1::TransformStep& step) {
  switch (step.step_case()) {
    case v1::TransformStep::kTranslate: {
      const Vec3d offset = ToVec3(step.translate());
      if (auto s = InField(source, path, CheckPoint("translate", offset)); !s.ok()) return s;
      return Translation(offset);
    }
    case v1::TransformStep::kRotate: {
      const std::string turn = path + ".rotate";
      const Vec3d axis = ToVec3(step.rotate().axis());
      if (auto s = InField(source, turn, CheckDirection("axis", axis)); !s.ok()) return s;
      const double angle = step.rotate().angle_deg();
      if (auto s = CheckNumber(source, turn + ".angle_deg", angle, -kMaxMagnitude, kMaxMagnitude);
          !s.ok())
        return s;
      return Rotation(axis, angle);
    }
    case v1::TransformStep::kScale: {
      const Vec3d factors = ToVec3(step.scale());
      if (auto s = InField(source, path, CheckPoint("scale", factors)); !s.ok()) return s;
      if (factors.x == 0 || factors.y == 0 || factors.z == 0) {
        return FieldError(source, path + ".scale",
                          absl::StrCat("expected factors other than 0, got (", factors.x, ", ",
                                       factors.y, ", ", factors.z, ")"));
      }
      return Scaling(factors);
    }
    case v1::TransformStep::kMatrix:
      return ReadMatrix(source, path + ".matrix", step.matrix());
    case v1::TransformStep::STEP_NOT_SET:
      break;
  }
  return FieldError(source, path, "expected translate, rotate, scale or matrix");
}

}  // namespace

absl::Status CheckNumber(const SceneSource& source, const std::string& path, double value,
                         double min, double max) {
  // Written so that NaN fails.
  if (value >= min && value <= max) return absl::OkStatus();
  return FieldError(source, path,
                    absl::StrCat("expected a number in [", min, ", ", max, "], got ", value));
}

absl::Status CheckRgb(const SceneSource& source, const std::string& path, const v1::Rgb& rgb,
                      double min, double max) {
  if (auto s = CheckNumber(source, path + ".r", rgb.r(), min, max); !s.ok()) return s;
  if (auto s = CheckNumber(source, path + ".g", rgb.g(), min, max); !s.ok()) return s;
  return CheckNumber(source, path + ".b", rgb.b(), min, max);
}

absl::Status CheckText(const SceneSource& source, const std::string& path, absl::string_view text) {
  return IsUtf8(text) ? absl::OkStatus() : FieldError(source, path, "expected UTF-8 text");
}

absl::StatusOr<Material> ReadMaterial(const SceneSource& source, const std::string& path,
                                      const v1::Material& message) {
  if (message.name().empty()) return FieldError(source, path + ".name", "expected a name");
  if (auto s = CheckText(source, path + ".name", message.name()); !s.ok()) return s;
  struct Rule {
    const char* field;
    const v1::Rgb& value;
    double max;
  };
  for (const Rule& rule :
       {Rule{"ambient", message.ambient(), kMaxMagnitude},
        Rule{"diffuse", message.diffuse(), kMaxMagnitude},
        Rule{"specular", message.specular(), kMaxMagnitude}, Rule{"reflect", message.reflect(), 1},
        Rule{"transmit", message.transmit(), 1}}) {
    const std::string field = absl::StrCat(path, ".", rule.field);
    if (auto s = CheckRgb(source, field, rule.value, 0, rule.max); !s.ok()) return s;
  }
  Material material;
  material.name = message.name();
  material.ambient = ToRgb(message.ambient());
  material.diffuse = ToRgb(message.diffuse());
  material.specular = ToRgb(message.specular());
  material.reflect = ToRgb(message.reflect());
  material.transmit = ToRgb(message.transmit());
  if (message.has_exponent()) material.exponent = message.exponent();
  if (message.has_ior()) material.ior = message.ior();
  if (auto s = CheckNumber(source, path + ".exponent", material.exponent, 0, kMaxExponent); !s.ok())
    return s;
  if (auto s = CheckNumber(source, path + ".ior", material.ior, kMinIor, kMaxIor); !s.ok())
    return s;
  return material;
}

absl::StatusOr<Light> ReadLight(const SceneSource& source, const std::string& path,
                                const v1::Light& message) {
  if (auto s = CheckText(source, path + ".name", message.name()); !s.ok()) return s;
  Light light;
  light.name = message.name();
  if (message.has_irradiance()) {
    if (auto s = CheckRgb(source, path + ".irradiance", message.irradiance(), 0, kMaxMagnitude);
        !s.ok())
      return s;
    light.irradiance = ToRgb(message.irradiance());
  }
  if (message.has_point()) {
    if (auto s = ReadPoint(source, path + ".point", message.point(), light); !s.ok()) return s;
  } else if (message.has_directional()) {
    if (auto s = ReadDirectional(source, path + ".directional", message.directional(), light);
        !s.ok())
      return s;
  } else {
    return FieldError(source, path, "expected a kind of light: point or directional");
  }
  return light;
}

absl::StatusOr<Camera> ReadCamera(const SceneSource& source, const std::string& path,
                                  const v1::Camera& message) {
  if (auto s = CheckText(source, path + ".name", message.name()); !s.ok()) return s;
  const Camera camera = ToCamera(message);
  for (const auto& [field, point] :
       {std::pair("eye", camera.eye), std::pair("look_at", camera.look_at)}) {
    if (auto s = InField(source, path, CheckPoint(field, point)); !s.ok()) return s;
  }
  const absl::Status status = ValidateCamera(camera);
  if (status.ok()) return camera;
  // "camera.up: expected ..." becomes an error about cameras[i].up.
  constexpr absl::string_view kPrefix = "camera.";
  absl::string_view text = status.message();
  if (text.substr(0, kPrefix.size()) == kPrefix) text.remove_prefix(kPrefix.size());
  return InField(source, path, absl::InvalidArgumentError(text));
}

namespace {

// Of the steps, without asking whether it can be inverted.
absl::StatusOr<AffineMap> ReadProduct(const SceneSource& source, const std::string& path,
                                      const v1::Object& message) {
  AffineMap map;
  for (int i = 0; i < message.transform_size(); ++i) {
    const std::string step_path = absl::StrCat(path, ".transform[", i, "]");
    auto step = ReadStep(source, step_path, message.transform(i));
    if (!step.ok()) return step.status();
    map = Then(map, *step);
  }
  return map;
}

}  // namespace

void FoldTransform(v1::Object& object) {
  if (object.transform_size() < 2) return;
  const auto nowhere = SceneFromMessage({});
  const auto map = ReadProduct(*nowhere, "", object);
  if (!map.ok()) return;
  v1::Object folded;
  auto& numbers = *folded.add_transform()->mutable_matrix()->mutable_row_major_3x4();
  for (int row = 0; row < 3; ++row) {
    const Vec3d& linear = map->linear.row[static_cast<size_t>(row)];
    for (const double number : {linear.x, linear.y, linear.z, map->translation[row]}) {
      numbers.Add(number);
    }
  }
  const auto read_back = ReadProduct(*nowhere, "", folded);
  if (read_back.ok() && *read_back == *map)
    object.mutable_transform()->Swap(folded.mutable_transform());
}

absl::StatusOr<AffineMap> ReadTransform(const SceneSource& source, const std::string& path,
                                        const v1::Object& message) {
  auto map = ReadProduct(source, path, message);
  if (!map.ok()) return map;
  if (auto inverse = InverseLinear(*map); !inverse.ok()) {
    return InField(source, path, inverse.status());
  }
  return map;
}

}  // namespace linetree
