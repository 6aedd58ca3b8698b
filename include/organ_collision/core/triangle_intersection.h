#pragma once

#include "organ_collision/core/triangle.h"

namespace organ_collision::core {

/// True where the closed triangles have a point in common. Exact: decided by the signs of exact
/// predicates, coplanar and zero-area triangles included, so the order of corners and of triangles
/// does not matter. They have one where a corner of one lies in the other, or an edge of one
/// crosses an edge or pierces the face of the other, and nowhere else.
/// Cost: some 35 ns, 70 where they meet; half a microsecond and more for each sign that rounding
/// leaves in doubt (benchmark/triangle_benchmark).
/// Source: the early ways out are those of O. Devillers and P. Guigue, "Faster triangle-triangle
/// intersection tests", INRIA RR-4488 (2002).
bool trianglesIntersect(const Triangle& first, const Triangle& second);

}  // namespace organ_collision::core
