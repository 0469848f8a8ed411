// NaN, infinity and extreme numbers in requests and in the parameters of shapes.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "tests/stress/hard_rays.h"
#include "tests/stress/hard_scenes.h"
#include "tests/stress/promise.h"
#include "tests/support/demo_scenes.h"

namespace linetree::stress {
namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kNotFinite[] = {kNaN, -kNaN, kInf, -kInf};

void ExpectRefused(const absl::Status& status, const std::string& field) {
  EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << field << ": " << status;
  EXPECT_NE(status.message().find(field), absl::string_view::npos) << field << ": " << status;
}

TEST(RequestsTest, RaysThatAreNotFiniteAreRefused) {
  SceneHost host(test::BallsOnFloor(4, 1));
  WorkerPool pool(1);
  RenderOptions options;
  options.judge = JudgeKind::kCertified;
  for (int i = 0; i < 3; ++i) {
    for (const double bad : kNotFinite) {
      std::vector<Ray> rays(2, Ray{{0, -5, 1}, {0, 1, 0}});
      rays[1].origin[i] = bad;
      ExpectRefused(host.TraceRays(rays, options, pool).status(), "rays[1].origin");
      rays[1].origin[i] = 0;
      rays[1].direction[i] = bad;
      ExpectRefused(host.TraceRays(rays, options, pool).status(), "rays[1].direction");
    }
  }
  const std::vector<Ray> zero{{{0, -5, 1}, {0, -0.0, 0}}};
  ExpectRefused(host.TraceRays(zero, options, pool).status(), "rays[0].direction");
}

TEST(RequestsTest, OptionsAndCamerasThatAreNotNumbersAreRefused) {
  const auto scene = test::BallsOnFloor(4, 1);
  SceneHost host(scene);
  WorkerPool pool(1);
  FrameRequest good;
  good.camera = scene->cameras[0];
  good.width = good.height = 4;
  good.options.judge = JudgeKind::kCertified;
  ASSERT_TRUE(host.RenderFrame(good, pool).ok());
  struct Case {
    const char* field;
    std::function<double&(FrameRequest&)> number;
  };
  std::vector<Case> cases = {
      {"max_relative_error", [](auto& r) -> double& { return r.options.max_relative_error; }},
      {"min_weight", [](auto& r) -> double& { return r.options.limits.min_weight; }},
      {"camera.fov_deg", [](auto& r) -> double& { return r.camera.fov_deg; }}};
  for (int i = 0; i < 3; ++i) {
    cases.push_back({"camera.eye", [=](auto& r) -> double& { return r.camera.eye[i]; }});
    cases.push_back({"camera.look_at", [=](auto& r) -> double& { return r.camera.look_at[i]; }});
    cases.push_back({"camera.up", [=](auto& r) -> double& { return r.camera.up[i]; }});
  }
  for (const Case& spoiled : cases) {
    for (const double bad : kNotFinite) {
      FrameRequest request = good;
      spoiled.number(request) = bad;
      ExpectRefused(host.RenderFrame(request, pool).status(), spoiled.field);
    }
  }
  for (const int bad : {0, -1, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()}) {
    for (int FrameRequest::*side : {&FrameRequest::width, &FrameRequest::height}) {
      FrameRequest request = good;
      request.*side = bad;
      EXPECT_FALSE(host.RenderFrame(request, pool).ok()) << bad;
    }
    FrameRequest request = good;
    request.options.limits.max_depth = bad;
    ExpectRefused(host.RenderFrame(request, pool).status(), "max_depth");
  }
}

// What is finite is answered, from however far and along however short a vector.
TEST(RequestsTest, ExtremeRaysHaveAnswers) {
  test::Random random = RandomFor("ExtremeRays");
  const auto scene = std::make_shared<const Scene>(Crowded(random));
  std::vector<Ray> rays;
  for (int i = 0; i < Times(4000); ++i) {
    const auto extreme = [&] {
      const double magnitude = std::ldexp(random.Uniform(0.5, 1), random.Int(-1073, 1024));
      return random.Below(4) == 0 ? 0 : random.Below(2) == 0 ? magnitude : -magnitude;
    };
    Ray ray{{extreme(), extreme(), extreme()}, {extreme(), extreme(), extreme()}};
    if (random.Below(2) == 0) ray.direction = -ray.origin;
    if (random.Below(2) == 0) ray.origin = random.InCube(5);
    if (ray.direction != Vec3d{}) rays.push_back(ray);
  }
  Largest largest("ExtremeRays", 1, "of the promise");
  ExpectPromise(scene, rays, largest);
}

// Every parameter of every maker, one after the other.
TEST(RequestsTest, ShapesOfNumbersThatAreNotFiniteAreRefused) {
  std::vector<double> x(64);
  const auto v = [&](size_t i) { return Vec3d{x[i], x[i + 1], x[i + 2]}; };
  const auto map = [&](size_t i) { return AffineMap{{{v(i), v(i + 3), v(i + 6)}}, v(i + 9)}; };
  struct Case {
    std::vector<double> good;  // followed by the map's twelve
    std::function<absl::StatusOr<Shape>(size_t)> make;
  };
  const std::vector<Case> cases = {
      {{1, 2, 3, 4}, [&](size_t m) { return MakeSphere(v(0), x[3], map(m)); }},
      {{1, 2, 3, 4, 5, 6}, [&](size_t m) { return MakeEllipsoid(v(0), v(3), map(m)); }},
      {{1, 2, 3, 4, 5, 6}, [&](size_t m) { return MakeBox(v(0), v(3), map(m)); }},
      {{1, 2, 3, 4, 5, 6, 7, 8},
       [&](size_t m) {
         return MakeFrustum({v(0), v(3), x[6], x[7], false}, map(m));
       }},
      {{1, 2, 3, 4, 5, 6, 7}, [&](size_t m) { return MakeDisc(v(0), v(3), x[6], map(m)); }},
      {{0, 0, 1, 1, 0, 1, 0, 1, 1},
       [&](size_t m) {
         return MakeConvexPolygon({v(0), v(3), v(6)}, map(m));
       }},
      {{0, 0, 1, 1, 0, 1, 0, 1, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1},
       [&](size_t m) {
         return MakeTriangle({v(0), v(3), v(6)}, {v(9), v(12), v(15)}, map(m));
       }},
      {{-1, -1, -1, 1, 1, 0, 0, 1, 0, 1, 0, 1, 0, 0, 1, 1}, [&](size_t m) {
         return MakePolyhedron({{v(0), x[3]}, {v(4), x[7]}, {v(8), x[11]}, {v(12), x[15]}}, map(m));
       }}};
  int refused = 0;
  for (size_t c = 0; c < cases.size(); ++c) {
    std::vector<double> good = cases[c].good;
    const size_t m = good.size();
    good.insert(good.end(), {2, 0, 0.5, 0, 3, 0, 0.25, 0, 1, 5, 6, 7});
    for (size_t i = 0; i <= good.size(); ++i) {
      for (const double bad : kNotFinite) {
        std::copy(good.begin(), good.end(), x.begin());
        if (i < good.size()) x[i] = bad;
        const auto shape = cases[c].make(m);
        ASSERT_EQ(shape.ok(), i == good.size())
            << "maker " << c << ", number " << i << " = " << bad << " " << shape.status();
        if (shape.ok()) continue;
        ++refused;
        EXPECT_NE(shape.status().message().find("expected"), absl::string_view::npos);
        if (i >= m) ExpectRefused(shape.status(), "transform");
      }
    }
  }
  std::printf("%d refused\n", refused);
}

}  // namespace
}  // namespace linetree::stress
