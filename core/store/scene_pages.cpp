#include "core/store/scene_pages.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "core/store/cell_codec.h"

namespace linetree {
namespace {

uint64_t HashOf(PageKind kind, const PathLimits& limits, const SurfacePlace& place) {
  std::string bytes;
  ByteWriter out(bytes);
  out.Put(kind);
  (void)limits;  // surfaces look the same along all paths
  out.Put(place.object);
  out.Put(place.patch);
  out.Put(place.cell.depth);
  out.Put(place.cell.i);
  out.Put(place.cell.j);
  return XXH3_64bits(bytes.data(), bytes.size());
}

uint64_t HashOf(PageKind kind, const PathLimits& limits, const PathPlace& place) {
  std::string bytes;
  ByteWriter out(bytes);
  out.Put(kind);
  out.Put(limits.max_depth);
  out.Put(limits.min_weight);
  out.Put(place.object);
  out.Put(place.pair);
  out.Put(place.cell.depth);
  for (const uint16_t index : place.cell.index) out.Put(index);
  return XXH3_64bits(bytes.data(), bytes.size());
}

}  // namespace

void ScenePages::Write(const SurfacePlace& place, const CellLights& lights) {
  Append(PageKind::kSurface, PathLimits{}, place, lights);
}

void ScenePages::Write(const PathLimits& limits, const PathPlace& place, const CellPaths& paths) {
  Append(PageKind::kPath, limits, place, paths);
}

template <class Place, class Cell>
void ScenePages::Append(PageKind kind, const PathLimits& limits, const Place& place,
                        const Cell& cell) {
  const uint64_t hash = HashOf(kind, limits, place);
  const std::lock_guard lock(mutex_);
  if (known_.contains(hash)) return;
  const Kind own = KindOf(kind, limits);
  const bool has_place = open_.size() < kMaxPageKinds || open_.contains(own);
  if (!keeps_ || !has_place || sealed_bytes_ > kMaxWaitingBytes || known_.size() >= kMaxKeptCells) {
    ++counts_.cells_lost;
    return;
  }
  known_.insert(hash);
  OpenPage& page = open_[own];
  if (page.head.number == 0) {
    page.head = {kind, algorithm_, version_, limits, next_number_++, 0};
  }
  ByteWriter out(page.cells);
  Encode(place, cell, out);
  ++page.head.cells;
  page.changed = true;
  if (page.cells.size() >= kPageBytes) {
    Seal(page);
    page = OpenPage();
  }
}

void ScenePages::Seal(OpenPage& page) {
  sealed_.push_back({{version_, algorithm_, page.head.number}, SealPage(page.head, page.cells)});
  sealed_bytes_ += sealed_.back().page.size();
  sealed_cells_ += page.head.cells - std::exchange(page.counted, page.head.cells);
  page.changed = false;
}

std::vector<PageWrite> ScenePages::Take() {
  const std::lock_guard lock(mutex_);
  for (auto& [kind, page] : open_) {
    if (page.changed) Seal(page);
  }
  sealed_bytes_ = 0;
  taken_cells_ = std::exchange(sealed_cells_, 0);
  return std::exchange(sealed_, {});
}

void ScenePages::Taken(bool written) {
  const std::lock_guard lock(mutex_);
  (written ? counts_.cells_written : counts_.cells_lost) += std::exchange(taken_cells_, 0);
}

StoreCounts ScenePages::counts() const {
  const std::lock_guard lock(mutex_);
  StoreCounts counts = counts_;
  counts.waiting_bytes = sealed_bytes_;
  counts.index_bytes = known_.capacity() * (sizeof(uint64_t) + 1);
  for (const auto& [kind, page] : open_)
    counts.waiting_bytes += page.changed ? page.cells.size() : 0;
  return counts;
}

// What is left of the page's cells is decoded even where the caches are full: so that they are not
// written again.
template <class Kept, class Decode, class Give>
bool ScenePages::TakeBackCells(const OpenedPage& page, const Decode& decode, const Give& give) {
  ByteReader in(page.cells);
  std::vector<Kept> cells;
  for (uint32_t i = 0; i < page.head.cells && in.ok(); ++i) cells.push_back(decode(in));
  if (!in.ok() || in.left() > 0) return false;
  const size_t restored = give(std::span<Kept>(cells));
  const std::lock_guard lock(mutex_);
  for (const Kept& cell : cells) {
    known_.insert(HashOf(page.head.kind, page.head.limits, cell.place));
  }
  counts_.cells_restored += restored;
  counts_.cells_left += cells.size() - restored;
  return true;
}

bool ScenePages::TakeBack(const OpenedPage& page, const Caches& caches) {
  if (page.head.kind == PageKind::kSurface) {
    return TakeBackCells<KeptSurfaceCell>(
        page, [&](ByteReader& in) { return DecodeSurfaceCell(caches.scene, in); },
        [&](std::span<KeptSurfaceCell> cells) { return caches.surfaces.Restore(cells); });
  }
  return TakeBackCells<KeptPathCell>(
      page, [&](ByteReader& in) { return DecodePathCell(caches.scene, in); },
      [&](std::span<KeptPathCell> cells) { return caches.paths.Restore(page.head.limits, cells); });
}

void ScenePages::GoOnWith(const OpenedPage& page) {
  const std::lock_guard lock(mutex_);
  if (!goes_on_) return;
  OpenPage& open = open_[KindOf(page.head.kind, page.head.limits)];
  if (open.changed || open.head.number > page.head.number) return;
  open.head = page.head;
  open.cells = std::string(page.cells);
  open.counted = page.head.cells;
}

absl::Status ScenePages::Restore(const PageFile& file, const Caches& caches,
                                 const std::function<void(uint64_t)>& odd) {
  const auto began = std::chrono::steady_clock::now();
  // Without the lock where caches are asked: who holds theirs may be waiting for it.
  auto status = file.ForEach(version_, algorithm_, [&](const PageKey& key, std::string_view bytes) {
    {
      const std::lock_guard lock(mutex_);
      next_number_ = std::max(next_number_, key.number + 1);
    }
    const auto page = linetree::OpenPage(bytes);
    const bool is_own = page && page->head.scene == version_ &&
                        page->head.algorithm == algorithm_ && page->head.number == key.number;
    if (!is_own || !TakeBack(*page, caches)) {
      const std::lock_guard lock(mutex_);
      ++counts_.pages_odd;
      odd(key.number);
      return;
    }
    if (page->cells.size() < kShortPageBytes) GoOnWith(*page);
  });
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - began;
  const std::lock_guard lock(mutex_);
  goes_on_ = false;
  keeps_ = keeps_ && status.ok();
  counts_.restore_ms += took.count();
  return status;
}

}  // namespace linetree
