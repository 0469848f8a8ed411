// What is certain about the lights above a piece of surface (DESIGN: certified cells, light
// visibility over a patch). No sampling: shafts are convex hulls, and only a separating plane or a
// convex shadow decides.
//
// Why it holds. Every shading point of the piece lies in its patch hull H, and every shadow ray to
// a light at L in conv(H, L). An object that is certainly apart from that set, by a margin far
// above the tracer's rounding, is met by none of them. The points from which a convex object K
// hides L are L + s (K - L), s >= 1, a convex set; if it holds the eight points of H, it holds all
// of H. Directional lights are the limit: conv(H) + half line.
// Every ray from such a point to L crosses K; where H is apart from a solid K and L outside, twice,
// so that what a transparent one leaves of the light is the same for all of H.
//
// Contacts. An object that lies behind a plane, with the light in front of it, hides nothing from
// points in front of the plane, in the tracer's arithmetic too: on their way to the light they move
// away from it, so that the plane's own crossing comes at t < 0 or t > 1 and bounds all others.
// Where a wall stands on the floor, its plane cuts the floor's cells only along their side; they
// are certified for the points that are in front of it by more than rounding.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/trace/light_lists.h"
#include "core/trace/shadow_function.h"
#include "core/trace/tracer.h"
#include "core/tree/candidate_search.h"
#include "core/tree/diffuse_sum.h"
#include "core/tree/face_planes.h"
#include "core/tree/surface_chart.h"

namespace linetree {

// A plane that the piece lies in front of, all but a sliver.
struct Contact {
  Plane plane;
  double clearance;  // world length
};
// A cell in the corner of a room touches three walls; more contacts are not kept.
inline constexpr size_t kMaxContacts = 4;

// A cell is divided for the sake of its sums where they leave out so many lights: a sum costs as
// much as three.
inline constexpr uint32_t kMinUnsummed = 4;

// A light that may reach a piece of surface, and what there is to do about it.
struct LightTask {
  enum class Kind : uint8_t {
    kOn,       // nothing is in between
    kSummed,   // the same, and its diffuse light is in the cell's sums
    kListed,   // `count` opaque objects from `first` on in CellLights::objects may be in between
    kUnknown,  // search the scene
  };
  Kind kind = Kind::kUnknown;
  uint16_t light = 0;
  uint32_t first = 0, count = 0;
};

// The lights as seen from one piece of surface. Movable, not copyable: lists point into `objects`.
struct CellLights {
  CellLights() = default;
  CellLights(CellLights&&) = default;
  CellLights& operator=(CellLights&&) = default;

  std::vector<LightList> lights;
  // Nothing here is said about points that are not in front of all of these by their clearance.
  std::vector<Contact> contacts;
  std::vector<int32_t> objects;  // the candidates of all lights, one after the other
  // Of planar pieces: as many functions as objects, or none at all. `shadows` points into all
  // three.
  std::vector<ShadowFunction> functions;
  std::vector<float> coefficients;
  CellShadows shadows;
  // Those of `lights` that may reach the piece: not kOff, not kFacingAway. For hits whose facing
  // normal is the outward one. The first `rest_of_tasks` are those that are in no sum, then come
  // the others (kSummed), both ascending.
  std::vector<LightTask> tasks;
  uint32_t rest_of_tasks = 0;
  size_t CountSummed() const { return tasks.size() - rest_of_tasks; }
  // The diffuse light of those that are `summed`, on the outside or the side that a planar shape's
  // normal points to, and on its other side. Null: evaluate them one by one.
  std::array<std::unique_ptr<const DiffuseSum>, 2> sums;

  uint64_t HeapBytes() const {
    uint64_t bytes = lights.capacity() * sizeof(LightList) + objects.capacity() * sizeof(int32_t) +
                     contacts.capacity() * sizeof(Contact) +
                     functions.capacity() * sizeof(ShadowFunction) +
                     coefficients.capacity() * sizeof(float) + tasks.capacity() * sizeof(LightTask);
    for (const auto& sum : sums) bytes += sum ? sizeof(DiffuseSum) : 0;
    return bytes;
  }
  // Lights that are on but not in the sums, where the sums of smaller cells could hold them.
  uint32_t unsummed = 0;

  bool HasFunctions() const { return !functions.empty(); }
  // No smaller piece could know more.
  bool IsDecided() const { return undecided_ == 0; }
  // Whether smaller cells would make answers cheaper.
  bool WantsSmaller() const { return unsummed >= kMinUnsummed || !IsDecided(); }
  // Of such a cell: how many times as many points it takes before that is worth its price as where
  // candidates have to be tested. Shadow functions answer at little cost, so what matters is how
  // many lights a division could decide, against the price of four cells. 1 at least.
  double Patience() const;
  // Finds out what IsDecided and Patience need, when what is known of the lights and the functions
  // are final.
  void Weigh();
  // Sets `tasks`, when all else is final.
  void MakeTasks(const Scene& scene);
  // Whether what is said holds at a point of the piece.
  bool HoldAt(const Vec3d& point) const {
    return std::all_of(contacts.begin(), contacts.end(), [&](const Contact& contact) {
      return SignedDistance(contact.plane, point) > contact.clearance;
    });
  }

 private:
  // Whether rays are tested against objects for this light, which is one of `lights`.
  bool IsTested(const LightList& list) const;

  // Of `lights`: those that are on, those that are undecided, whether some are tested.
  uint32_t on_ = 0, undecided_ = 0;
  bool is_tested_ = false;
};

// What arrives of one light at all points of a hull.
struct LightArrival {
  LightKnowledge knowledge = LightKnowledge::kUnknown;
  Rgb filter{1, 1, 1};  // kOn: what is left by transparent objects, which every shadow ray crosses
};

class LightBundle;
struct LightFindings;

class LightCertifier {
 public:
  // Keeps a reference to the tracer, which must outlive it. Without `uses_functions` planar cells
  // are treated like curved ones, to compare with.
  explicit LightCertifier(const Tracer& tracer, bool uses_functions = true);

  // Which it searches occluders with.
  const CandidateSearch& search() const { return search_; }

  // Knowledge about a cell of the given object's chart. With `parent`, what is known of a larger
  // cell that contains it, only that one's candidates are looked at.
  CellLights Certify(int object, const SurfaceChart& chart, int patch, const SurfaceCell& cell,
                     const CellLights* parent) const;

  // The same for one light without a parent, and without the candidates.
  LightArrival ArrivalOf(int object, const PatchHull& hull, int light) const;

 private:
  // One light of the cell, of which `list` says what is inherited, and then what is known. What is
  // found out is added to `findings`.
  void CertifyLight(LightBundle& bundle, LightList& list, LightFindings& findings) const;
  // What may block, as FindCandidates left it, decides.
  LightKnowledge Decide(const LightBundle& bundle, LightFindings& findings) const;
  void FindCandidates(LightBundle& bundle, const LightList& inherited,
                      LightFindings& findings) const;
  // Both set the function of what is kept, which has no pieces before, where there is one.
  bool KeepsMeeting(LightBundle& bundle, size_t index, LightFindings& findings,
                    ShadowFunction& function) const;
  bool MayBlock(LightBundle& bundle, int object, LightFindings& findings,
                ShadowFunction& function) const;
  // Whether the object lies behind a plane that the light and the hull are in front of, but for
  // contacts.
  bool LiesBehind(LightBundle& bundle, int object, LightFindings& findings) const;
  // What the object's shadow function says, which is built if there is one, as ShadowBuilder has
  // it.
  Shadowing ShadowOf(LightBundle& bundle, int object, LightFindings& findings,
                     ShadowFunction& function) const;
  // World length.
  double ClearanceTo(LightBundle& bundle, int object) const;
  // Whether the shadow rays of all points of the hull cross the object.
  bool IsCrossedByAll(const LightBundle& bundle, int object) const;
  // How often they all do; 0 where that is not certain.
  int CrossingsOfAll(LightBundle& bundle, int object) const;
  // Whether the object hides the light from every point of the hull.
  bool HidesAll(const LightBundle& bundle, int object) const;

  const Tracer& tracer_;
  const Scene& scene_;
  Box3 world_;
  const bool uses_functions_;
  CandidateSearch search_;
  // By object:
  std::vector<FacePlanes> planes_;
  std::vector<double> clearances_;  // world length, for rounding of distances from it
};

}  // namespace linetree
