#include "core/tree/light_certifier.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/support/scene_builder.h"

namespace linetree {
namespace {

using test::ObjectOf;

class LightCertifierTest : public testing::Test {
 protected:
  LightCertifierTest() {
    scene_.materials = {test::Matte({1, 1, 1}), test::Glass({0.5, 0.5, 0.5}, 1)};
    scene_.lights = {test::PointLight({0, 0, 10})};
    // The floor, [-4, 4]^2, is object 0.
    scene_.objects.push_back(
        ObjectOf(test::Polygon({{-4, -4, 0}, {4, -4, 0}, {4, 4, 0}, {-4, 4, 0}})));
  }
  void Add(const Shape& shape, int material = 0) {
    scene_.objects.push_back(ObjectOf(shape, material));
  }
  // Knowledge about the floor's cell of the given depth that holds (x, y).
  LightKnowledge Knowledge(double x, double y, int depth) {
    const Tracer tracer(scene_);
    const SurfaceChart chart(scene_.objects[0]);
    const SurfacePoint at = chart.Locate(0, {x, y, 0});
    cell_ = LightCertifier(tracer).Certify(0, chart, at.patch, CellAt(at, depth), nullptr);
    return cell_.lights[0].knowledge;
  }

  Scene scene_;
  CellLights cell_;
};

TEST_F(LightCertifierTest, NothingInBetweenIsOn) {
  EXPECT_EQ(Knowledge(1, 1, 0), LightKnowledge::kOn);
  EXPECT_TRUE(cell_.IsDecided());
}

TEST_F(LightCertifierTest, AShadowIsOffInsideListedAtItsEdgeAndOnOutside) {
  Add(test::Sphere({0, 0, 3}, 1));  // shadow of radius about 1.44
  EXPECT_EQ(Knowledge(0.1, 0.1, 4), LightKnowledge::kOff);
  EXPECT_EQ(cell_.lights[0].occluder, 1);
  EXPECT_EQ(Knowledge(1.43, 0.01, 4), LightKnowledge::kListed);
  ASSERT_EQ(cell_.lights[0].candidates.size(), 1u);
  EXPECT_EQ(cell_.lights[0].candidates[0], 1);
  EXPECT_FALSE(cell_.IsDecided());
  EXPECT_EQ(Knowledge(3, 3, 4), LightKnowledge::kOn);
}

TEST_F(LightCertifierTest, GlassIsNeverOff) {
  Add(test::Sphere({0, 0, 3}, 1), 1);
  EXPECT_EQ(Knowledge(0.1, 0.1, 4), LightKnowledge::kListed);
}

// It has no function, and no ray that meets it.
TEST_F(LightCertifierTest, GlassBesideTheRaysIsNoCandidate) {
  Add(test::Sphere({0, 0, 3}, 1), 1);
  EXPECT_EQ(Knowledge(2, 2, 4), LightKnowledge::kOn);
  // Not even one that the bundle only just passes: the shadow's border is at 1.44.
  EXPECT_EQ(Knowledge(1.51, 0.01, 7), LightKnowledge::kOn);
  EXPECT_EQ(Knowledge(1.43, 0.01, 7), LightKnowledge::kListed);
}

// On flat pieces, where no single piece of a tube's shadow need hold all of them, and on curved
// ones without functions.
TEST_F(LightCertifierTest, WhatIsHiddenFromTheWholeHullIsOff) {
  for (const bool is_flat : {true, false}) {
    scene_.objects.resize(1);
    if (!is_flat) scene_.objects[0] = ObjectOf(test::Sphere({0, 0, -4}, 4));
    Add(test::Frustum({-1, 0.1, 3}, {1, -0.3, 3.5}, 0.9, 0.4, false));
    const Tracer tracer(scene_);
    const LightCertifier certifier(tracer);
    const SurfaceChart chart(scene_.objects[0]);
    const int patch = chart.Locate(0, {0, 0, 0}).patch;
    int off = 0, listed = 0;
    const auto look = [&](const SurfaceCell& cell, const CellLights* larger) {
      CellLights lights = certifier.Certify(0, chart, patch, cell, larger);
      const PatchHull hull = chart.HullOf(patch, cell);
      const bool is_hidden =
          std::all_of(hull.points.begin(), hull.points.end(), [&](const Vec3d& p) {
            return tracer.ObjectBlocks(1, p, 0, {0, 0, Side::kOutside});
          });
      EXPECT_EQ(lights.lights[0].knowledge == LightKnowledge::kOff, is_hidden);
      (is_hidden ? off : listed) += 1;
      return lights;
    };
    for (uint32_t i = 0; i < 32 * 32; ++i) {
      const SurfaceCell cell{5, i % 32, i / 32};
      const CellLights larger = look(cell, nullptr);
      if (larger.lights[0].knowledge != LightKnowledge::kListed) continue;
      for (int child = 0; child < 4; ++child) look(cell.Child(child), &larger);
    }
    EXPECT_GT(off, 50);
    EXPECT_GT(listed, 50);
  }
}

// The wall of the tube hides the light from the cell's corners, but light comes down its middle.
TEST_F(LightCertifierTest, OpenSurfacesAreNeverOff) {
  scene_.lights = {test::PointLight({0.25, 0.25, 10})};
  Add(test::Frustum({0.25, 0.25, 1}, {0.25, 0.25, 3}, 0.28, 0.28, true));
  EXPECT_EQ(Knowledge(0.25, 0.25, 4), LightKnowledge::kListed);
  scene_.objects[1] = ObjectOf(test::Frustum({0.25, 0.25, 1}, {0.25, 0.25, 3}, 0.28, 0.28, false));
  EXPECT_EQ(Knowledge(0.25, 0.25, 4), LightKnowledge::kOff);
}

TEST_F(LightCertifierTest, DirectionalLightsToo) {
  scene_.lights = {test::DirectionalLight({0, 0.5, 1})};
  Add(test::Box({-1, -0.5, 2}, {1, 0.5, 2.5}));  // shadow about y = -1.1
  EXPECT_EQ(Knowledge(0, -1.12, 5), LightKnowledge::kOff);
  EXPECT_EQ(Knowledge(0.99, -1.12, 5), LightKnowledge::kListed);
  EXPECT_EQ(Knowledge(0, 1, 4), LightKnowledge::kOn);
}

TEST_F(LightCertifierTest, ChildrenLookAtTheirParentsCandidatesOnly) {
  for (int i = 0; i < 5; ++i) Add(test::Sphere({-3.0 + 1.5 * i, 0, 3}, 0.2));
  const Tracer tracer(scene_);
  const LightCertifier certifier(tracer);
  const SurfaceChart chart(scene_.objects[0]);
  const CellLights root = certifier.Certify(0, chart, 0, {}, nullptr);
  ASSERT_EQ(root.lights[0].candidates.size(), 5u);
  for (int c = 0; c < 4; ++c) {
    const SurfaceCell cell = SurfaceCell{}.Child(c);
    const CellLights filtered = certifier.Certify(0, chart, 0, cell, &root);
    const CellLights afresh = certifier.Certify(0, chart, 0, cell, nullptr);
    ASSERT_EQ(filtered.objects, afresh.objects);
    EXPECT_LT(filtered.objects.size(), 5u);
  }
}

TEST_F(LightCertifierTest, LongListsAreLeftToTheHierarchy) {
  for (int i = 0; i < 30; ++i) Add(test::Sphere({0.01 * i, 0, 3 + 0.1 * i}, 0.04));
  EXPECT_EQ(Knowledge(0, 0, 0), LightKnowledge::kUnknown);
}

// A wall along the cell's side leaves it lit but for points at its foot.
TEST_F(LightCertifierTest, AWallThatTheCellEndsAtIsAContact) {
  Add(test::Polygon({{-4, -4, 0}, {-4, 4, 0}, {-4, 4, 5}, {-4, -4, 5}}));
  EXPECT_EQ(Knowledge(-3.9, 1.1, 3), LightKnowledge::kOn);
  ASSERT_EQ(cell_.contacts.size(), 1u);
  EXPECT_LT(cell_.contacts[0].clearance, 1e-6);
  EXPECT_TRUE(cell_.HoldAt({-3.999, 1.1, 0}));
  EXPECT_FALSE(cell_.HoldAt({-4, 1.1, 0}));
  EXPECT_EQ(Knowledge(-2.9, 1.1, 3), LightKnowledge::kOn);
  EXPECT_TRUE(cell_.contacts.empty());
}

TEST_F(LightCertifierTest, AWallInTheMiddleOfACellIsNone) {
  Add(test::Polygon({{-3.75, -4, 0}, {-3.75, 4, 0}, {-3.75, 4, 5}, {-3.75, -4, 5}}));
  EXPECT_EQ(Knowledge(-3.9, 1.1, 3), LightKnowledge::kListed);
  EXPECT_TRUE(cell_.contacts.empty());
}

TEST_F(LightCertifierTest, BacksOfOpaqueSolidsAreNotLookedAt) {
  scene_.objects[0] = ObjectOf(test::Box({-4, -4, -1}, {4, 4, 0}));
  Add(test::Sphere({0, 0, 3}, 1));
  const Tracer tracer(scene_);
  const SurfaceChart chart(scene_.objects[0]);
  const LightCertifier certifier(tracer);
  for (int face = 0; face < 5; ++face) {
    EXPECT_EQ(certifier.Certify(0, chart, face, {}, nullptr).lights[0].knowledge,
              LightKnowledge::kFacingAway);
  }
  EXPECT_EQ(certifier.Certify(0, chart, 5, {}, nullptr).lights[0].knowledge,
            LightKnowledge::kListed);
}

TEST_F(LightCertifierTest, DividedFunctionsSayWhatNewOnesSay) {
  Add(test::Sphere({0, 0, 3}, 1));
  Add(test::Box({-2, 1, 1}, {-1, 2, 2}));
  Add(test::Frustum({2, -2, 1}, {2.5, -2, 2}, 0.4, 0.3));
  const Tracer tracer(scene_);
  const LightCertifier certifier(tracer), plain(tracer, false);
  const SurfaceChart chart(scene_.objects[0]);
  const CellLights root = certifier.Certify(0, chart, 0, {}, nullptr);
  ASSERT_TRUE(root.HasFunctions());
  EXPECT_FALSE(plain.Certify(0, chart, 0, {}, nullptr).HasFunctions());
  int points = 0, known = 0;
  for (int c = 0; c < 4; ++c) {
    const CellLights cell = certifier.Certify(0, chart, 0, SurfaceCell{}.Child(c), &root);
    for (size_t i = 0; i < cell.functions.size(); ++i) {
      const auto at = std::find(root.objects.begin(), root.objects.end(), cell.objects[i]);
      const auto& old = root.functions[static_cast<size_t>(at - root.objects.begin())];
      if (old.pieces == 0) continue;  // the ball's is built anew: the whole floor is too large
      for (int k = 0; k < 1000; ++k, ++points) {
        const float s = static_cast<float>(k % 37) / 37, t = static_cast<float>(k % 41) / 41;
        const Shadowing now = ShadowingAt(cell.functions[i], cell.coefficients.data(), s, t);
        const Shadowing then =
            ShadowingAt(old, root.coefficients.data(), (s + static_cast<float>(c & 1)) / 2,
                        (t + static_cast<float>(c >> 1)) / 2);
        known += now != Shadowing::kUnknown && then != Shadowing::kUnknown ? 1 : 0;
        if (now != then) {
          EXPECT_TRUE(now == Shadowing::kUnknown || then == Shadowing::kUnknown);
        }
      }
    }
  }
  EXPECT_GE(points, 3000);
  EXPECT_GT(known, points * 99 / 100);
}

// At depth 4 functions are built anew, but for those of which a quarter of the parent's says
// already that the object is nowhere or everywhere in the way: what is built anew would say the
// same, so parents are made that say something else.
TEST_F(LightCertifierTest, WhatAQuarterSettlesIsNotBuiltAnew) {
  Add(test::Box({-0.6, -0.6, 2}, {0.6, 0.6, 3}));
  const Tracer tracer(scene_);
  const LightCertifier certifier(tracer);
  const SurfaceChart chart(scene_.objects[0]);
  const SurfacePoint at = chart.Locate(0, {0.85, 0.1, 0});  // at the shadow's edge
  const auto certify = [&](int depth, const CellLights* parent) {
    return certifier.Certify(0, chart, at.patch, CellAt(at, depth), parent);
  };
  CellLights parent = certify(3, nullptr);
  ASSERT_EQ(parent.functions.size(), 1u);
  ASSERT_EQ(parent.functions[0].pieces, 1);
  ASSERT_EQ(parent.functions[0].squares, 0);
  const CellLights afresh = certify(4, nullptr);
  const CellLights open = certify(4, &parent);
  ASSERT_EQ(open.lights[0].knowledge, LightKnowledge::kListed);
  EXPECT_EQ(open.coefficients, afresh.coefficients) << "what is left open is built anew";
  for (const auto& [value, knowledge] :
       {std::pair(2.0f, LightKnowledge::kOn), std::pair(-2.0f, LightKnowledge::kOff)}) {
    for (size_t i = 0; i < parent.coefficients.size(); ++i) {
      parent.coefficients[i] = i % kLinearSize == 0 ? value : 0;
    }
    EXPECT_EQ(certify(4, &parent).lights[0].knowledge, knowledge);
  }
}

TEST_F(LightCertifierTest, TouchingObjectsStayCandidates) {
  Add(test::Sphere({0.25, 0.25, 0.5}, 0.5));  // stands on the floor
  EXPECT_EQ(Knowledge(0.9, 0.25, 3), LightKnowledge::kListed);
}

}  // namespace
}  // namespace linetree
