// Pages: some cells of one scene and one kind, with all that it takes to tell whether they may be
// used. Sealed pages are immutable.
//
// Layout, numbers in the machine's order: magic (4 bytes), kind (1), algorithm version (8), scene
// version (32), path limits (4 + 8), number (8), cells (4), the cells (cell_codec.h), and a
// checksum of all of that (XXH3, 8).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "core/scene/scene.h"
#include "core/trace/tracer.h"

namespace linetree {

// A page is sealed when it holds so much; the cell that makes it full may make it longer.
inline constexpr size_t kPageBytes = 16 << 10;
// And one that was not full when the program ended is gone on with when it is shorter than this.
inline constexpr size_t kShortPageBytes = 8 << 10;

enum class PageKind : uint8_t {
  kSurface = 1,  // cells of surface trees
  kPath = 2,     // of certified linetrees
};
inline constexpr int kPageKinds = 3;

struct PageHead {
  PageKind kind = PageKind::kSurface;
  uint64_t algorithm = 0;
  SceneVersion scene;  // 32 hexadecimal digits
  PathLimits limits;   // kPath
  uint64_t number = 0;
  uint32_t cells = 0;
};

// `cells`: head.cells of them, one after the other.
std::string SealPage(const PageHead& head, std::string_view cells);

struct OpenedPage {
  PageHead head;
  std::string_view cells;  // of the page's bytes
};
// Nothing where the bytes are no page, or not as they were sealed.
std::optional<OpenedPage> OpenPage(std::string_view page);

}  // namespace linetree
