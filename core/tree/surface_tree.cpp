#include "core/tree/surface_tree.h"

#include <algorithm>
#include <cmath>

#include "core/trace/intersect.h"

namespace linetree {
namespace {

// One point at a time, fewer lights are evaluated one by one as fast.
constexpr size_t kMinLightsWorthASum = 3;

}  // namespace

SurfaceTree::SurfaceTree(const Object& object)
    : object_(object), chart_(object), cells_(chart_.patches()) {
  const int faces = FaceCount(object.shape);
  forms_.reserve(static_cast<size_t>(faces));
  for (int face = 0; face < faces; ++face) forms_.push_back(chart_.FormOf(face));
}

KnownLights SurfaceTree::Find(const Hit& hit, double epsilon, uint32_t now, uint32_t points) const {
  KnownLights known;
  if (!chart_.IsOn(hit.face, hit.point)) return known;
  const SurfacePoint point = chart_.Locate(hit.face, hit.point);
  const SurfaceNode& node = cells_.Find(point.patch, CellAt(point, kMaxSurfaceDepth), now);
  const CellLights* lights = node.payload.get();
  // Many threads meet in few cells: what nobody asks is not counted.
  if (lights == nullptr || lights->WantsSmaller() || node.ahead.load(std::memory_order_relaxed)) {
    node.uses.fetch_add(points, std::memory_order_relaxed);
  }
  if (lights == nullptr || !lights->HoldAt(hit.point)) return known;
  known.lists = lights->lights.data();
  const double scale = std::ldexp(1.0, node.cell.depth);
  const double s = std::clamp(point.u * scale - node.cell.i, 0.0, 1.0);
  const double t = std::clamp(point.v * scale - node.cell.j, 0.0, 1.0);
  if (lights->HasFunctions()) {
    known.shadows = &lights->shadows;
    known.s = static_cast<float>(s);
    known.t = static_cast<float>(t);
  }
  if (epsilon > 0) AddDiffuse(hit, s, t, *lights, epsilon, known);
  return known;
}

void SurfaceTree::AddDiffuse(const Hit& hit, double s, double t, const CellLights& lights,
                             double epsilon, KnownLights& known) const {
  const auto& sums = lights.sums;
  if (!sums[0] && !sums[1]) return;
  if (lights.CountSummed() < kMinLightsWorthASum) return;
  const auto side = SideOf(hit);
  if (!side || !sums[*side] || !(sums[*side]->spread <= epsilon)) return;
  known.has_diffuse = true;
  known.diffuse = sums[*side]->At(s, t);
}

std::optional<size_t> SurfaceTree::SideOf(const Hit& hit) const {
  if (IsPlanar(object_.shape)) return chart_.IsOtherSide(hit.normal) ? 1 : 0;
  if (hit.side != Side::kOutside) return std::nullopt;
  const Vec3d outward = std::visit(
      [&](const auto& s) { return OutwardNormal(s, hit.face, hit.point); }, object_.shape);
  if (!(Dot(outward, hit.normal) > 0)) return std::nullopt;
  return 0;
}

uint64_t SurfaceTree::OwnBytes() const {
  return sizeof(SurfaceTree) - sizeof(cells_) + chart_.HeapBytes() +
         forms_.capacity() * sizeof(SurfaceChart::FaceForm) + cells_.OwnBytes();
}

uint64_t SurfaceTree::CountBytes() const { return OwnBytes() + cells_.Recount().bytes; }

}  // namespace linetree
