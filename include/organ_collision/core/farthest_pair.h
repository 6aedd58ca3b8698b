#pragma once

#include <cstddef>

namespace organ_collision::core {

/// Points [m], one coordinate of all of them after another.
struct PointColumns {
  const double *x, *y, *z;
};

/// Two members of a set of points: first < second, or both 0 where all members coincide.
struct FarthestPair {
  std::size_t first, second;
  double squared_distance;  ///< [m^2] squaredLength of their difference
};

/// The two farthest of `count` points: exact, in that no pair has a larger computed squared
/// distance; of pairs that tie, the one with the smallest first, then the smallest second index.
/// Points whose squared distances from the first underflow to 0 count as coincident.
/// REQUIRES: 1 <= count < 2^32.
/// Cost: a few sweeps over surfaces and volumes; points on a sphere come close to n^1.5, two arcs
/// each point of which is as far from all of the other to n^2. Source: G. Malandain and J.-D.
/// Boissonnat, "Computing the diameter of a point set" (2002): double normals, then the points
/// outside the ball over the best pair; these are paired with those that are far enough from its
/// middle, many of them by branch and bound.
FarthestPair farthestPair(const PointColumns& points, std::size_t count);

/// The same by comparing all pairs: the reference for tests, and faster for a handful of points.
FarthestPair farthestPairBruteForce(const PointColumns& points, std::size_t count);

}  // namespace organ_collision::core
