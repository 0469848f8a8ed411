// What cells know, as bytes. A checksum guards the bytes (page.h); what is read is still held
// against the scene, so that no list leads beside it, whatever the bytes say.
#pragma once

#include <memory>

#include "core/cache/cell_journal.h"
#include "core/scene/scene.h"
#include "core/store/bytes.h"

namespace linetree {

void Encode(const SurfacePlace& place, const CellLights& lights, ByteWriter& out);
void Encode(const PathPlace& place, const CellPaths& paths, ByteWriter& out);

// Leaves `in` not ok where the bytes are no cell of the scene.
KeptSurfaceCell DecodeSurfaceCell(const Scene& scene, ByteReader& in);
KeptPathCell DecodePathCell(const Scene& scene, ByteReader& in);

}  // namespace linetree
