// The rules for everything in a scene but shapes: each function reads one message, and returns what
// it describes or an error that names the field.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "core/io/load_scene.h"
#include "core/scene/affine_map.h"

namespace linetree {

inline Vec3d ToVec3(const v1::Vec3& v) { return {v.x(), v.y(), v.z()}; }
inline Rgb ToRgb(const v1::Rgb& c) { return {c.r(), c.g(), c.b()}; }

// The path is that of the message itself, such as "materials[2]".
absl::StatusOr<Material> ReadMaterial(const SceneSource& source, const std::string& path,
                                      const v1::Material& message);
absl::StatusOr<Light> ReadLight(const SceneSource& source, const std::string& path,
                                const v1::Light& message);
absl::StatusOr<Camera> ReadCamera(const SceneSource& source, const std::string& path,
                                  const v1::Camera& message);

// Puts one step, a matrix, in the place of several: the same map bit for bit (but for the sign of
// zeros), and so the same scene. Leaves them where they, or the matrix, are not valid.
void FoldTransform(v1::Object& object);

// The product of an object's steps, in the order written; invertible. The path is the object's.
absl::StatusOr<AffineMap> ReadTransform(const SceneSource& source, const std::string& path,
                                        const v1::Object& message);

// Each channel finite and in [min, max].
absl::Status CheckRgb(const SceneSource& source, const std::string& path, const v1::Rgb& rgb,
                      double min, double max);
absl::Status CheckNumber(const SceneSource& source, const std::string& path, double value,
                         double min, double max);
// Names and descriptions are UTF-8, as Protobuf requires on the wire.
absl::Status CheckText(const SceneSource& source, const std::string& path, absl::string_view text);

}  // namespace linetree
