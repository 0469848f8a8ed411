#include "core/store/page.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "core/store/bytes.h"

namespace linetree {
namespace {

constexpr uint32_t kMagic = 0x4750'544c;  // "LTPG"
constexpr size_t kVersionDigits = 32;

}  // namespace

std::string SealPage(const PageHead& head, std::string_view cells) {
  std::string page;
  page.reserve(cells.size() + 96);
  ByteWriter out(page);
  out.Put(kMagic);
  out.Put(head.kind);
  out.Put(head.algorithm);
  page.append(head.scene, 0, kVersionDigits);
  page.append(kVersionDigits - std::min(kVersionDigits, head.scene.size()), ' ');
  out.Put(static_cast<int32_t>(head.limits.max_depth));
  out.Put(head.limits.min_weight);
  out.Put(head.number);
  out.Put(head.cells);
  page.append(cells);
  out.Put(static_cast<uint64_t>(XXH3_64bits(page.data(), page.size())));
  return page;
}

std::optional<OpenedPage> OpenPage(std::string_view page) {
  if (page.size() < sizeof(uint64_t)) return std::nullopt;
  const std::string_view body = page.substr(0, page.size() - sizeof(uint64_t));
  ByteReader end(page.substr(body.size()));
  if (end.Get<uint64_t>() != XXH3_64bits(body.data(), body.size())) return std::nullopt;
  ByteReader in(body);
  OpenedPage opened;
  in.Expect(in.Get<uint32_t>() == kMagic);
  const auto kind = in.Get<uint8_t>();
  in.Expect(kind > 0 && kind < kPageKinds);
  opened.head.kind = static_cast<PageKind>(kind);
  opened.head.algorithm = in.Get<uint64_t>();
  for (size_t i = 0; i < kVersionDigits; ++i) opened.head.scene.push_back(in.Get<char>());
  opened.head.limits.max_depth = in.Get<int32_t>();
  opened.head.limits.min_weight = in.Get<double>();
  opened.head.number = in.Get<uint64_t>();
  opened.head.cells = in.Get<uint32_t>();
  if (!in.ok()) return std::nullopt;
  opened.cells = body.substr(body.size() - in.left());
  return opened;
}

}  // namespace linetree
