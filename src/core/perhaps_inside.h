#pragma once

#include "organ_collision/core/nearest_triangle.h"

namespace organ_collision::core {

/// A lower bound [m] of an answer that a radius was taken off, also where its sign is not proven:
/// inside a solid, the tip may be as deep as it may be near.
inline double lowerBoundIfInside(const NearestTriangle& nearest, double radius) {
  return nearest.distance_signed ? nearest.lower_bound : -nearest.upper_bound - 2.0 * radius;
}

/// What was told of a tip outside becomes the answer of one inside.
inline void turnInside(NearestTriangle& nearest) {
  nearest.distance = -nearest.distance;
  nearest.upper_bound = -nearest.lower_bound;
  nearest.lower_bound = nearest.distance;
}

}  // namespace organ_collision::core
