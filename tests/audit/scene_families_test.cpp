#include "core/audit/scene_families.h"

#include <gtest/gtest.h>

#include <set>

#include "core/trace/tracer.h"

namespace linetree {
namespace {

constexpr uint64_t kSeeds = 12;

template <class F>
void ForAllScenes(const F& body) {
  for (int family = 0; family < kSceneFamilies; ++family) {
    for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const auto scene = MakeFamilyScene(static_cast<SceneFamily>(family), seed);
      SCOPED_TRACE(scene->name);
      body(static_cast<SceneFamily>(family), *scene);
    }
  }
}

TEST(SceneFamiliesTest, NamesLeadToFamilies) {
  for (const std::string_view name : kSceneFamilyNames) {
    ASSERT_TRUE(FamilyOfName(name).has_value());
    EXPECT_EQ(NameOf(*FamilyOfName(name)), name);
  }
  EXPECT_FALSE(FamilyOfName("nonsense").has_value());
}

TEST(SceneFamiliesTest, ASeedGivesOneScene) {
  ForAllScenes([](SceneFamily family, const Scene& scene) {
    static int checked = 0;
    const auto again = MakeFamilyScene(family, 1 + static_cast<uint64_t>(checked++) % kSeeds);
    EXPECT_EQ(again->name, scene.name);
    EXPECT_EQ(again->lights, scene.lights);
    EXPECT_EQ(again->materials, scene.materials);
    EXPECT_EQ(again->cameras, scene.cameras);
    ASSERT_EQ(again->objects.size(), scene.objects.size());
    for (size_t i = 0; i < scene.objects.size(); ++i) {
      EXPECT_EQ(again->objects[i].shape, scene.objects[i].shape);
    }
  });
}

TEST(SceneFamiliesTest, AllShapesAndLightsOccur) {
  std::set<size_t> shapes;
  std::set<LightKind> lights;
  bool open = false, capped = false, fading = false;
  ForAllScenes([&](SceneFamily, const Scene& scene) {
    for (const Object& object : scene.objects) {
      shapes.insert(object.shape.index());
      if (const auto* frustum = std::get_if<FrustumShape>(&object.shape)) {
        (frustum->open ? open : capped) = true;
      }
    }
    for (const Light& light : scene.lights) {
      lights.insert(light.kind);
      fading = fading || light.fade_distance > 0;
    }
  });
  EXPECT_EQ(shapes.size(), std::variant_size_v<Shape>);
  EXPECT_EQ(lights.size(), 2u);
  EXPECT_TRUE(open && capped && fading);
}

TEST(SceneFamiliesTest, CamerasAreValidAndSeeSomething) {
  int blind = 0, cameras = 0;
  ForAllScenes([&](SceneFamily, const Scene& scene) {
    const Tracer tracer(scene);
    EXPECT_FALSE(scene.lights.empty());
    for (const Camera& camera : scene.cameras) {
      ASSERT_TRUE(ValidateCamera(camera).ok());
      const EyeRays rays(camera, 16, 16);
      int hits = 0;
      for (int i = 0; i < 256; ++i) {
        const Ray ray = rays.ThroughPixel(i % 16, i / 16);
        hits += tracer.Intersect(ray.origin, ray.direction, RayStart{}).IsHit();
      }
      ++cameras;
      blind += hits == 0;
    }
  });
  EXPECT_LT(blind, cameras / 10);
}

template <class Predicate>
int CountMaterials(const Scene& scene, const Predicate& predicate) {
  return static_cast<int>(std::count_if(scene.materials.begin(), scene.materials.end(), predicate));
}

TEST(SceneFamiliesTest, FamiliesAreWhatTheirNamesSay) {
  ForAllScenes([](SceneFamily family, const Scene& scene) {
    switch (family) {
      case SceneFamily::kMirrors:
        EXPECT_GE(CountMaterials(scene, [](const Material& m) { return !IsBlack(m.reflect); }), 3);
        break;
      case SceneFamily::kNearLights:
        EXPECT_EQ(CountMaterials(scene,
                                 [](const Material& m) {
                                   return m.exponent >= 40 && m.exponent <= 160 &&
                                          !IsBlack(m.specular);
                                 }),
                  static_cast<int>(scene.materials.size()));
        break;
      case SceneFamily::kGlass:
        EXPECT_GE(CountMaterials(scene,
                                 [](const Material& m) {
                                   return !IsBlack(m.transmit) && m.ior >= 1.05 && m.ior <= 2;
                                 }),
                  5);
        break;
      case SceneFamily::kBlack:
        EXPECT_TRUE(IsBlack(scene.ambient) && IsBlack(scene.background));
        break;
      default:
        break;
    }
  });
}

}  // namespace
}  // namespace linetree
