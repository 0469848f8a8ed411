#include "core/audit/speed_scenes.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "core/audit/random_stream.h"
#include "core/audit/scene_parts.h"

namespace linetree {
namespace {

constexpr Rgb kAmbient{0.2, 0.2, 0.2};
constexpr Rgb kBackground{0.05, 0.06, 0.1};

Material Paint(const Rgb& colour, double diffuse, double specular = 0, double exponent = 20,
               double reflect = 0) {
  Material material;
  material.ambient = Scaled(colour, 1 - reflect);
  material.diffuse = Scaled(colour, diffuse * (1 - reflect));
  material.specular = {specular, specular, specular};
  material.exponent = exponent;
  material.reflect = {reflect, reflect, reflect};
  return material;
}

// Twelve paints, two in three of them glossy, one in three of them reflecting.
std::vector<int> AddPaints(SceneSetter& setter, double reflect) {
  std::vector<int> paints;
  for (int i = 0; i < 12; ++i) {
    const Rgb colour = setter.random().RandomRgb(0.2, 1);
    paints.push_back(setter.AddMaterial(
        Paint(colour, 0.7, i % 3 == 2 ? 0 : 0.4, 16 << (i % 3), i % 3 == 0 ? reflect : 0)));
  }
  return paints;
}

// `count` lights of equal strength on a grid between two corners, each a little off its place.
void AddGrid(SceneSetter& setter, int count, const Vec3d& low, const Vec3d& high, double strength) {
  const Vec3d extent = high - low;
  const int columns = std::max(1, static_cast<int>(std::lround(std::sqrt(count))));
  const int rows = (count + columns - 1) / columns;
  const double each = strength / count;
  for (int i = 0; i < count; ++i) {
    const auto place = [&](int k, int of) {
      return (k + 0.5 + 0.2 * setter.random().Uniform(-0.5, 0.5)) / of;
    };
    const double x = place(i % columns, columns), z = place(i / columns, rows);
    const double y = setter.random().Unit();
    setter.AddPointLight(low + Vec3d{extent.x * x, extent.y * y, extent.z * z}, {each, each, each});
  }
}

// Upright.
void AddCamera(Scene& scene, const Vec3d& eye, const Vec3d& look_at, double fov_deg) {
  scene.cameras.push_back({"front", eye, look_at, {0, 1, 0}, fov_deg});
}

struct Ball {
  Vec3d center;
  double radius;
};
constexpr double kGap = 0.02;  // between spheres

// Spheres by the square of the floor that their middle is over: the largest is smaller than one.
class Floor {
 public:
  bool HasRoomFor(const Ball& ball) const {
    const auto [column, row] = PlaceOf(ball);
    for (int r = std::max(0, row - 1); r <= std::min(kSide - 1, row + 1); ++r) {
      for (int c = std::max(0, column - 1); c <= std::min(kSide - 1, column + 1); ++c) {
        for (const Ball& other : squares_[static_cast<size_t>(r * kSide + c)]) {
          if (Length(other.center - ball.center) < other.radius + ball.radius + kGap) return false;
        }
      }
    }
    return true;
  }
  void Add(const Ball& ball) {
    const auto [column, row] = PlaceOf(ball);
    squares_[static_cast<size_t>(row * kSide + column)].push_back(ball);
  }

 private:
  static constexpr int kSide = 10;
  static constexpr double kSquare = 1.4;  // twice the largest radius and more

  static std::pair<int, int> PlaceOf(const Ball& ball) {
    const auto index = [](double x) {
      return std::clamp(static_cast<int>(x / kSquare), 0, kSide - 1);
    };
    return {index(ball.center.x + 7), index(ball.center.z + 9)};
  }

  std::vector<std::vector<Ball>> squares_ = std::vector<std::vector<Ball>>(kSide * kSide);
};

}  // namespace

std::shared_ptr<const Scene> MakeSpheres(int objects, int lights) {
  auto scene = std::make_shared<Scene>();
  scene->name = "spheres";
  scene->ambient = kAmbient;
  scene->background = kBackground;
  RandomStream random(200);
  SceneSetter setter(*scene, random, 1, {});
  const int floor = setter.AddMaterial(Paint({0.6, 0.6, 0.55}, 0.7));
  const std::vector<int> paints = AddPaints(setter, 0.2);
  setter.AddPolygon({{-20, 0, -20}, {-20, 0, 20}, {20, 0, 20}, {20, 0, -20}}, floor);
  const double scale = objects > 200 ? std::sqrt(200.0 / objects) : 1;
  const auto squared = [&] {
    const double x = random.Unit();
    return x * x;
  };
  Floor taken;
  int count = 1;
  for (int tries = 0; count < objects && tries < 200 * objects; ++tries) {
    Ball ball;
    ball.radius = (0.15 + 0.5 * squared()) * scale;
    const double height = ball.radius + 2.5 * squared() * scale;
    ball.center = {random.Uniform(-7, 7), height, random.Uniform(-9, 3)};
    if (!taken.HasRoomFor(ball)) continue;
    taken.Add(ball);
    setter.AddSphere(ball.center, ball.radius, paints[static_cast<size_t>(count++ % 12)]);
  }
  AddGrid(setter, lights, {-9, 9, -12}, {9, 13, 10}, 1.2);
  AddCamera(*scene, {0.5, 2.5, 8.5}, {0, 0.8, -2}, 55);
  return scene;
}

namespace {

void AddWalls(SceneSetter& setter, double reflect) {
  const int wall = setter.AddMaterial(Paint({0.8, 0.75, 0.65}, 0.6, 0, 20, reflect));
  const int red = setter.AddMaterial(Paint({0.8, 0.35, 0.3}, 0.6, 0, 20, reflect));
  const int floor = setter.AddMaterial(Paint({0.55, 0.4, 0.3}, 0.6));
  const int ceiling = setter.AddMaterial(Paint({0.9, 0.9, 0.9}, 0.6));
  const auto at = [](double x, double y, double z) { return Vec3d{4 * x, 4 * y, 5 * z}; };
  setter.AddPolygon({at(-1, 0, -1), at(-1, 0, 1), at(1, 0, 1), at(1, 0, -1)}, floor);
  setter.AddPolygon({at(-1, 1, -1), at(1, 1, -1), at(1, 1, 1), at(-1, 1, 1)}, ceiling);
  setter.AddPolygon({at(-1, 0, -1), at(-1, 1, -1), at(-1, 1, 1), at(-1, 0, 1)}, wall);
  setter.AddPolygon({at(1, 0, -1), at(1, 0, 1), at(1, 1, 1), at(1, 1, -1)}, red);
  setter.AddPolygon({at(-1, 0, -1), at(1, 0, -1), at(1, 1, -1), at(-1, 1, -1)}, wall);
  setter.AddPolygon({at(-1, 0, 1), at(-1, 1, 1), at(1, 1, 1), at(1, 0, 1)}, wall);
}

Material Glass(const Rgb& transmit, double ior) {
  Material material;
  material.ambient = {0.01, 0.01, 0.01};
  material.specular = {0.4, 0.4, 0.4};
  material.exponent = 64;
  material.reflect = {0.06, 0.06, 0.06};
  material.transmit = transmit;
  material.ior = ior;
  return material;
}

// What the balls and boxes of a room are made of.
struct Finish {
  Material blue, yellow, green;
};

Finish Painted(double ball_reflect) {
  return {Paint({0.2, 0.5, 0.8}, 0.6, 0.5, 32, ball_reflect),
          Paint({0.8, 0.7, 0.2}, 0.6, 0.5, 64, ball_reflect), Paint({0.3, 0.7, 0.3}, 0.7, 0.2, 16)};
}

Finish Transparent() {
  return {Glass({0.75, 0.85, 0.95}, 1.5), Glass({0.95, 0.9, 0.7}, 1.5),
          Glass({0.7, 0.92, 0.75}, 1.3)};
}

void AddFurniture(SceneSetter& setter, const Finish& finish) {
  const int mirror = setter.AddMaterial(Paint({0.1, 0.1, 0.12}, 0.2, 0, 20, 0.8));
  const int wood = setter.AddMaterial(Paint({0.6, 0.35, 0.15}, 0.6, 0.15, 16));
  const int steel = setter.AddMaterial(Paint({0.5, 0.5, 0.55}, 0.5, 0.4, 32));
  const int blue = setter.AddMaterial(finish.blue);
  const int yellow = setter.AddMaterial(finish.yellow);
  const int green = setter.AddMaterial(finish.green);
  setter.AddPolygon({{-1.6, 1.2, -4.95}, {1.6, 1.2, -4.95}, {1.6, 3.4, -4.95}, {-1.6, 3.4, -4.95}},
                    mirror);
  setter.AddBox({-1.3, 0.94, -3}, {1.3, 1.06, -1.4}, wood);
  for (const double x : {-1.1, 1.1}) {
    for (const double z : {-2.8, -1.6}) {
      setter.AddBox({x - 0.07, 0.001, z - 0.07}, {x + 0.07, 0.939, z + 0.07}, steel);
    }
  }
  setter.AddSphere({-0.6, 1.37, -2.2}, 0.3, blue);
  setter.AddSphere({0.2, 1.27, -1.9}, 0.2, yellow);
  setter.AddBox({0.62, 1.07, -2.58}, {0.98, 1.47, -2.22}, green);
  setter.AddBox({-3.1, 0.001, -4}, {-2.1, 0.8, -3}, green);
  setter.AddSphere({2.3, 0.601, -3}, 0.6, blue);
  setter.AddSphere({-2.6, 1.101, -3.5}, 0.3, yellow);
}

void AddClutter(SceneSetter& setter, int count) {
  if (count <= 0) return;
  const std::vector<int> paints = AddPaints(setter, 0.2);
  RandomStream& random = setter.random();
  const double size = std::min(0.25, 1.6 / std::sqrt(count));
  for (int i = 0; i < count; ++i) {
    const double r = size * random.Uniform(0.4, 1);
    const double lift = random.Below(7) == 0 ? random.Uniform(0, 0.8) : 0;
    const double x = random.Uniform(-3.7, 3.7), z = random.Uniform(-4.7, 4.7);
    const Vec3d center{x, r + 0.001 + lift, z};
    const int paint = paints[static_cast<size_t>(i % 12)];
    if (i % 2 == 0) {
      setter.AddSphere(center, r, paint);
    } else {
      setter.AddBox(center - Vec3d{r, r, r}, center + Vec3d{r, r, r}, paint);
    }
  }
}

// `extra` adds what no other room has.
template <class Fn>
std::shared_ptr<const Scene> FurnishedRoom(const char* name, int objects, int lights,
                                           double wall_reflect, const Finish& finish, Fn&& extra) {
  auto scene = std::make_shared<Scene>();
  scene->name = name;
  scene->ambient = kAmbient;
  scene->background = kBackground;
  RandomStream random(18);
  SceneSetter setter(*scene, random, 1, {});
  AddWalls(setter, wall_reflect);
  AddFurniture(setter, finish);
  extra(setter);
  AddClutter(setter, objects - static_cast<int>(scene->objects.size()));
  AddGrid(setter, lights, {-3.2, 3.6, -4.2}, {3.2, 3.6, 4.2}, 1.3);
  AddCamera(*scene, {0.3, 1.9, 3.2}, {0, 1.3, -3}, 60);
  return scene;
}

bool IsInRange(int number, int most) { return number >= 1 && number <= most; }

}  // namespace

std::shared_ptr<const Scene> MakeRoom(int objects, int lights, bool mirrors) {
  return FurnishedRoom(mirrors ? "mirror room" : "room", objects, lights, mirrors ? 0.85 : 0,
                       Painted(mirrors ? 0.5 : 0.2), [](SceneSetter&) {});
}

std::shared_ptr<const Scene> MakeGlassRoom(int objects, int lights) {
  return FurnishedRoom("glass room", objects, lights, 0, Transparent(), [](SceneSetter& setter) {
    const int pane = setter.AddMaterial(Glass({0.9, 0.92, 0.9}, 1.5));
    setter.AddBox({-1.8, 0.001, -0.6}, {0.4, 2.4, -0.55}, pane);
  });
}

std::string MadeScene::Text() const { return absl::StrCat(kind, ":", objects, ":", lights); }

absl::StatusOr<MadeScene> ParseMadeScene(const std::string& text) {
  const std::vector<std::string> parts = absl::StrSplit(text, ':');
  MadeScene made;
  const bool good = parts.size() == 3 && absl::SimpleAtoi(parts[1], &made.objects) &&
                    IsInRange(made.objects, 100'000) && absl::SimpleAtoi(parts[2], &made.lights) &&
                    IsInRange(made.lights, 1024);
  made.kind = parts[0];
  const bool known = made.kind == "spheres" || made.kind == "room" || made.kind == "mirrors" ||
                     made.kind == "glass";
  if (good && known) return made;
  return absl::InvalidArgumentError(
      absl::StrCat(text,
                   ": expected spheres, room, mirrors or glass, then the number of objects (up to "
                   "100,000) and of lights (up to 1,024), such as room:18:16"));
}

std::shared_ptr<const Scene> Make(const MadeScene& made) {
  if (made.kind == "spheres") return MakeSpheres(made.objects, made.lights);
  if (made.kind == "glass") return MakeGlassRoom(made.objects, made.lights);
  return MakeRoom(made.objects, made.lights, made.kind == "mirrors");
}

}  // namespace linetree
