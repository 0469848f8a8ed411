// Planted errors: what an audit must find, and what it must not call an error.
#include "core/audit/audit_scene.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/audit/scene_families.h"

namespace linetree {
namespace {

SceneAuditRequest RequestOf(SceneFamily family, std::vector<double> epsilons,
                            uint64_t queries = 8000) {
  SceneAuditRequest request;
  request.scene = MakeFamilyScene(family, 5);
  request.name = request.scene->name;
  request.queries = queries;
  request.epsilons = std::move(epsilons);
  return request;
}

SceneAudit Audited(const SceneAuditRequest& request, Answerer& answerer) {
  WorkerPool pool(2);
  auto audit = AuditScene(request, answerer, pool);
  EXPECT_TRUE(audit.ok()) << audit.status();
  return *std::move(audit);
}

// Spoils one answered ray in `every`, and counts those.
class Spoiler : public Answerer {
 public:
  Spoiler(size_t every, std::function<Rgb(const Ray&, const Rgb&)> spoil)
      : every_(every), spoil_(std::move(spoil)) {}

  absl::StatusOr<RayBatch> TraceRays(SceneHost& host, const std::vector<Ray>& rays,
                                     const RenderOptions& options, WorkerPool& pool) override {
    auto batch = host.TraceRays(rays, options, pool);
    for (size_t i = 0; i < rays.size(); ++i) {
      if (seen_++ % every_ != 0) continue;
      ++spoilt_;
      batch->answers[i].radiance = spoil_(rays[i], batch->answers[i].radiance);
    }
    return batch;
  }
  uint64_t spoilt() const { return spoilt_; }

 private:
  const size_t every_;
  const std::function<Rgb(const Ray&, const Rgb&)> spoil_;
  uint64_t seen_ = 0, spoilt_ = 0;
};

// Off by `errors` times what epsilon allows, in one channel.
std::function<Rgb(const Ray&, const Rgb&)> OffBy(double errors, double epsilon, double floor) {
  return [=](const Ray&, Rgb radiance) {
    radiance.g += errors * epsilon * std::max(radiance.g, floor);
    return radiance;
  };
}

TEST(AuditSceneTest, FindsEveryAnswerThatIsOffByTwoEpsilon) {
  for (const double epsilon : {0.02, 0.25}) {
    const auto request = RequestOf(SceneFamily::kGeneric, {epsilon});
    Spoiler spoiler(97, OffBy(2, epsilon, RadianceFloor(*request.scene)));
    const SceneAudit audit = Audited(request, spoiler);
    EXPECT_GT(spoiler.spoilt(), 40u);
    EXPECT_EQ(audit.by_epsilon[0].violations, spoiler.spoilt());
    // The answers that were spoilt may have been off themselves, by epsilon at most.
    EXPECT_NEAR(audit.by_epsilon[0].max_error_over_allowed, 2, 1);
    ASSERT_EQ(audit.violations.size(), request.max_violations);
    EXPECT_EQ(audit.violations[0].scene, request.scene->name);
    EXPECT_EQ(audit.violations[0].options.max_relative_error, epsilon);
  }
}

TEST(AuditSceneTest, ErrorsWithinEpsilonAreNoViolations) {
  const auto request = RequestOf(SceneFamily::kGeneric, {0.02, 0.1});
  Spoiler spoiler(3, OffBy(0.5, 0.02, RadianceFloor(*request.scene)));
  const SceneAudit audit = Audited(request, spoiler);
  EXPECT_EQ(audit.by_epsilon[0].violations + audit.by_epsilon[1].violations, 0u);
  EXPECT_NEAR(audit.by_epsilon[0].max_error_over_allowed, 0.75, 0.25 + 1e-9);
  EXPECT_LT(audit.by_epsilon[0].equal, audit.by_epsilon[0].queries);
}

TEST(AuditSceneTest, AtEpsilonZeroABitIsAViolation) {
  const auto request = RequestOf(SceneFamily::kWalls, {0});
  Spoiler spoiler(101, [](const Ray&, Rgb radiance) {
    radiance.b = std::nextafter(radiance.b, 10.0);
    return radiance;
  });
  const SceneAudit audit = Audited(request, spoiler);
  EXPECT_EQ(audit.by_epsilon[0].violations, spoiler.spoilt());
  EXPECT_EQ(audit.by_epsilon[0].equal + spoiler.spoilt(), audit.by_epsilon[0].queries);
}

TEST(AuditSceneTest, FindsWhatIsNotANumber) {
  const auto request = RequestOf(SceneFamily::kTubes, {0.25});
  Spoiler spoiler(500, [](const Ray&, const Rgb&) {
    return Rgb{std::numeric_limits<double>::quiet_NaN(), 0, 0};
  });
  const SceneAudit audit = Audited(request, spoiler);
  EXPECT_GT(spoiler.spoilt(), 5u);
  EXPECT_EQ(audit.by_epsilon[0].violations, spoiler.spoilt());
}

TEST(AuditSceneTest, FindsPixelsThatAreOff) {
  class DarkPixel : public Answerer {
    absl::StatusOr<Frame> RenderFrame(SceneHost& host, const FrameRequest& request,
                                      WorkerPool& pool) override {
      auto frame = host.RenderFrame(request, pool);
      frame->radiance[frame->radiance.size() / 2] -= 1;
      return frame;
    }
  } answerer;
  const auto request = RequestOf(SceneFamily::kGeneric, {0, 0.1});
  const SceneAudit audit = Audited(request, answerer);
  EXPECT_EQ(audit.by_kind[static_cast<size_t>(QueryKind::kFrame)].violations, 8u);
  EXPECT_TRUE(audit.violations[0].from_frame);
}

// As if a certificate had dropped an object from its candidates: it is seen, but shadows none.
class DropsOccluder : public Answerer {
 public:
  absl::StatusOr<RayBatch> TraceRays(SceneHost& host, const std::vector<Ray>& rays,
                                     const RenderOptions& options, WorkerPool& pool) override {
    auto batch = host.TraceRays(rays, options, pool);
    const Scene& scene = host.scene();
    const auto dropped = static_cast<int32_t>(scene.objects.size()) - 1;
    std::vector<int32_t> others;
    for (int32_t i = 0; i < dropped; ++i) others.push_back(i);
    for (size_t i = 0; i < rays.size(); ++i) {
      const RayAnswer& answer = batch->answers[i];
      if (answer.object == kNoObject || answer.object == dropped) continue;
      const Ray ray = *UnitRay(rays[i], i);
      const Hit hit = host.tracer().Intersect(ray.origin, ray.direction, RayStart{});
      const RayStart start{hit.object, hit.face, hit.side};
      for (int light = 0; light < static_cast<int>(scene.lights.size()); ++light) {
        const Rgb full = host.tracer().CastShadow(hit.point, light, start).filter;
        const Rgb less = host.tracer().CastShadowAmong(others, hit.point, light, start).filter;
        if (full == less) continue;
        const Material& material = scene.MaterialOf(hit.object);
        batch->answers[i].radiance += less * material.diffuse;
        ++wrong_;
      }
    }
    return batch;
  }
  uint64_t wrong() const { return wrong_; }

 private:
  uint64_t wrong_ = 0;
};

TEST(AuditSceneTest, FindsADroppedCandidate) {
  DropsOccluder answerer;
  const SceneAudit audit = Audited(RequestOf(SceneFamily::kWalls, {0.1}, 20'000), answerer);
  EXPECT_GT(answerer.wrong(), 0u);
  EXPECT_GT(audit.by_epsilon[0].violations, 0u);
}

// An error too small to be one, but for a bundle of directions that random rays hardly meet.
TEST(AuditSceneTest, ClimbsToAPeakThatRandomRaysMiss) {
  const double epsilon = 0.1;
  auto request = RequestOf(SceneFamily::kWalls, {epsilon});
  const double floor = RadianceFloor(*request.scene);
  const EyeRays view(request.scene->cameras[0], 1, 1);
  const Vec3d peak = view.Through(0.5, 0.5).direction;
  Spoiler spoiler(1, [=](const Ray& ray, const Rgb& radiance) {
    const double distance = Length(ray.direction - peak);
    return OffBy(1.05 / (1 + 1e4 * distance * distance), epsilon, floor)(ray, radiance);
  });
  const SceneAudit audit = Audited(request, spoiler);
  const auto worst = [&](QueryKind kind) {
    return audit.by_kind[static_cast<size_t>(kind)].max_error_over_allowed;
  };
  EXPECT_LT(worst(QueryKind::kRandom), 1);
  EXPECT_GT(worst(QueryKind::kClimb), 1);
}

TEST(AuditSceneTest, BadRequestsAreRefused) {
  WorkerPool pool(1);
  Answerer answerer;
  for (const std::vector<double>& epsilons : {std::vector<double>{}, {1.5}, {std::nan("")}}) {
    const auto audit = AuditScene(RequestOf(SceneFamily::kBlack, epsilons), answerer, pool);
    EXPECT_TRUE(absl::IsInvalidArgument(audit.status())) << audit.status();
  }
  auto request = RequestOf(SceneFamily::kBlack, {0});
  auto blind = std::make_shared<Scene>(*request.scene);
  blind->cameras.clear();
  request.scene = blind;
  EXPECT_TRUE(absl::IsInvalidArgument(AuditScene(request, answerer, pool).status()));
}

}  // namespace
}  // namespace linetree
