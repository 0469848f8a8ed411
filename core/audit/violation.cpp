#include "core/audit/violation.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace linetree {
namespace {

std::string HexText(const Rgb& rgb) { return HexText(Vec3d{rgb.r, rgb.g, rgb.b}); }

}  // namespace

std::string HexText(const Vec3d& v) { return absl::StrFormat("%a,%a,%a", v.x, v.y, v.z); }

std::string PixelText(const Camera& camera, int width, int height, const Sampling& sampling,
                      size_t pixel) {
  const auto columns = static_cast<size_t>(width);
  return absl::StrFormat(
      "%d,%d of %dx%d eye=%s look_at=%s up=%s fov_deg=%a samples=%d %s seed=%d", pixel % columns,
      pixel / columns, width, height, HexText(camera.eye), HexText(camera.look_at),
      HexText(camera.up), camera.fov_deg, sampling.samples,
      sampling.pattern == SamplePattern::kJittered ? "jittered" : "regular", sampling.seed);
}

std::string ToLine(const Violation& v) {
  const char* judge = v.options.judge == JudgeKind::kCertified ? "certified" : "paper";
  const std::string pixel = v.pixel.empty() ? "" : absl::StrCat(" pixel=\"", v.pixel, "\"");
  return absl::StrFormat(
      "scene=\"%s\" origin=%s direction=%s epsilon=%.17g max_depth=%d min_weight=%.17g judge=%s "
      "asked_as=%s%s answer=%s classical=%s error_over_allowed=%.4g",
      v.scene, HexText(v.ray.origin), HexText(v.ray.direction), v.options.max_relative_error,
      v.options.limits.max_depth, v.options.limits.min_weight, judge,
      v.from_frame ? "pixel" : "ray", pixel, HexText(v.answer), HexText(v.classical),
      v.error_over_allowed);
}

}  // namespace linetree
