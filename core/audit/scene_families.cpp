#include "core/audit/scene_families.h"

#include <cinttypes>
#include <cstdio>

#include "core/audit/scene_parts.h"
#include "core/math/check.h"
#include "core/trace/tracer.h"

namespace linetree {
namespace {

constexpr size_t kCameras = 3;

ShapeSort RandomSort(RandomStream& random) {
  return static_cast<ShapeSort>(random.Below(kShapeSorts));
}

// Of sorts that enclose a volume.
ShapeSort RandomSolid(RandomStream& random) {
  constexpr std::array kSolids = {ShapeSort::kSphere,    ShapeSort::kEllipsoid, ShapeSort::kBox,
                                  ShapeSort::kCylinder,  ShapeSort::kCone,      ShapeSort::kFrustum,
                                  ShapeSort::kPolyhedron};
  return kSolids[random.Index(kSolids.size())];
}

std::vector<int> AddMaterials(SceneSetter& set, int count, Material (*make)(RandomStream&)) {
  std::vector<int> materials;
  for (int i = 0; i < count; ++i) materials.push_back(set.AddMaterial(make(set.random())));
  return materials;
}

int AnyOf(RandomStream& random, const std::vector<int>& of) { return of[random.Index(of.size())]; }

void AddLights(SceneSetter& set, int count, double distance) {
  RandomStream& random = set.random();
  for (int i = 0; i < count; ++i) {
    const Rgb irradiance = random.RandomRgb(0.2, 1);
    switch (random.Below(4)) {
      case 0:
        set.AddDirectionalLight(random.Direction(), irradiance);
        break;
      case 1:
        set.AddPointLight(random.InCube(distance / 2), irradiance, random.Uniform(0.5, distance));
        break;
      default:
        set.AddPointLight(random.Direction() * random.Uniform(distance / 2, 2 * distance),
                          irradiance);
    }
  }
}

// A slab, sometimes a polygon, below everything: large pieces of surface for shadows to fall on.
void AddFloor(SceneSetter& set, double half, double height, int material) {
  if (set.random().OneIn(2)) {
    set.AddBox({-half, height - 0.25, -half}, {half, height, half}, material);
  } else {
    set.AddPolygon({{-half, height, -half},
                    {-half, height, half},
                    {half, height, half},
                    {half, height, -half}},
                   material);
  }
}

void AddCamerasAround(SceneSetter& set, double spread) {
  RandomStream& random = set.random();
  while (set.scene().cameras.size() < kCameras) {
    const Vec3d look_at = random.InCube(spread / 2);
    const Vec3d eye = look_at + random.Direction() * random.Uniform(spread, 3 * spread);
    set.AddCamera(eye, look_at, random.Uniform(20, 70));
  }
}

void SetGeneric(SceneSetter& set) {
  RandomStream& random = set.random();
  const std::vector<int> materials = AddMaterials(set, 6, RandomMaterial);
  const int count = random.OneIn(2) ? 8 + random.Below(16) : 36 + random.Below(30);
  const double spread = random.Uniform(1.5, 4);
  for (int i = 0; i < count; ++i) {
    set.AddRandom(RandomSort(random), random.InCube(spread), random.Uniform(0.2, 1),
                  AnyOf(random, materials));
    if (random.OneIn(40)) {  // the same surface twice, of two materials
      Object twin = set.scene().objects.back();
      twin.material = AnyOf(random, materials);
      set.scene().objects.push_back(std::move(twin));
    }
  }
  if (random.OneIn(2)) AddFloor(set, 2 * spread, -spread, AnyOf(random, materials));
  AddLights(set, 1 + random.Below(5), spread);
  AddCamerasAround(set, spread);
}

void SetMirrors(SceneSetter& set) {
  RandomStream& random = set.random();
  const std::vector<int> mirrors = AddMaterials(set, 3, MirrorMaterial);
  const std::vector<int> clutter = AddMaterials(set, 5, RandomMaterial);
  constexpr std::array kLarge = {ShapeSort::kPolygon,   ShapeSort::kDisc,          ShapeSort::kBox,
                                 ShapeSort::kSphere,    ShapeSort::kCylinder,      ShapeSort::kCone,
                                 ShapeSort::kEllipsoid, ShapeSort::kSmoothTriangle};
  for (int i = 3 + random.Below(4); i > 0; --i) {
    set.AddRandom(kLarge[random.Index(kLarge.size())], random.Direction() * random.Uniform(1, 3),
                  random.Uniform(1, 2.5), AnyOf(random, mirrors));
  }
  for (int i = 12 + random.Below(30); i > 0; --i) {
    set.AddRandom(RandomSort(random), random.InCube(2), random.LogUniform(0.02, 0.4),
                  AnyOf(random, clutter));
  }
  AddFloor(set, 5, -2.5, AnyOf(random, random.OneIn(2) ? mirrors : clutter));
  AddLights(set, 1 + random.Below(3), 3);
  AddCamerasAround(set, 2);
}

// A point light near the surface, above a point that is seen from somewhere.
void AddNearLight(SceneSetter& set, const Tracer& tracer) {
  RandomStream& random = set.random();
  const Vec3d origin = set.ToWorld(random.Direction() * 6);
  const Vec3d target = set.ToWorld(random.InCube(1.5));
  const Hit hit = tracer.Intersect(origin, Normalized(target - origin), RayStart{});
  if (!hit.IsHit()) return;
  Light light;
  light.position = hit.point + hit.normal * (set.scale() * random.Uniform(0.05, 0.6));
  light.irradiance = random.RandomRgb(0.2, 1);
  if (random.OneIn(2)) {
    light.fade_distance = set.scale() * random.Uniform(0.1, 1);
    light.fade_power = random.Uniform(0.5, 4);
  }
  set.scene().lights.push_back(light);
}

void SetNearLights(SceneSetter& set) {
  RandomStream& random = set.random();
  const std::vector<int> gloss = AddMaterials(set, 4, GlossMaterial);
  for (int i = 5 + random.Below(10); i > 0; --i) {
    set.AddRandom(RandomSort(random), random.InCube(1.5), random.Uniform(0.4, 1.2),
                  AnyOf(random, gloss));
  }
  AddFloor(set, 4, -1.5, AnyOf(random, gloss));
  const Tracer tracer(set.scene());
  const int wanted = 1 + random.Below(4);
  for (int tries = 0; tries < 100 && set.scene().lights.size() < static_cast<size_t>(wanted);
       ++tries) {
    AddNearLight(set, tracer);
  }
  AddCamerasAround(set, 1.5);
}

void SetGlass(SceneSetter& set) {
  RandomStream& random = set.random();
  const std::vector<int> glass = AddMaterials(set, 5, GlassMaterial);
  const std::vector<int> opaque = AddMaterials(set, 3, GlossMaterial);
  for (int i = 4 + random.Below(10); i > 0; --i) {
    const Vec3d center = random.InCube(1.5);
    const double size = random.Uniform(0.4, 1.2);
    set.AddRandom(RandomSolid(random), center, size, AnyOf(random, glass));
    if (random.OneIn(3)) {  // one within the other
      set.AddRandom(RandomSolid(random), center, size / 4,
                    AnyOf(random, random.OneIn(2) ? glass : opaque));
    }
  }
  for (int i = random.Below(3); i > 0; --i) {  // films
    set.AddRandom(ShapeSort::kPolygon, random.InCube(1.5), 1, AnyOf(random, glass));
  }
  for (int i = random.Below(8); i > 0; --i) {
    set.AddRandom(RandomSort(random), random.InCube(2), random.Uniform(0.1, 0.5),
                  AnyOf(random, opaque));
  }
  AddFloor(set, 4, -2, AnyOf(random, opaque));
  AddLights(set, 1 + random.Below(3), 3);
  AddCamerasAround(set, 1.5);
}

void SetBlack(SceneSetter& set) {
  SetGeneric(set);
  set.scene().ambient = {};
  set.scene().background = {};
  // Few lights, so that much of what is seen lies in the dark.
  set.scene().lights.resize(1);
}

// Sides of the room [0, 1]^3 * edge: axis k, at its low or high end, cut into abutting tiles.
void AddWall(SceneSetter& set, int k, bool high, double edge, const std::vector<int>& materials) {
  RandomStream& random = set.random();
  const int cuts = 1 << random.Below(3);
  const double tile = edge / cuts;
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  const bool boxes = random.OneIn(2);
  for (int t = 0; t < cuts; ++t) {
    Vec3d low{0, 0, 0}, far{edge, edge, edge};
    low[i] = t * tile;
    far[i] = (t + 1) * tile;
    low[k] = high ? edge : (boxes ? -0.25 : 0);
    far[k] = high ? edge + (boxes ? 0.25 : 0) : 0;
    const int material = AnyOf(random, materials);
    if (boxes) {
      set.AddBox(low, far, material);
      continue;
    }
    Vec3d b = low, d = low;
    b[i] = far[i];
    d[j] = far[j];
    set.AddPolygon({low, b, far, d}, material);
  }
}

// Furniture that touches the floor or what stands there already.
void AddStack(SceneSetter& set, double edge, const std::vector<int>& materials) {
  RandomStream& random = set.random();
  const double size = std::ldexp(1.0, -random.Below(3));
  const Vec3d corner{random.Dyadic(3) * (edge - size), 0, random.Dyadic(3) * (edge - size)};
  double top = 0;
  for (int level = 1 + random.Below(3); level > 0; --level) {
    const Vec3d base{corner.x + size / 2, top, corner.z + size / 2};
    const int material = AnyOf(random, materials);
    switch (random.Below(4)) {
      case 0:
        set.AddSphere(base + Vec3d{0, size / 2, 0}, size / 2, material);
        return;  // nothing stands on a ball
      case 1:
        set.AddFrustum({base, base + Vec3d{0, size, 0}, size / 2, size / 4, random.OneIn(2)},
                       material);
        break;
      default:
        set.AddBox({corner.x, top, corner.z}, {corner.x + size, top + size, corner.z + size},
                   material);
    }
    top += size;
  }
}

void SetWalls(SceneSetter& set) {
  RandomStream& random = set.random();
  std::vector<int> materials = AddMaterials(set, 3, MatteMaterial);
  const std::vector<int> shiny = AddMaterials(set, 2, MirrorMaterial);
  materials.insert(materials.end(), shiny.begin(), shiny.end());
  if (random.OneIn(3)) materials.push_back(set.AddMaterial(GlassMaterial(random)));
  const double edge = 4;
  for (int k = 0; k < 3; ++k) {
    for (const bool high : {false, true}) {
      if (!random.OneIn(6)) AddWall(set, k, high, edge, materials);
    }
  }
  for (int i = 2 + random.Below(6); i > 0; --i) AddStack(set, edge, materials);
  const auto inside = [&] { return random.InBox({0.2, 0.2, 0.2}, {3.8, 3.8, 3.8}); };
  for (int i = 1 + random.Below(4); i > 0; --i) {
    Vec3d position = inside();
    if (random.OneIn(3)) {  // in the planes of sides and tiles
      for (int k = 0; k < 3; ++k) position[k] = std::ldexp(std::round(8 * position[k]), -3);
    }
    set.AddPointLight(position, random.RandomRgb(0.2, 0.8), random.OneIn(2) ? 2 : 0);
  }
  while (set.scene().cameras.size() < kCameras) {
    set.AddCamera(inside(), inside(), random.Uniform(50, 100));
  }
}

void SetTubes(SceneSetter& set) {
  RandomStream& random = set.random();
  std::vector<int> materials = AddMaterials(set, 4, RandomMaterial);
  const std::vector<int> matte = AddMaterials(set, 2, GlossMaterial);
  materials.insert(materials.end(), matte.begin(), matte.end());
  for (int i = 5 + random.Below(12); i > 0; --i) {
    const Vec3d base = random.InCube(2);
    const Vec3d axis = random.Direction() * random.Uniform(0.5, 2.5);
    const double radius = random.Uniform(0.15, 0.9);
    const double other = random.OneIn(3) ? radius : random.OneIn(2) ? 0 : random.Uniform(0.1, 0.9);
    set.AddFrustum({base, base + axis, radius, other, !random.OneIn(6)}, AnyOf(random, materials));
    if (random.OneIn(3)) set.AddPointLight(base + axis * 0.4, random.RandomRgb(0.1, 0.6));
    if (random.OneIn(3)) set.AddSphere(base + axis * 0.6, radius / 3, AnyOf(random, materials));
  }
  AddFloor(set, 4, -2, AnyOf(random, matte));
  AddLights(set, 1 + random.Below(2), 3);
  AddCamerasAround(set, 1.5);
}

// Where the scene's own coordinates lie in the world.
struct Placement {
  double scale = 1;
  Vec3d offset;
};

Placement RandomPlacement(RandomStream& random) {
  if (!random.OneIn(4)) return {};
  const double scale = std::ldexp(1.0, -7 * random.Below(2)) * (random.OneIn(2) ? 1 : 100);
  return {scale, random.OneIn(2) ? Vec3d{} : random.Direction() * (300 * scale)};
}

}  // namespace

std::optional<SceneFamily> FamilyOfName(std::string_view name) {
  for (size_t i = 0; i < kSceneFamilyNames.size(); ++i) {
    if (kSceneFamilyNames[i] == name) return static_cast<SceneFamily>(i);
  }
  return std::nullopt;
}

std::shared_ptr<const Scene> MakeFamilyScene(SceneFamily family, uint64_t seed) {
  constexpr std::array kSetters = {SetGeneric, SetMirrors, SetNearLights, SetGlass,
                                   SetBlack,   SetWalls,   SetTubes};
  static_assert(kSetters.size() == kSceneFamilies);
  auto scene = std::make_shared<Scene>();
  RandomStream random(MixBits(seed) + static_cast<uint64_t>(family));
  std::array<char, 20> seed_text;
  std::snprintf(seed_text.data(), seed_text.size(), "0x%" PRIx64, seed);
  scene->name = std::string(NameOf(family)) + " " + seed_text.data();
  scene->background = random.RandomRgb(0, 0.3);
  scene->ambient = random.RandomRgb(0, 1);
  if (random.OneIn(4)) scene->white = random.LogUniform(0.1, 10);
  const Placement placement = RandomPlacement(random);
  SceneSetter set(*scene, random, placement.scale, placement.offset);
  kSetters[static_cast<size_t>(family)](set);
  LT_CHECK(scene->cameras.size() == kCameras);
  return scene;
}

}  // namespace linetree
