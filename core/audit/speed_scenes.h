// Scenes whose size is a number: what speed is measured against lights and objects with. The
// same on every machine.
#pragma once

#include <memory>

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

}  // namespace linetree
