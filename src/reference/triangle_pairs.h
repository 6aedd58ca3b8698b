#pragma once

#include <utility>
#include <vector>

#include "reference/hard_triangles.h"

namespace organ_collision::core {

/// A pair that published programs got wrong.
struct HardPair {
  const char* source;
  Triangle first;
  Triangle second;
  double distance;  ///< [m] by exact rational arithmetic, rounded
};

inline const std::vector<HardPair> kHardPairs{
    {"benardp/contours#1: disjoint, said to intersect in 54 of 72 orders",
     {{12.3015, -0.253368, 5.49101}, {18.6765, -2.55337, 4.91756}, {12.3015, -2.55337, 4.91756}},
     {{-11.9885, -0.253368, 5.49101}, {1.61448, -0.253368, 5.49101}, {1.61448, -2.55337, 4.91756}},
     10.687020000000001},
    {"LokiResearch/fast-triangle-triangle-intersection#4: coplanar, missed",
     {{0, 0, 0}, {0, 0, 8}, {8, 0, 0}},
     {{2, 0, 2}, {1, 0, 4}, {9, 0, 0}},
     0},
    {"llnl/axom#152: coplanar with a corner in common, missed in 6 of 36 orders",
     {{76.648, 54.6752, 15.0012}, {76.648, 54.6752, 14.5542}, {76.582, 54.6752, 14.7879}},
     {{76.6252, 54.6752, 14.892}, {76.582, 54.6752, 14.7879}, {76.5617, 54.6752, 14.7929}},
     0},
    {"BrunoLevy/geogram#10: disjoint, an assertion failed",
     {{1898.68, 775, 1158.48}, {2000, 775, 1166.7}, {1898.68, 675, 1148.6}},
     {{1966.41, 675, 1163.79}, {1971.63, 675, 1166.95}, {1967.56, 684.554, 1166.67}},
     42.98901765168785},
};

/// Calls `check(one, other)` for the 72 orders of the corners and of the triangles.
template <typename Check>
void forEachOrder(const Triangle& first, const Triangle& second, const Check& check) {
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      check(reordered(first, i), reordered(second, j));
      check(reordered(second, j), reordered(first, i));
    }
  }
}

/// Two triangles of one kind that intersect, touch or nearly touch: a point of one is moved onto a
/// point of the other, or a corner or an edge is shared.
inline std::pair<Triangle, Triangle> closePair(HardTriangles& triangles, TriangleKind kind) {
  const Triangle first = triangles.triangle(kind);
  Triangle second = triangles.triangle(kind);
  if (kind == TriangleKind::kLattice) return {first, second};
  if (triangles.oneIn(4)) return {first, {first.a, second.b, second.c}};
  if (triangles.oneIn(4)) return {first, {first.b, second.b, first.a}};
  if (triangles.oneIn(3)) return {first, {triangles.pointOf(first), second.b, second.c}};
  const Eigen::Vector3d move = triangles.pointOf(first) - triangles.pointOf(second);
  return {first, {second.a + move, second.b + move, second.c + move}};
}

/// Apart, intersecting or nearly touching.
inline std::pair<Triangle, Triangle> anyPair(HardTriangles& triangles, TriangleKind kind) {
  if (triangles.oneIn(2)) return closePair(triangles, kind);
  const Triangle first = triangles.triangle(kind);
  return {first, triangles.triangle(kind)};
}

}  // namespace organ_collision::core
