// What LightCertifier works with while it looks at one cell: the shadow rays to one light, what the
// lights above the cell ask of the same objects again and again, and what has come up so far.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/tree/candidate_search.h"
#include "core/tree/face_planes.h"
#include "core/tree/light_certifier.h"
#include "core/tree/separation.h"
#include "core/tree/shadow_quarters.h"
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
    Vec3d sum;
    for (const Vec3d& p : patch.points) {
      from_.Add(p);
      sum = sum + p;
    }
    middle = sum * (1.0 / static_cast<double>(patch.points.size()));
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
  Vec3d middle;  // of the hull
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

  // CertainlyApart of the object and a bundle of which the hull is a part, as for many lights,
  // which are often on the same side of the object.
  bool IsBundleApart(int object, const Shape& shape, std::span<const Vec3d> points, double margin) {
    return CertainlyApart(points, shape, margin, ViewOf(object).normal);
  }

 private:
  static constexpr size_t kFaces = 6;   // of a box
  static constexpr size_t kViews = 32;  // a power of two
  struct View {
    uint32_t known_faces = 0;
    double apart_by = -1, within = Box3::kInf;
    Vec3d normal;  // has separated a bundle from it; or 0
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
      view.normal = {};
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
  ShadowQuarters quarters{};  // of the parent's functions, if it has some
  // Of the cell, as in CellLights; functions without pieces where there are none. Fields are set
  // where they are to stay: what has just been written byte by byte is slow to be copied as a
  // whole.
  std::vector<Contact> contacts{};
  std::vector<int32_t> objects{};
  std::vector<ShadowFunction> functions{};
  std::vector<float> coefficients{};
  struct Listed {
    size_t light, begin;  // where its candidates begin
  };
  std::vector<Listed> listed{};
  // Of one light: its candidates are the objects from `first` on.
  size_t first = 0, first_coefficient = 0;
  int32_t occluder = kNoObject;  // hides it from the whole piece
  bool may_hide_all = false;     // false: no candidate can hide it from the whole piece
  // Of those that a search finds, in its order.
  std::vector<std::pair<int32_t, ShadowFunction>> found_functions{};

  void BeginHull(const PatchHull& hull) {
    views.Begin(hull);
    contacts.clear();
    objects.clear();
    functions.clear();
    coefficients.clear();
    listed.clear();
  }
  void BeginCell(const PatchHull& hull, const SurfaceChart::PlanarCell* planar,
                 const CellLights* larger) {
    BeginHull(hull);
    is_cell = true;
    plane = planar;
    parent = larger;
    child = -1;
    builds_anew = false;
  }
  void BeginLight() {
    first = objects.size();
    first_coefficient = coefficients.size();
    occluder = kNoObject;
    may_hide_all = false;
    found_functions.clear();
  }
  // Forgets the light's candidates.
  void DropLight() {
    objects.resize(first);
    functions.resize(first);
    coefficients.resize(first_coefficient);
  }
  std::span<const int32_t> Candidates() const { return std::span(objects).subspan(first); }
  void AddFound(int32_t object) {
    const auto it = std::find_if(found_functions.begin(), found_functions.end(),
                                 [&](const auto& entry) { return entry.first == object; });
    objects.push_back(object);
    functions.push_back(it->second);
  }
  // Whether what is known of a shadow settles the object; whether it is kept is then in `keep`.
  bool Take(int32_t object, Shadowing everywhere, const ShadowFunction& function, bool& keep) {
    if (everywhere == Shadowing::kBlocks) occluder = object;
    keep = everywhere != Shadowing::kMisses;
    return !keep || occluder != kNoObject || function.pieces > 0;
  }
};

}  // namespace linetree
