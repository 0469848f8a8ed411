// What is kept on the disk: whatever the bytes are, they are cells of the scene or are left out,
// and caches that have taken them render on.
#include <memory>

#include "core/math/check.h"
#include "core/store/bytes.h"
#include "core/store/cell_codec.h"
#include "core/store/page.h"
#include "tests/fuzz/fuzz.h"
#include "tests/store/kept_scene.h"

namespace linetree::fuzz {
namespace {

constexpr int kSide = 24;
constexpr PathLimits kLimits{};

const std::shared_ptr<const Scene>& TheScene() {
  static const std::shared_ptr<const Scene> scene = test::SceneOf(3, 12);
  return scene;
}

WorkerPool& ThePool() {
  static WorkerPool pool(1);
  return pool;
}

FrameRequest SmallView() {
  FrameRequest request = test::Request(*TheScene(), Mode::kCached, Lanes::kScalar, 0.1);
  request.width = request.height = kSide;
  request.options.limits = kLimits;
  return request;
}

// Seals cells into pages of a few, as a store does.
class Sealer : public CellJournal {
 public:
  void Write(const SurfacePlace& place, const CellLights& lights) override {
    Append(PageKind::kSurface, place, lights);
  }
  void Write(const PathLimits&, const PathPlace& place, const CellPaths& paths) override {
    Append(PageKind::kPath, place, paths);
  }
  // An input each: the kind, and the cells.
  std::vector<std::string> seeds;

 private:
  template <class Place, class Cell>
  void Append(PageKind kind, const Place& place, const Cell& cell) {
    constexpr size_t kSeedBytes = 2000;
    std::string& open = open_[static_cast<size_t>(kind)];
    if (open.empty()) open.push_back(static_cast<char>(kind));
    ByteWriter out(open);
    Encode(place, cell, out);
    if (open.size() >= kSeedBytes) seeds.push_back(std::exchange(open, {}));
  }
  std::string open_[kPageKinds];
};

// As many cells as the bytes are.
template <class Cell, class Decode>
std::vector<Cell> CellsIn(std::string_view bytes, const Decode& decode) {
  ByteReader in(bytes);
  std::vector<Cell> cells;
  while (in.ok() && in.left() > 0) {
    Cell cell = decode(*TheScene(), in);
    if (in.ok()) cells.push_back(std::move(cell));
  }
  return cells;
}

void TakeBack(PageKind kind, std::string_view bytes) {
  const auto host = test::HostOf(TheScene());
  size_t restored = 0;
  if (kind == PageKind::kSurface) {
    auto cells = CellsIn<KeptSurfaceCell>(bytes, DecodeSurfaceCell);
    restored = host->surfaces().Restore(cells);
  } else {
    auto cells = CellsIn<KeptPathCell>(bytes, DecodePathCell);
    restored = host->paths().Restore(kLimits, cells);
  }
  if (restored == 0) return;
  LT_CHECK(host->surfaces().CountBytes() == host->surfaces().ByteSize());
  LT_CHECK(host->paths().CountBytes() == host->paths().ByteSize());
  LT_CHECK(host->RenderFrame(SmallView(), ThePool()).ok());
}

}  // namespace

// The first byte of an input says what it is: 1 or 2 cells of that kind, anything else a page.
std::vector<std::string> Seeds() {
  const auto sealer = std::make_shared<Sealer>();
  const auto host = test::HostOf(TheScene());
  host->Keep(sealer);
  FrameRequest view = SmallView();
  view.width = view.height = 64;
  for (const Lanes lanes : {Lanes::kScalar, Lanes::kSimd}) {
    view.options.lanes = lanes;
    for (int frame = 0; frame < 4; ++frame) LT_CHECK(host->RenderFrame(view, ThePool()).ok());
  }
  std::vector<std::string> seeds = std::move(sealer->seeds);
  LT_CHECK(!seeds.empty());
  for (size_t i = 0, cells = seeds.size(); i < cells; ++i) {
    const PageHead head{static_cast<PageKind>(seeds[i][0]), 7, TheScene()->version, kLimits, i, 1};
    seeds.push_back('\0' + SealPage(head, std::string_view(seeds[i]).substr(1)));
  }
  return seeds;
}

}  // namespace linetree::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace linetree;  // NOLINT(google-build-using-namespace)
  if (size == 0) return 0;
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  if (data[0] == 1 || data[0] == 2) {
    fuzz::TakeBack(static_cast<PageKind>(data[0]), bytes);
  } else if (const auto page = OpenPage(bytes)) {
    LT_CHECK(SealPage(page->head, page->cells) == bytes);
    fuzz::TakeBack(page->head.kind, page->cells);
  }
  return 0;
}
