// Cells come back from bytes as they were; and whatever the bytes are, nothing but a cell of the
// scene comes back.
#include "core/store/cell_codec.h"

#include <gtest/gtest.h>

#include "tests/store/kept_scene.h"

namespace linetree {
namespace {

// The cells that hosts have told of, as bytes.
class Recorder : public CellJournal {
 public:
  void Write(const SurfacePlace& place, const CellLights& lights) override {
    ByteWriter out(surface_cells.emplace_back());
    Encode(place, lights, out);
  }
  void Write(const PathLimits&, const PathPlace& place, const CellPaths& paths) override {
    ByteWriter out(path_cells.emplace_back());
    Encode(place, paths, out);
  }
  std::vector<std::string> surface_cells, path_cells;
};

class CellCodec : public testing::TestWithParam<uint64_t> {
 protected:
  CellCodec() : scene_(test::SceneOf(GetParam())), pool_(2) {
    const auto host = test::HostOf(scene_);
    host->Keep(recorder_);
    test::Learn(*host, pool_);
  }
  const std::shared_ptr<const Scene> scene_;
  const std::shared_ptr<Recorder> recorder_ = std::make_shared<Recorder>();
  WorkerPool pool_;
};

// `copy` reads a cell and writes it.
template <class Copy>
void ExpectSameAgain(const std::string& bytes, Copy&& copy) {
  ByteReader in(bytes);
  std::string again;
  ByteWriter out(again);
  copy(in, out);
  EXPECT_TRUE(in.ok());
  EXPECT_EQ(in.left(), 0U);
  EXPECT_EQ(again, bytes);
}

TEST_P(CellCodec, BringsBackWhatWasWritten) {
  ASSERT_GT(recorder_->surface_cells.size(), 50U);
  ASSERT_GT(recorder_->path_cells.size(), 10U);
  for (const std::string& bytes : recorder_->surface_cells) {
    ExpectSameAgain(bytes, [&](ByteReader& in, ByteWriter& out) {
      const KeptSurfaceCell cell = DecodeSurfaceCell(*scene_, in);
      if (in.ok()) Encode(cell.place, *cell.lights, out);
    });
  }
  for (const std::string& bytes : recorder_->path_cells) {
    ExpectSameAgain(bytes, [&](ByteReader& in, ByteWriter& out) {
      const KeptPathCell cell = DecodePathCell(*scene_, in);
      if (in.ok()) Encode(cell.place, *cell.paths, out);
    });
  }
}

bool AreObjects(std::span<const int32_t> objects, const Scene& scene) {
  return std::all_of(objects.begin(), objects.end(), [&](int32_t object) {
    return object >= 0 && static_cast<size_t>(object) < scene.objects.size();
  });
}

void ExpectLightsOf(const Scene& scene, const CellLights& lights) {
  EXPECT_EQ(lights.lights.size(), scene.lights.size());
  EXPECT_TRUE(AreObjects(lights.objects, scene));
  for (const LightTask& task : lights.tasks) {
    EXPECT_LT(task.light, scene.lights.size());
    EXPECT_LE(task.first + task.count, lights.objects.size());
  }
  if (lights.HasFunctions()) {
    EXPECT_EQ(lights.functions.size(), lights.objects.size());
  }
}

void ExpectPathsOf(const Scene& scene, const CellPaths& paths) {
  EXPECT_TRUE(AreObjects(paths.objects, scene));
  for (size_t i = 0; i < paths.steps.size(); ++i) {
    const PathStep& step = paths.steps[i];
    EXPECT_LT(step.object, static_cast<int32_t>(scene.objects.size()));
    EXPECT_LT(i + static_cast<size_t>(std::max(step.reflected, step.transmitted)),
              paths.steps.size());
    EXPECT_TRUE(AreObjects(step.candidates, scene));
  }
}

// The page's checksum is not asked here: what has the right one may still be wrong.
TEST_P(CellCodec, TakesNothingThatLeadsOutOfTheScene) {
  test::Random random(GetParam() + 1);
  uint64_t refused = 0, taken = 0;
  const auto spoilt = [&](const std::string& bytes) {
    std::string copy = bytes;
    for (int n = random.Below(3); n >= 0; --n) {
      const auto at = static_cast<size_t>(random.Below(static_cast<int>(copy.size())));
      copy[at] = static_cast<char>(random.Below(256));
    }
    if (random.Below(8) == 0) {
      copy.resize(static_cast<size_t>(random.Below(static_cast<int>(copy.size()))));
    }
    return copy;
  };
  for (int round = 0; round < 20; ++round) {
    for (const std::string& bytes : recorder_->surface_cells) {
      const std::string copy = spoilt(bytes);
      ByteReader in(copy);
      const KeptSurfaceCell cell = DecodeSurfaceCell(*scene_, in);
      ++(in.ok() ? taken : refused);
      if (in.ok()) ExpectLightsOf(*scene_, *cell.lights);
    }
    for (const std::string& bytes : recorder_->path_cells) {
      const std::string copy = spoilt(bytes);
      ByteReader in(copy);
      const KeptPathCell cell = DecodePathCell(*scene_, in);
      ++(in.ok() ? taken : refused);
      if (in.ok()) ExpectPathsOf(*scene_, *cell.paths);
    }
  }
  EXPECT_GT(refused, 100U);
  EXPECT_GT(taken, 100U);
}

INSTANTIATE_TEST_SUITE_P(Scenes, CellCodec, testing::Values(1, 2));

}  // namespace
}  // namespace linetree
