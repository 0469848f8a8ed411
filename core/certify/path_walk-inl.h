// Follows the paths of one cell in jets. See path_certifier.h.
#if defined(LINETREE_CORE_CERTIFY_PATH_WALK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef LINETREE_CORE_CERTIFY_PATH_WALK_INL_H_
#undef LINETREE_CORE_CERTIFY_PATH_WALK_INL_H_
#else
#define LINETREE_CORE_CERTIFY_PATH_WALK_INL_H_
#endif

#include "core/certify/cell_paths.h"
#include "core/certify/hit_evaluator-inl.h"
#include "core/certify/light_terms-inl.h"
#include "core/certify/path_certifier.h"
#include "core/certify/radiance_sum-inl.h"
#include "core/certify/ray_bundle.h"
#include "core/trace/shade.h"

LINETREE_BEFORE_JETS();
namespace linetree::LINETREE_JETS {

class PathWalk {
 public:
  using Jet = CornerJet<4>;
  using Vector = JetVector<4>;

  PathWalk(const PathCertifier::Context& context, const PathCertifier::Task& task)
      : context_(context), task_(task), terms_(context, sum_) {}

  CellPaths Run() {
    JetHit<4> hit;
    Vector direction;
    const Hit middle = context_.tracer.IntersectObjectLine(task_.object, task_.middle.origin,
                                                           task_.middle.direction);
    if (!middle.IsHit() || !FirstHit(middle, hit, direction)) {
      Refuse(Doubt::kFirstFace);
      return std::move(paths_);
    }
    paths_.decided = true;
    PathStep eye;
    SetEnd(middle, eye);
    paths_.steps.push_back(eye);
    Leg leg;
    leg.direction = direction;
    leg.reach = MaxHitDistance(context_.scene.objects[static_cast<size_t>(task_.object)]);
    leg.middle = task_.middle.direction;
    if (task_.parent != nullptr && !task_.parent->steps.empty()) {
      leg.inherited = &task_.parent->steps[0];
    }
    LeaveSurface(hit, middle, leg, 0);
    Finish();
    return std::move(paths_);
  }

 private:
  // All rays of the cell at one place of the path.
  struct Leg {
    Vector origin, direction;     // the direction is of unit length
    Vec3d middle_origin, middle;  // the same of the centre ray, as the classical tracer has it
    RayStart start;
    int depth = 1;
    double weight = 1, reach = 0;         // the latter: how far off or out they begin
    Rgb colour{1, 1, 1};                  // product of the coefficients on the way
    const PathStep* inherited = nullptr;  // of the parent cell
  };

  static void SetEnd(const Hit& hit, PathStep& step) {
    step.object = hit.object;
    step.face = hit.face;
    step.side = hit.side;
  }

  void Refuse(Doubt reason) {
    if (!MayInterpolate()) return;
    paths_.doubt = reason;
    paths_.verdict = VerdictOf(reason);
  }
  bool MayInterpolate() const { return paths_.verdict == Verdict::kUntried; }
  static Verdict VerdictOf(Doubt doubt) {
    switch (doubt) {
      case Doubt::kNone:
        return Verdict::kUntried;
      case Doubt::kFirstFace:
      case Doubt::kBranchFace:
        return Verdict::kGap;
      case Doubt::kBetween:
      case Doubt::kShadow:
      case Doubt::kTooLong:
        return Verdict::kBlocker;
      case Doubt::kRefraction:
        return Verdict::kFunnel;
      case Doubt::kBound:
        return Verdict::kPeak;
    }
    return Verdict::kUntried;
  }

  static Vector Polynomial(const Vec3d& constant, const std::array<Vec3d, 4>& by,
                           const CellBox& box) {
    const auto along = [&](double Vec3d::*axis) {
      std::array<double, 4> coefficients;
      for (size_t i = 0; i < 4; ++i) coefficients[i] = by[i].*axis;
      return Jet::Affine(constant.*axis, coefficients, box.from, box.to);
    };
    return {along(&Vec3d::x), along(&Vec3d::y), along(&Vec3d::z)};
  }

  // The cell's rays at the object itself. The face is that of the centre ray; rays that meet others
  // are told apart when they are traced (PathStep::EndsAt).
  bool FirstHit(const Hit& middle, JetHit<4>& hit, Vector& direction) {
    JetRay<4> ray;
    ray.origin = Polynomial(task_.form.origin, task_.form.origin_by, task_.box);
    ray.direction = Polynomial(task_.form.direction, task_.form.direction_by, task_.box);
    ray.between_planes = task_.form.between_planes;
    const JetShape& shape = context_.shapes[static_cast<size_t>(task_.object)];
    const HitEvaluator<4> evaluator(ray);
    const bool meets = shape.IsThin()
                           ? evaluator.EvaluateOnPlane(shape, hit)
                           : evaluator.Evaluate(shape, middle.face, middle.side, -1, hit);
    if (!meets) return false;
    // Jets of the square may reach down to zero; no direction is shorter than its part along the
    // axis.
    Jet square = LengthSquared(ray.direction);
    const double least = task_.form.along_axis * task_.form.along_axis * (1 - 0x1p-40);
    square.AssumeWithin(least, std::max(least, square.hi()));
    if (!(square.lo() > 0)) return false;
    const Jet inverse_length = InverseSquareRoot(square);
    direction = ray.direction * inverse_length;
    hit.cosine = hit.cosine * inverse_length;
    hit.cosine.AssumeWithin(0, 1);
    if (!shape.IsThin() && !evaluator.IsContained(hit)) Refuse(Doubt::kFirstFace);
    return true;
  }

  // What the surface adds, and the branches that leave it; `step` is the one that ends here.
  void LeaveSurface(const JetHit<4>& hit, const Hit& middle, const Leg& leg, size_t step) {
    const Material& material = context_.scene.MaterialOf(middle.object);
    if (MayInterpolate()) AddTerms(hit, middle, leg, material);
    const bool reflects = task_.limits.Allow(leg.depth, leg.weight, material.reflect);
    const bool transmits = task_.limits.Allow(leg.depth, leg.weight, material.transmit);
    bool total_reflection = false;
    if ((transmits || reflects) &&
        !IsAboveRounding(hit.point, std::max(leg.reach, hit.shape->reach))) {
      Refuse(Doubt::kBound);
      return;
    }
    if (transmits) {
      Vector refracted;
      Vec3d middle_refracted;
      switch (Refract(hit, middle, leg, material, refracted, middle_refracted)) {
        case Refraction::kRefracted:
          Transmit(hit, middle, leg, material, refracted, middle_refracted, step);
          break;
        case Refraction::kTotal:
          total_reflection = true;
          break;
        case Refraction::kUnknown:
          paths_.decided = false;
          Refuse(Doubt::kRefraction);
          break;
      }
    }
    if (total_reflection || reflects) {
      Leg next = NextLeg(hit, middle, leg, {middle.object, middle.face, middle.side});
      next.direction = leg.direction + hit.NormalTimes(hit.cosine * 2.0);
      next.middle = Reflected(leg.middle, middle.normal);
      if (!total_reflection) {
        next.weight = leg.weight * MaxChannel(material.reflect);
        next.colour = leg.colour * material.reflect;
      }
      next.inherited = ChildOf(leg.inherited, middle, &PathStep::reflected);
      const int32_t child = Follow(next);
      paths_.steps[step].reflected = child == 0 ? 0 : child - static_cast<int32_t>(step);
    }
  }

  void AddTerms(const JetHit<4>& hit, const Hit& middle, const Leg& leg, const Material& material) {
    sum_.AddConstant(leg.colour * AmbientTerm<double>(material, context_.scene.ambient));
    if (!UsesLights(material)) return;
    const Doubt doubt =
        terms_.Add(hit, leg.direction, middle.object, leg.colour, CloudOf(hit.point));
    if (doubt != Doubt::kNone) Refuse(doubt);
  }

  void Transmit(const JetHit<4>& hit, const Hit& middle, const Leg& leg, const Material& material,
                const Vector& direction, const Vec3d& middle_direction, size_t step) {
    const bool into = middle.side == Side::kOutside && !hit.shape->IsThin();
    Leg next = NextLeg(hit, middle, leg,
                       {middle.object, middle.face, into ? Side::kInside : Side::kOutside});
    next.direction = direction;
    next.middle = middle_direction;
    next.weight = leg.weight * MaxChannel(material.transmit);
    next.colour = leg.colour * material.transmit;
    next.inherited = ChildOf(leg.inherited, middle, &PathStep::transmitted);
    const int32_t child = Follow(next);
    paths_.steps[step].transmitted = child == 0 ? 0 : child - static_cast<int32_t>(step);
  }

  static Leg NextLeg(const JetHit<4>& hit, const Hit& middle, const Leg& leg,
                     const RayStart& start) {
    Leg next;
    next.origin = hit.point;
    next.middle_origin = middle.point;
    next.start = start;
    next.reach = hit.shape->reach;
    next.depth = leg.depth + 1;
    next.weight = leg.weight;
    next.colour = leg.colour;
    return next;
  }
  // The parent's step for what leaves from `middle`; none where its own centre ray ends elsewhere.
  static const PathStep* ChildOf(const PathStep* step, const Hit& middle,
                                 int32_t PathStep::*child) {
    if (step == nullptr || !step->EndsAt(middle) || step->*child == 0) return nullptr;
    return step + step->*child;
  }

  enum class Refraction { kRefracted, kTotal, kUnknown };

  Refraction Refract(const JetHit<4>& hit, const Hit& middle, const Leg& leg,
                     const Material& material, Vector& refracted, Vec3d& middle_refracted) {
    const Shape& shape = context_.scene.objects[static_cast<size_t>(middle.object)].shape;
    if (!IsSolid(shape)) {
      refracted = leg.direction;
      middle_refracted = leg.middle;
      return Refraction::kRefracted;
    }
    double around = 1;
    if (!IorAround(middle.object, hit.point, around)) return Refraction::kUnknown;
    const bool entering = middle.side == Side::kOutside;
    const double from = entering ? around : material.ior;
    const double into = entering ? material.ior : around;
    const auto direction = Refracted(leg.middle, middle.normal, from, into);
    if (from == into) {
      refracted = leg.direction;
    } else {
      const double eta = from / into;
      Jet square = (Square(hit.cosine) + -1.0) * (eta * eta) + 1.0;
      if (eta < 1) square.AssumeWithin(1 - eta * eta, 1);
      if (IsNegative(square, 1)) return Refraction::kTotal;
      if (!IsPositive(square, 1)) return Refraction::kUnknown;
      const Jet across = hit.cosine * eta - SquareRoot(square);
      refracted = leg.direction * eta + hit.NormalTimes(across);
    }
    if (!direction) return Refraction::kUnknown;
    middle_refracted = *direction;
    return Refraction::kRefracted;
  }

  // Media::IorAround for all points at once; false when that depends on the point.
  bool IorAround(int object, const Vector& point, double& ior) const {
    ior = 1;
    const auto neighbours = context_.tracer.media().Neighbours(object);
    if (neighbours.empty()) return true;
    const PointCloud cloud = CloudOf(point);
    for (const int32_t other : neighbours) {
      const Shape& shape = context_.scene.objects[static_cast<size_t>(other)].shape;
      if (IsCertainlyOutside(cloud, shape, context_.search().Surplus(other))) continue;
      if (!IsCertainlyInside(cloud, shape)) return false;
      ior = context_.scene.MaterialOf(other).ior;
      return true;
    }
    return true;
  }

  // Where the jets put the points of a bundle: the interpolant of the corners lies in their hull,
  // and what is curved to one side lies to one side of that: the corners are moved to the middle
  // between the bounds.
  static PointCloud CloudOf(const Vector& v) {
    PointCloud cloud;
    double square = 0;
    for (const int axis : {0, 1, 2}) {
      const Jet& c = axis == 0 ? v.x : axis == 1 ? v.y : v.z;
      const double over = c.ExcessOverQ(), under = c.ExcessUnderQ();
      const double shift = (over - under) / 2;
      double corners[16];
      c.k.Store(corners);
      for (size_t m = 0; m < 16; ++m) cloud.points[m][axis] = corners[m] + shift;
      const double off = (over + under) / 2 + c.slack + kDrift * c.Variation() +
                         2 * kOutward * (c.v.Magnitude() + std::abs(shift));
      square += off * off;
    }
    cloud.slack = RoundUp(std::sqrt(Above(square)));
    return cloud;
  }

  // The step of a branch, as an index; 0 where the limit of steps leaves no room.
  int32_t Follow(const Leg& leg) {
    if (paths_.steps.size() >= kMaxPathSteps) {
      Refuse(Doubt::kTooLong);
      return 0;
    }
    const auto index = paths_.steps.size();
    paths_.steps.emplace_back();
    const std::span<const int32_t>* inherited =
        leg.inherited != nullptr && leg.inherited->listed ? &leg.inherited->candidates : nullptr;
    const Hit middle =
        inherited != nullptr
            ? context_.tracer.IntersectAmong(*inherited, leg.middle_origin, leg.middle, leg.start)
            : context_.tracer.Intersect(leg.middle_origin, leg.middle, leg.start);
    JetRay<4> ray{leg.origin, leg.direction, false};
    const HitEvaluator<4> evaluator(ray);
    JetHit<4> hit;
    bool meets = false, certain = !middle.IsHit();
    if (middle.IsHit()) {
      const bool own = middle.object == leg.start.object;
      meets = evaluator.Evaluate(context_.shapes[static_cast<size_t>(middle.object)], middle.face,
                                 middle.side, own ? leg.start.face : -1, hit);
      certain =
          meets && evaluator.IsContained(hit) &&
          IsFirst(middle, leg, context_.scene.objects[static_cast<size_t>(middle.object)].shape);
    }
    List(leg, certain, middle, hit, inherited, index);
    if (!middle.IsHit()) {
      if (MayInterpolate()) sum_.AddConstant(leg.colour * context_.scene.background);
      return static_cast<int32_t>(index);
    }
    if (!meets) return static_cast<int32_t>(index);
    SetEnd(middle, paths_.steps[index]);
    hit.cosine.AssumeWithin(0, 1);
    LeaveSurface(hit, middle, leg, index);
    return static_cast<int32_t>(index);
  }

  // Whether a hit is the first crossing of its object by all rays that meet it there. Hits of the
  // outside are, and those of an open frustum's inner side that are contained
  // (JetHit::behind_wall); the far side of a solid is met first only by rays that start inside.
  static bool IsFirst(const Hit& middle, const Leg& leg, const Shape& shape) {
    if (middle.side == Side::kOutside || middle.object == leg.start.object) return true;
    return !IsSolid(shape) || IsCertainlyInside(CloudOf(leg.origin), shape);
  }

  // Fills in what the rays of a branch can meet. `certain`: nothing but `hit`, or nothing at all,
  // unless something is in between.
  void List(const Leg& leg, bool certain, const Hit& middle, const JetHit<4>& hit,
            const std::span<const int32_t>* inherited, size_t index) {
    const bool ends = certain && middle.IsHit();
    const double far =
        Length(context_.world.Extent()) + Length(leg.middle_origin - context_.world.Center());
    const auto at = [&](double share) {
      if (!ends) return CloudOf(Vector(leg.origin + leg.direction * (far * share)));
      return CloudOf(Vector(leg.origin * (1 - share) + hit.point * share));
    };
    const PointCloud begin = CloudOf(leg.origin);
    const PointCloud end = ends ? CloudOf(hit.point) : at(1);
    if (!begin.IsFinite() || !end.IsFinite()) {
      paths_.decided = false;
      Refuse(Doubt::kBound);
      return;
    }
    const RayBundle bundle(context_.scene, context_.search(), leg.start, begin, end, at);
    std::vector<int32_t> candidates =
        bundle.Candidates(ends ? middle.object : kNoObject, inherited);
    if (!certain || !candidates.empty()) {
      paths_.decided = false;
      Refuse(certain ? Doubt::kBetween : Doubt::kBranchFace);
    }
    if (candidates.size() > kMaxCandidates) return;
    if (ends) {
      candidates.insert(std::lower_bound(candidates.begin(), candidates.end(), middle.object),
                        middle.object);
    }
    PathStep& step = paths_.steps[index];
    step.listed = true;
    lists_.push_back({index, paths_.objects.size(), candidates.size()});
    paths_.objects.insert(paths_.objects.end(), candidates.begin(), candidates.end());
  }

  void Finish() {
    paths_.steps.shrink_to_fit();
    paths_.objects.shrink_to_fit();
    const std::span<const int32_t> all(paths_.objects);
    for (const ListOf& list : lists_) {
      paths_.steps[list.step].candidates = all.subspan(list.begin, list.count);
    }
    if (!MayInterpolate()) return;
    paths_.spread = sum_.Spread(context_.floor);
    paths_.verdict = Verdict::kCertified;
    paths_.interpolant = std::make_unique<Interpolant>(sum_.ToInterpolant());
  }

  struct ListOf {
    size_t step, begin, count;
  };

  const PathCertifier::Context& context_;
  const PathCertifier::Task& task_;
  CellPaths paths_;
  std::vector<ListOf> lists_;
  RadianceSum<4> sum_;
  LightTerms<4> terms_;
};

inline CellPaths CertifyPaths(const PathCertifier::Context& context,
                              const PathCertifier::Task& task) {
  return PathWalk(context, task).Run();
}

}  // namespace linetree::LINETREE_JETS
LINETREE_AFTER_JETS();

#endif
