// Shapes in Tachyon's text format.
#pragma once

#include <string>

#include "core/scene/shape.h"

namespace linetree {

// Sides of the polygon that stands for a circle where Tachyon has no such shape. The polygon's
// sides lie within 1 - cos(pi / kTachyonSides) = 0.0012 of a radius of the circle.
inline constexpr int kTachyonSides = 64;

// What stands in the file for a shape.
struct TachyonShape {
  std::string text;             // one object a line
  bool is_approximate = false;  // triangles stand for a curved surface
};

// Spheres, round discs and round cylinders as they are; what is bounded by planes as triangles;
// ellipsoids, cones, elliptic cylinders and discs as triangles that approximate them, with smooth
// normals. `texture` is a name that the file defines.
TachyonShape ToTachyonShape(const Shape& shape, const std::string& texture);

// Numbers as Tachyon reads them: it parses into float.
std::string TachyonText(double value);
std::string TachyonText(const Vec3d& v);

}  // namespace linetree
