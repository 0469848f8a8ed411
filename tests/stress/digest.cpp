// Prints a digest of the bits of classical and certified answers, of rays and scenes of all kinds.
// Built several times from the same sources of the core with different optimisation, and told to
// use the best vectors of the machine or (--narrow) the narrowest that it is compiled for: the
// digests must be equal (digest_test.py). Which they are goes to the error stream.
#include <bit>
#include <cstdio>
#include <cstring>

#include "core/jet/simd_targets.h"
#include "hwy/highway.h"
#include "tests/stress/hard_rays.h"
#include "tests/stress/hard_scenes.h"
#include "tests/stress/promise.h"
#include "tests/support/random_scene.h"

namespace linetree::stress {
namespace {

class Digest {
 public:
  void Add(double x) { hash_ = (hash_ ^ std::bit_cast<uint64_t>(x)) * 0x100000001b3u; }
  void Add(const Rgb& c) {
    Add(c.r);
    Add(c.g);
    Add(c.b);
  }
  void Add(const Vec3d& v) {
    Add(v.x);
    Add(v.y);
    Add(v.z);
  }
  void Print(const char* what) const {
    std::printf("%s %016llx\n", what, static_cast<unsigned long long>(hash_));
  }

 private:
  uint64_t hash_ = 0xcbf29ce484222325u;
};

void PrintDigests(const char* name, const ScenePtr& scene, test::Random& random) {
  const std::vector<Ray> rays = HardRays(*scene, 2000, random);
  std::printf("%s\n", name);
  Digest asked, classical, certified;
  for (const Ray& ray : rays) {
    asked.Add(ray.origin);
    asked.Add(ray.direction);
  }
  for (const Rgb& radiance : Classical(*scene, rays, {})) classical.Add(radiance);
  WorkerPool pool(1);
  for (const double bound : Bounds()) {
    SceneHost host(scene);
    for (int round = 0; round < 2; ++round) {
      for (const RayAnswer& answer : Certified(host, rays, bound, {}, pool)) {
        certified.Add(answer.radiance);
        certified.Add(answer.depth);
      }
    }
  }
  asked.Print("  rays");
  classical.Print("  classical");
  certified.Print("  certified");
}

// Of the compiled targets that the machine has; larger numbers are narrower.
void UseVectors(bool narrow) {
  const int64_t all = hwy::SupportedTargets() & HWY_TARGETS;
  int64_t target = all & -all;
  for (int64_t left = all; narrow && left != 0; left &= left - 1) target = left & -left;
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
  std::fprintf(stderr, "%s\n", hwy::TargetName(target));
}

}  // namespace
}  // namespace linetree::stress

int main(int argc, char** argv) {
  using namespace linetree;
  using namespace linetree::stress;
  UseVectors(argc > 1 && std::strcmp(argv[1], "--narrow") == 0);
  test::Random random = RandomFor("Digest");
  for (const NamedScene& named : AllHardScenes()) {
    PrintDigests(named.name, std::make_shared<const Scene>(named.make(random)), random);
  }
  PrintDigests("Random", std::make_shared<const Scene>(test::RandomScene(random, 40, 3)), random);
}
