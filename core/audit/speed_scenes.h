// Scenes whose size is a number: what speed is measured against lights and objects with. The
// same on every machine.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "core/scene/scene.h"

namespace linetree {

// `objects` in all: a floor and spheres of many sizes that lie about on it or hang above it without
// touching, every third of which reflects, under `lights` lights high up. More than 200 spheres are
// smaller in proportion, so that they cover about as much of the picture. Fewer come where no more
// find a place.
std::shared_ptr<const Scene> MakeSpheres(int objects, int lights);

// A furnished room of 18 objects, `objects` in all: the rest is small clutter all over the floor.
// With `mirrors` walls and balls reflect: a path goes on until it is cut off.
std::shared_ptr<const Scene> MakeRoom(int objects, int lights, bool mirrors);

// The same room, with one object more, with balls and boxes of glass and a pane in front of the
// table, through which a third of the picture is seen.
std::shared_ptr<const Scene> MakeGlassRoom(int objects, int lights);

// One of them, as it is written: KIND:OBJECTS:LIGHTS, such as room:18:16.
struct MadeScene {
  std::string kind;  // spheres, room, mirrors or glass
  int objects = 0;   // 1 to 100,000
  int lights = 0;    // 1 to 1,024

  std::string Text() const;
};

// INVALID_ARGUMENT for another kind and numbers out of range.
absl::StatusOr<MadeScene> ParseMadeScene(const std::string& text);

std::shared_ptr<const Scene> Make(const MadeScene& made);

}  // namespace linetree
