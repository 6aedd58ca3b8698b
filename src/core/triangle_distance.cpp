#include "organ_collision/core/triangle_distance.h"

#include <array>
#include <optional>

#include "core/plane_coordinates.h"
#include "organ_collision/core/box.h"
#include "organ_collision/core/triangle_intersection.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Edge {
  int from, to;    ///< 0, 1, 2: a, b, c
  Vector3d start;  ///< [m]
  Vector3d end;    ///< [m]
  Feature feature;
};

std::array<Edge, 3> edgesOf(const Triangle& t) {
  return {{{0, 1, t.a, t.b, Feature::kEdgeAB},
           {1, 2, t.b, t.c, Feature::kEdgeBC},
           {2, 0, t.c, t.a, Feature::kEdgeCA}}};
}

/// Corner number `corner` of the second triangle, which is nearest to a point of the first.
ClosestPair fromCorner(const Vector3d& position, int corner, const ClosestPoint& on_first) {
  constexpr std::array<Feature, 3> kVertices{Feature::kVertexA, Feature::kVertexB,
                                             Feature::kVertexC};
  return {on_first.point,
          {position, -on_first.offset, Vector3d::Unit(corner), kVertices[corner],
           on_first.squared_distance}};
}

bool inside(double weight) { return weight > 0 && weight < 1; }

/// The nearest points of two edges, if both are inside. The offset is kept within `offsets`.
std::optional<ClosestPair> insideEdges(const Edge& first, const Edge& second, const Box& offsets) {
  const Vector3d along_first = first.end - first.start;
  const Vector3d along_second = second.end - second.start;
  const Vector3d between = second.start - first.start;
  const std::optional<Vector2d> weights = planeCoordinates(between, along_first, -along_second);
  if (!weights || !inside(weights->x()) || !inside(weights->y())) return std::nullopt;
  const Vector3d step_on_first = weights->x() * along_first;
  const Vector3d step_on_second = weights->y() * along_second;
  ClosestPair pair;
  pair.point_on_first = first.start + step_on_first;
  pair.on_second.point = second.start + step_on_second;
  pair.on_second.offset =
      (between + (step_on_second - step_on_first)).cwiseMax(offsets.low).cwiseMin(offsets.high);
  pair.on_second.barycentric.setZero();
  pair.on_second.barycentric[second.from] = 1 - weights->y();
  pair.on_second.barycentric[second.to] = weights->y();
  pair.on_second.feature = second.feature;
  pair.on_second.squared_distance = squaredLength(pair.on_second.offset);
  return pair;
}

/// Keeps the nearer.
void consider(const ClosestPair& pair, ClosestPair& best) {
  if (pair.on_second.squared_distance < best.on_second.squared_distance) best = pair;
}

/// As capsules ask: all edges are one.
bool isSegment(const Triangle& t) { return t.b == t.c; }

/// The least of 6 vertex-face and 9 edge-edge distances, each once if the first is a segment.
ClosestPair betweenBoundaries(const Triangle& first, const Triangle& second) {
  ClosestPair best{first.a, closestPointOnTriangle(first.a, second)};
  consider({first.b, closestPointOnTriangle(first.b, second)}, best);
  if (!isSegment(first)) consider({first.c, closestPointOnTriangle(first.c, second)}, best);
  const std::array<Vector3d, 3> corners = cornersOf(second);
  for (int i = 0; i < 3; ++i)
    consider(fromCorner(corners[i], i, closestPointOnTriangle(corners[i], first)), best);

  const Box box_of_first = boxOf(first);
  const Box box_of_second = boxOf(second);
  const Box offsets{box_of_second.low - box_of_first.high, box_of_second.high - box_of_first.low};
  for (const Edge& edge_of_first : edgesOf(first)) {
    for (const Edge& edge_of_second : edgesOf(second)) {
      const std::optional<ClosestPair> pair = insideEdges(edge_of_first, edge_of_second, offsets);
      if (pair) consider(*pair, best);
    }
    if (isSegment(first)) break;
  }
  return best;
}

/// About where the edge crosses the plane of `triangle`, if it does.
std::optional<Vector3d> crossing(const Edge& edge, const Triangle& triangle) {
  Vector3d normal = accurateCross(triangle.b - triangle.a, triangle.c - triangle.a);
  normal /= largestCoordinate(normal);  // against overflow
  const double before = normal.dot(edge.start - triangle.a);
  const double after = normal.dot(edge.end - triangle.a);
  if (!((before < 0 && after > 0) || (before > 0 && after < 0))) return std::nullopt;
  return edge.start + before / (before - after) * (edge.end - edge.start);
}

/// Where an edge of one pierces the other, if that is nearer to both than `best`.
void considerCrossings(const Triangle& first, const Triangle& second, ClosestPair& best) {
  const auto consider_near = [&](const std::optional<Vector3d>& point) {
    if (!point) return;
    const Vector3d on_first = closestPointOnTriangle(*point, first).point;
    consider({on_first, closestPointOnTriangle(on_first, second)}, best);
  };
  for (const Edge& edge : edgesOf(first)) {
    consider_near(crossing(edge, second));
    if (isSegment(first)) return;
  }
  for (const Edge& edge : edgesOf(second)) consider_near(crossing(edge, first));
}

}  // namespace

ClosestPair closestPoints(const Triangle& first, const Triangle& second) {
  ClosestPair best = betweenBoundaries(first, second);
  if (!trianglesIntersect(first, second)) return best;
  considerCrossings(first, second, best);
  best.point_on_first = best.on_second.point;
  best.on_second.offset.setZero();
  best.on_second.squared_distance = 0;
  return best;
}

}  // namespace organ_collision::core
