#include "organ_collision/core/triangle_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/plane_coordinates.h"
#include "organ_collision/core/box.h"
#include "organ_collision/core/triangle_intersection.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Edge {
  int from, to;           ///< 0, 1, 2: a, b, c
  const Vector3d& start;  ///< [m]
  const Vector3d& end;    ///< [m]
  Vector3d along;         ///< [m] from start to end
  Feature feature;
};

/// A triangle, which stays where it is, and its edges.
struct Body {
  explicit Body(const Triangle& t)
      : triangle(t),
        edges{{{0, 1, t.a, t.b, t.b - t.a, Feature::kEdgeAB},
               {1, 2, t.b, t.c, t.c - t.b, Feature::kEdgeBC},
               {2, 0, t.c, t.a, t.a - t.c, Feature::kEdgeCA}}},
        is_segment(t.b == t.c),
        squared_longest(std::max({squaredLength(edges[0].along), squaredLength(edges[1].along),
                                  squaredLength(edges[2].along)})) {}

  const Vector3d& corner(int i) const { return edges[i].start; }

  const Triangle& triangle;
  std::array<Edge, 3> edges;
  bool is_segment;         ///< as capsules ask: all edges are the first
  double squared_longest;  ///< [m^2] of the edges
};

/// What is nearest to a corner of the first body.
ClosestPair fromFirst(const Body& first, int corner, const Body& second) {
  return {first.corner(corner), closestPointOnTriangle(first.corner(corner), second.triangle)};
}

/// What is nearest to a corner of the second, and of which weights that is.
ClosestPair fromSecond(const Body& first, const Body& second, int corner,
                       Vector3d& weights_on_first) {
  constexpr std::array<Feature, 3> kVertices{Feature::kVertexA, Feature::kVertexB,
                                             Feature::kVertexC};
  const ClosestPoint on_first = closestPointOnTriangle(second.corner(corner), first.triangle);
  weights_on_first = on_first.barycentric;
  return {on_first.point,
          {second.corner(corner), -on_first.offset, Vector3d::Unit(corner), kVertices[corner],
           on_first.squared_distance}};
}

bool inside(double weight) { return weight > 0 && weight < 1; }

/// From any point of the first to any of the second.
Box offsetsBetween(const Body& first, const Body& second) {
  const Box box_of_first = boxOf(first.triangle);
  const Box box_of_second = boxOf(second.triangle);
  return {box_of_second.low - box_of_first.high, box_of_second.high - box_of_first.low};
}

/// The nearest points of two edges, if both are inside. The offset is kept within `offsets`.
std::optional<ClosestPair> insideEdges(const Edge& first, const Edge& second, const Box& offsets) {
  const Vector3d between = second.start - first.start;
  const std::optional<Vector2d> weights = planeCoordinates(between, first.along, -second.along);
  if (!weights || !inside(weights->x()) || !inside(weights->y())) return std::nullopt;
  const Vector3d step_on_first = weights->x() * first.along;
  const Vector3d step_on_second = weights->y() * second.along;
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

// Most triangles are clearly apart, and plain products tell which corners, edges or faces of them
// are nearest: only those are measured then. Convex bodies have one distance: it is theirs if all
// other corners lead away from there on both sides, so clearly that rounding cannot matter.

/// Where two edges come nearest, by plain products.
struct Approach {
  const Edge* of_first;
  const Edge* of_second;
  double on_first, on_second;  ///< shares of the edges
  double squared_distance;     ///< not a number where they are parallel
};

/// Source: C. Ericson, "Real-Time Collision Detection" (2005), 5.1.9.
Approach approachOf(const Edge& first, const Edge& second) {
  const Vector3d between = second.start - first.start;
  const double squared_first = squaredLength(first.along);
  const double squared_second = squaredLength(second.along);
  const double both = first.along.dot(second.along);
  const double to_first = first.along.dot(between);
  const double to_second = second.along.dot(between);
  const auto share = [](double numerator, double denominator) {
    return std::clamp(numerator / denominator, 0.0, 1.0);
  };
  const double passing = share(to_first * squared_second - to_second * both,
                               squared_first * squared_second - both * both);
  const double on_second = share(passing * both - to_second, squared_second);
  const double on_first = share(on_second * both + to_first, squared_first);
  return {&first, &second, on_first, on_second,
          squaredLength(between + on_second * second.along - on_first * first.along)};
}

/// The nearest of all pairs of edges that are nearer than a limit; without edges if none is.
Approach nearestApproach(const Body& first, const Body& second, double squared_limit) {
  Approach nearest{nullptr, nullptr, 0, 0, squared_limit};
  for (const Edge& edge_of_first : first.edges) {
    for (const Edge& edge_of_second : second.edges) {
      const Approach approach = approachOf(edge_of_first, edge_of_second);
      if (approach.squared_distance < nearest.squared_distance) nearest = approach;
    }
    if (first.is_segment) break;
  }
  return nearest;
}

constexpr double kLeastSine = 0x1p-24;  // squared: 50 seconds of arc

/// Of edges that pass nearly side by side, small changes move the nearest points far.
bool areNearlyParallel(const Vector3d& v, const Vector3d& w) {
  const double both = v.dot(w);
  return !(both * both < (1 - kLeastSine) * squaredLength(v) * squaredLength(w));
}

/// Whether, from the corners with weights, between which the nearest point is, all others lie
/// clearly in a direction.
bool restLiesTowards(const Vector3d& direction, const Body& body, const Vector3d& weights) {
  constexpr double kLeastStep = 0x1p-20;  // squared, of the longest edge
  const double least_step = kLeastStep * body.squared_longest;
  const int base = weights[0] > 0 ? 0 : weights[1] > 0 ? 1 : 2;
  for (int i = 0; i < 3; ++i) {
    if (weights[i] > 0) continue;
    const Vector3d step = body.corner(i) - body.corner(base);
    const double squared_step = squaredLength(step);
    const double ahead = direction.dot(step);
    if (!(ahead > 0 && squared_step > least_step &&
          ahead * ahead > kLeastSine * squaredLength(direction) * squared_step))
      return false;
  }
  return true;
}

/// Finds the nearest points if it is clear which features they are on. REQUIRES: products of four
/// lengths as the longest edge neither overflow nor underflow.
bool findIfClear(const Body& first, const Body& second, double squared_longest, ClosestPair& pair) {
  constexpr double kComparable = 0x1p-100;  // squared lengths, to the longest edge's
  constexpr double kLeastOffset = 0x1p-32;  // the same: more than rounding
  const double shorter = std::min(first.squared_longest, second.squared_longest);
  if (!(shorter > kComparable * squared_longest)) return false;
  const Approach nearest = nearestApproach(first, second, squared_longest / kComparable);
  if (nearest.of_first == nullptr) return false;

  const auto is_clear = [&](Vector3d weights_on_first) {
    const Vector3d& offset = pair.on_second.offset;
    if (first.is_segment) weights_on_first[2] = weights_on_first[1] += weights_on_first[2];
    return pair.on_second.squared_distance > kLeastOffset * squared_longest &&
           restLiesTowards(-offset, first, weights_on_first) &&
           restLiesTowards(offset, second, pair.on_second.barycentric);
  };
  const Edge& edge = *nearest.of_first;
  const Edge& other = *nearest.of_second;
  if (inside(nearest.on_first) && inside(nearest.on_second)) {
    if (areNearlyParallel(edge.along, other.along)) return false;
    const std::optional<ClosestPair> between =
        insideEdges(edge, other, offsetsBetween(first, second));
    if (!between) return false;
    pair = *between;
    Vector3d weights = Vector3d::Zero();
    weights[edge.from] = 1;
    weights[edge.to] = 1;
    return is_clear(weights);
  }
  if (!inside(nearest.on_first)) {
    const int corner = nearest.on_first > 0 ? edge.to : edge.from;
    pair = fromFirst(first, corner, second);
    if (is_clear(Vector3d::Unit(corner))) return true;
  }
  if (inside(nearest.on_second)) return false;
  Vector3d weights;
  pair = fromSecond(first, second, nearest.on_second > 0 ? other.to : other.from, weights);
  return is_clear(weights);
}

/// The same whatever the unit.
bool findIfClear(const Body& first, const Body& second, ClosestPair& pair) {
  const double longest = std::max(first.squared_longest, second.squared_longest);
  if (isSafe(longest)) return findIfClear(first, second, longest, pair);

  double largest = 0;
  for (const Body* body : {&first, &second})
    for (const Edge& edge : body->edges) largest = std::max(largest, largestCoordinate(edge.along));
  if (largest == 0) return false;
  const double factor = normalisingFactor(largest);
  const auto scaled = [factor](const Triangle& t) -> Triangle {
    return {factor * t.a, factor * t.b, factor * t.c};
  };
  const Triangle scaled_first = scaled(first.triangle);
  const Triangle scaled_second = scaled(second.triangle);
  const Body one(scaled_first);
  const Body other(scaled_second);
  if (!findIfClear(one, other, std::max(one.squared_longest, other.squared_longest), pair))
    return false;
  pair.point_on_first /= factor;
  pair.on_second.point /= factor;
  const Box offsets = offsetsBetween(first, second);  // of coordinates that were lost, too
  pair.on_second.offset =
      (pair.on_second.offset / factor).cwiseMax(offsets.low).cwiseMin(offsets.high);
  pair.on_second.squared_distance = squaredLength(pair.on_second.offset);
  return true;
}

/// Keeps the nearer.
void consider(const ClosestPair& pair, ClosestPair& best) {
  if (pair.on_second.squared_distance < best.on_second.squared_distance) best = pair;
}

/// The least of 6 vertex-face and 9 edge-edge distances, each once if the first is a segment.
ClosestPair betweenBoundaries(const Body& first, const Body& second) {
  ClosestPair best = fromFirst(first, 0, second);
  consider(fromFirst(first, 1, second), best);
  if (!first.is_segment) consider(fromFirst(first, 2, second), best);
  Vector3d weights;
  for (int i = 0; i < 3; ++i) consider(fromSecond(first, second, i, weights), best);

  const Box offsets = offsetsBetween(first, second);
  for (const Edge& edge_of_first : first.edges) {
    for (const Edge& edge_of_second : second.edges) {
      const std::optional<ClosestPair> pair = insideEdges(edge_of_first, edge_of_second, offsets);
      if (pair) consider(*pair, best);
    }
    if (first.is_segment) break;
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
  return edge.start + before / (before - after) * edge.along;
}

double largestCoordinateOf(const Body& body) {
  return std::max({largestCoordinate(body.corner(0)), largestCoordinate(body.corner(1)),
                   largestCoordinate(body.corner(2))});
}

/// A common point of bodies that intersect, but for rounding: where an edge of one pierces the
/// other; or, as in one plane, of their boundaries.
ClosestPair commonPoint(const Body& first, const Body& second) {
  constexpr double kUnit = 0x1p-53;
  const double rounding = kUnit * std::max(largestCoordinateOf(first), largestCoordinateOf(second));
  ClosestPair best{};
  best.on_second.squared_distance = std::numeric_limits<double>::infinity();
  const auto is_found = [&] { return std::sqrt(best.on_second.squared_distance) <= rounding; };
  const auto pierce = [&](const Body& one, const Body& other) {
    for (const Edge& edge : one.edges) {
      if (is_found()) return;
      const std::optional<Vector3d> point = crossing(edge, other.triangle);
      if (!point) continue;
      const Vector3d on_first = closestPointOnTriangle(*point, first.triangle).point;
      consider({on_first, closestPointOnTriangle(on_first, second.triangle)}, best);
    }
  };
  pierce(first, second);
  pierce(second, first);
  if (!is_found()) consider(betweenBoundaries(first, second), best);

  best.point_on_first = best.on_second.point;
  best.on_second.offset.setZero();
  best.on_second.squared_distance = 0;
  return best;
}

}  // namespace

ClosestPair closestPoints(const Triangle& first, const Triangle& second) {
  const Body one(first);
  const Body other(second);
  ClosestPair pair;
  if (findIfClear(one, other, pair)) return pair;
  return trianglesIntersect(first, second) ? commonPoint(one, other)
                                           : betweenBoundaries(one, other);
}

}  // namespace organ_collision::core
