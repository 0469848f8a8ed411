// What becomes of the cells of one scene on their way to the disk and back: those that become known
// are gathered in pages, each cell once, and those that were kept are given back to the caches.
//
// Thread safety: every method may be called from any thread.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include "absl/container/flat_hash_set.h"
#include "absl/status/status.h"
#include "core/cache/cell_journal.h"
#include "core/cache/path_cache.h"
#include "core/cache/surface_cache.h"
#include "core/store/page.h"
#include "core/store/page_file.h"

namespace linetree {

// Bytes of a scene's cells that wait to be written at most; what comes beyond is not kept.
inline constexpr size_t kMaxWaitingBytes = size_t{32} << 20;
// Kinds of pages that a process adds to: surfaces, and linetrees of as many path limits as caches
// hold trees for. Cells of others are not kept.
inline constexpr size_t kMaxPageKinds = 1 + kMaxPathForests;
// Cells of a scene that are kept at most.
inline constexpr size_t kMaxKeptCells = size_t{1} << 22;

struct StoreCounts {
  uint64_t cells_restored = 0;  // given back to the caches
  uint64_t cells_left = 0;      // that were kept, but found no room in the caches
  uint64_t cells_written = 0;   // committed to the disk, by this process
  uint64_t cells_lost = 0;      // not kept: no room on the disk, or too many, at once or in all
  uint64_t pages_odd = 0;       // that were no pages, or not of this scene: left out
  uint64_t waiting_bytes = 0;
  uint64_t index_bytes = 0;  // of memory, to know which cells are kept
  double restore_ms = 0;
};

class ScenePages : public CellJournal {
 public:
  // The scene must outlive this; it is only asked while Restore runs.
  ScenePages(SceneVersion version, uint64_t algorithm)
      : version_(std::move(version)), algorithm_(algorithm) {}

  void Write(const SurfacePlace& place, const CellLights& lights) override;
  void Write(const PathLimits& limits, const PathPlace& place, const CellPaths& paths) override;

  // Where a scene's cells come back to.
  struct Caches {
    const Scene& scene;
    SurfaceCache& surfaces;
    PathCache& paths;
  };
  // Reads all pages of the scene and gives what fits to the caches. Calls odd(number of a page) for
  // those that make no sense.
  absl::Status Restore(const PageFile& file, const Caches& caches,
                       const std::function<void(uint64_t)>& odd);

  // Full pages, and those that are not full but have grown since they were taken last: they are
  // taken again under the same number when there is more in them.
  std::vector<PageWrite> Take();
  // What became of all pages that were taken last.
  void Taken(bool written);

  StoreCounts counts() const;
  const SceneVersion& version() const { return version_; }

 private:
  using Kind = std::tuple<PageKind, int, double>;  // and path limits
  struct OpenPage {
    PageHead head;
    std::string cells;
    bool changed = false;
    uint32_t counted = 0;  // of its cells, those that Taken has counted
  };

  static Kind KindOf(PageKind kind, const PathLimits& limits) {
    return {kind, limits.max_depth, limits.min_weight};
  }
  template <class Place, class Cell>
  void Append(PageKind kind, const PathLimits& limits, const Place& place, const Cell& cell);
  // Needs mutex_.
  void Seal(OpenPage& page);
  bool TakeBack(const OpenedPage& page, const Caches& caches);
  template <class Kept, class Decode, class Give>
  bool TakeBackCells(const OpenedPage& page, const Decode& decode, const Give& give);
  void GoOnWith(const OpenedPage& page);

  const SceneVersion version_;
  const uint64_t algorithm_;
  mutable std::mutex mutex_;
  // Guarded by mutex_:
  absl::flat_hash_set<uint64_t> known_;  // hashes of cells that are on the disk or on their way
  std::map<Kind, OpenPage> open_;
  bool goes_on_ = true;  // with short pages: until the first Restore has ended
  bool keeps_ = true;    // no more once a page could not be read: its number is not known
  std::vector<PageWrite> sealed_;
  uint64_t sealed_bytes_ = 0;
  uint64_t sealed_cells_ = 0;  // that were not counted yet
  uint64_t taken_cells_ = 0;
  uint64_t next_number_ = 1;
  StoreCounts counts_;
};

}  // namespace linetree
