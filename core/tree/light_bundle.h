// What LightCertifier works with while it looks at one cell: the shadow rays to one light, what the
// lights above the cell ask of the same objects again and again, and what has come up so far.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/tree/candidate_search.h"
#include "core/tree/face_planes.h"
#include "core/tree/light_certifier.h"
#include "core/tree/separation.h"
#include "core/tree/surface_chart.h"

namespace linetree {

// The shadow rays from one hull to one light, which Aim says. What not every light needs is
// computed when it is asked for.
class LightBundle {
 public:
  // Keeps references.
  LightBundle(int self_object, const PatchHull& patch, const Box3& world)
      : self(self_object), hull(patch), world_(world) {
    std::copy(patch.points.begin(), patch.points.end(), points.begin());
    for (const Vec3d& p : patch.points) from_.Add(p);
  }

  void Aim(int light_index, const Light& light_source) {
    light = light_index;
    source = &light_source;
    is_reached_ = false;
    if (IsPoint()) points[8] = light_source.position;
  }

  bool IsPoint() const { return source->kind == LightKind::kPoint; }
  // Two boxes whose hull holds all shadow rays, as far as there are objects.
  const Box3& From() const { return from_; }
  const Box3& To() {
    Reach();
    return to_;
  }
  // By so much rays must clear objects, the objects' own surplus apart. World length.
  double Clearance() {
    Reach();
    return clearance_;
  }

  const int self;
  int light = 0;
  const PatchHull& hull;
  const Light* source = nullptr;
  std::array<Vec3d, 9> points;  // the hull and, for a point light, the light

 private:
  void Reach() {
    if (is_reached_) return;
    is_reached_ = true;
    to_ = Box3();
    if (IsPoint()) {
      to_.Add(source->position);
    } else {
      // Far enough to pass everything in the world's box.
      const double reach = Length(world_.Extent()) + Length(from_.Center() - world_.Center());
      for (const Vec3d& p : hull.points) to_.Add(p + source->to_light * reach);
    }
    Box3 all = from_;
    all.Add(to_);
    clearance_ = ClearanceOf(all);
  }

  const Box3& world_;
  bool is_reached_ = false;
  Box3 from_, to_;
  double clearance_ = 0;
};

// The least and the largest signed distance of a hull's points from a plane.
struct Heights {
  double low = Box3::kInf, high = -Box3::kInf;
};
inline Heights HeightsOf(const PatchHull& hull, const Plane& plane) {
  Heights heights;
  for (const Vec3d& p : hull.points) {
    const double height = SignedDistance(plane, p);
    heights.low = std::min(heights.low, height);
    heights.high = std::max(heights.high, height);
  }
  return heights;
}

// What a hull has to do with objects, whatever the light: many lights ask about few objects.
// Computed when asked for; answers are those that computing anew would give.
class HullViews {
 public:
  // Of this hull, which must outlive the questions, from now on.
  void Begin(const PatchHull& hull) {
    hull_ = &hull;
    objects_.fill(kNoObject);
  }

  // Above the object's planes.faces[face].
  Heights HeightsAbove(int object, const FacePlanes& planes, size_t face) {
    const Plane& plane = planes.faces[face];
    if (face >= kFaces) return HeightsOf(*hull_, plane);
    View& view = ViewOf(object);
    if ((view.known_faces >> face & 1) == 0) {
      view.known_faces |= 1u << face;
      view.heights[face] = HeightsOf(*hull_, plane);
    }
    return view.heights[face];
  }
  // CertainlyApart of the hull and the object, for whose margins what is apart by more is apart.
  bool IsApart(int object, const Shape& shape, double margin) {
    View& view = ViewOf(object);
    if (margin <= view.apart_by) return true;
    if (margin >= view.within) return false;
    const bool is_apart = CertainlyApart(hull_->points, shape, margin);
    (is_apart ? view.apart_by : view.within) = margin;
    return is_apart;
  }

 private:
  static constexpr size_t kFaces = 6;   // of a box
  static constexpr size_t kViews = 32;  // a power of two
  struct View {
    uint32_t known_faces = 0;
    double apart_by = -1, within = Box3::kInf;
    std::array<Heights, kFaces> heights;
  };

  // Objects that share a place drive each other out.
  View& ViewOf(int object) {
    const size_t place = static_cast<size_t>(object) % kViews;
    View& view = views_[place];
    if (objects_[place] != object) {
      objects_[place] = object;
      view.known_faces = 0;
      view.apart_by = -1;
      view.within = Box3::kInf;
    }
    return view;
  }

  const PatchHull* hull_ = nullptr;
  std::array<int32_t, kViews> objects_{};  // of views_
  std::array<View, kViews> views_;
};

// What comes up while the lights' candidates are looked at, light after light. Without `is_cell`
// what is said holds everywhere, and there are no functions. One that has been used before has room
// already: nothing is allocated while lights are looked at.
struct LightFindings {
  bool is_cell = false;
  const SurfaceChart::PlanarCell* plane = nullptr;  // null: no functions
  const CellLights* parent = nullptr;
  int child = -1;  // of the parent's cell; -1: it has no functions
  // Whether functions that say anything are built anew, rather than divided.
  bool builds_anew = false;
  HullViews views{};
  // Of the cell, as in CellLights.
  std::vector<Contact> contacts{};
  std::vector<int32_t> objects{};
  std::vector<ShadowFunction> functions{};
  std::vector<float> coefficients{};
  struct Listed {
    size_t light, begin;  // where its candidates begin
  };
  std::vector<Listed> listed{};
  // Of one light:
  std::vector<int32_t> kept{};
  std::vector<std::pair<int32_t, ShadowFunction>> own_functions{};  // of objects that have one
  int32_t occluder = kNoObject;                                     // hides it from the whole piece

  void BeginCell(const PatchHull& hull, const SurfaceChart::PlanarCell* planar,
                 const CellLights* larger) {
    is_cell = true;
    plane = planar;
    parent = larger;
    child = -1;
    builds_anew = false;
    views.Begin(hull);
    contacts.clear();
    objects.clear();
    functions.clear();
    coefficients.clear();
    listed.clear();
  }
  void BeginLight() {
    kept.clear();
    own_functions.clear();
    occluder = kNoObject;
  }
  // Null when the object has none.
  const ShadowFunction* FunctionOf(int32_t object) const {
    const auto it = std::find_if(own_functions.begin(), own_functions.end(),
                                 [&](const auto& entry) { return entry.first == object; });
    return it == own_functions.end() ? nullptr : &it->second;
  }
  // Whether what is known of a shadow settles the object; whether it is kept is then in `keep`.
  bool Take(int32_t object, const CellShadow& shadow, bool& keep) {
    if (shadow.everywhere == Shadowing::kBlocks) occluder = object;
    if (shadow.function.pieces > 0) own_functions.emplace_back(object, shadow.function);
    keep = shadow.everywhere != Shadowing::kMisses;
    return !keep || occluder != kNoObject || shadow.function.pieces > 0;
  }
};

}  // namespace linetree
