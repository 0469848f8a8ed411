#include "core/audit/violation.h"

#include "absl/strings/str_format.h"

namespace linetree {
namespace {

std::string HexText(const Rgb& rgb) { return HexText(Vec3d{rgb.r, rgb.g, rgb.b}); }

}  // namespace

std::string HexText(const Vec3d& v) { return absl::StrFormat("%a,%a,%a", v.x, v.y, v.z); }

std::string ToLine(const Violation& v) {
  const char* judge = v.options.judge == JudgeKind::kCertified ? "certified" : "paper";
  return absl::StrFormat(
      "scene=\"%s\" origin=%s direction=%s epsilon=%.17g max_depth=%d min_weight=%.17g judge=%s "
      "asked_as=%s answer=%s classical=%s error_over_allowed=%.4g",
      v.scene, HexText(v.ray.origin), HexText(v.ray.direction), v.options.max_relative_error,
      v.options.limits.max_depth, v.options.limits.min_weight, judge,
      v.from_frame ? "pixel" : "ray", HexText(v.answer), HexText(v.classical),
      v.error_over_allowed);
}

}  // namespace linetree
