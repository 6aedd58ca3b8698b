#include "organ_collision/core/triangle_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "core/accurate_offset.h"
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
  double squared_length;  ///< [m^2]
  Feature feature;
};

Edge edgeOf(int from, int to, const Vector3d& start, const Vector3d& end, Feature feature) {
  const Vector3d along = end - start;
  return {from, to, start, end, along, squaredLength(along), feature};
}

/// A triangle, which stays where it is, and its edges.
struct Body {
  explicit Body(const Triangle& t)
      : triangle(t),
        edges{edgeOf(0, 1, t.a, t.b, Feature::kEdgeAB), edgeOf(1, 2, t.b, t.c, Feature::kEdgeBC),
              edgeOf(2, 0, t.c, t.a, Feature::kEdgeCA)},
        is_segment(t.b == t.c),
        squared_longest(
            std::max({edges[0].squared_length, edges[1].squared_length, edges[2].squared_length})) {
  }

  const Vector3d& corner(int i) const { return edges[i].start; }

  const Triangle& triangle;
  std::array<Edge, 3> edges;
  bool is_segment;         ///< as capsules ask: all edges lie in the first
  double squared_longest;  ///< [m^2] of the edges
};

/// What is nearest to a corner of the first body.
ClosestPair fromFirst(const Body& first, int corner, const Body& second) {
  return {first.corner(corner), closestPointOnTriangle(first.corner(corner), second.triangle)};
}

/// What is nearest to a corner of the second.
ClosestPair fromSecond(const Body& first, int corner, const Body& second) {
  constexpr std::array<Feature, 3> kVertices{Feature::kVertexA, Feature::kVertexB,
                                             Feature::kVertexC};
  const ClosestPoint on_first = closestPointOnTriangle(second.corner(corner), first.triangle);
  return {on_first.point,
          {second.corner(corner), -on_first.offset, Vector3d::Unit(corner), kVertices[corner],
           on_first.squared_distance}};
}

bool inside(double weight) { return weight > 0 && weight < 1; }

/// Calls visit(edge of the first, edge of the second).
template <class Visit>
void forEachPairOfEdges(const Body& first, const Body& second, const Visit& visit) {
  for (const Edge& edge_of_first : first.edges) {
    for (const Edge& edge_of_second : second.edges) visit(edge_of_first, edge_of_second);
    if (first.is_segment) return;
  }
}

/// From any point of the first to any of the second.
Box offsetsBetween(const Body& first, const Body& second) {
  const Box box_of_first = boxOf(first.triangle);
  const Box box_of_second = boxOf(second.triangle);
  return {box_of_second.low - box_of_first.high, box_of_second.high - box_of_first.low};
}

/// The nearest points of two edges, if both are inside. The offset is kept within `offsets`.
std::optional<ClosestPair> insideEdges(const Edge& first, const Edge& second, const Box& offsets) {
  const Vector3d between = second.start - first.start;
  const Vector3d lost = lostOf(between, second.start, first.start,
                               2 * std::max(first.squared_length, second.squared_length));
  const std::optional<Vector2d> weights = planeCoordinates(between, first.along, -second.along);
  if (!weights || !inside(weights->x()) || !inside(weights->y())) return std::nullopt;
  const Vector3d step_on_first = weights->x() * first.along;
  const Vector3d step_on_second = weights->y() * second.along;
  ClosestPair pair;
  pair.point_on_first = first.start + step_on_first;
  pair.on_second.point = second.start + step_on_second;
  pair.on_second.offset = (between + ((step_on_second - step_on_first) + lost))
                              .cwiseMax(offsets.low)
                              .cwiseMin(offsets.high);
  pair.on_second.barycentric.setZero();
  pair.on_second.barycentric[second.from] = 1 - weights->y();
  pair.on_second.barycentric[second.to] = weights->y();
  pair.on_second.feature = second.feature;
  pair.on_second.squared_distance = squaredLength(pair.on_second.offset);
  return pair;
}

// Most triangles are clearly apart, and plain products tell which edges, or which ends of them, are
// nearest: only those are measured then. What they are nearest to is the nearest of all if all else
// leads away from there. Rounding, with u = 2^-53 and L the longest edge: the offset is longer than
// 2^-16*L, and within 4*u*L of the distance and as much of itself, which turns it by less than
// 2^-16. That is less than the least angle at which other corners must lead away, so that they do.

/// Where two edges come nearest, by plain products.
struct Approach {
  const Edge* of_first;
  const Edge* of_second;
  double on_first, on_second;  ///< shares of the edges
  double squared_distance;     ///< maybe not a number where they are parallel, or one is a point
};

/// Source: C. Ericson, "Real-Time Collision Detection" (2005), 5.1.9.
Approach approachOf(const Edge& first, const Edge& second) {
  const Vector3d between = second.start - first.start;
  const double both = first.along.dot(second.along);
  const double of_first = first.along.dot(between);
  const double of_second = second.along.dot(between);
  const auto share = [](double numerator, double denominator) {
    return std::clamp(numerator / denominator, 0.0, 1.0);
  };
  const double passing = share(of_first * second.squared_length - of_second * both,
                               first.squared_length * second.squared_length - both * both);
  const double on_second = share(passing * both - of_second, second.squared_length);
  const double on_first = share(on_second * both + of_first, first.squared_length);
  return {&first, &second, on_first, on_second,
          squaredLength(between + on_second * second.along - on_first * first.along)};
}

/// The nearest of all pairs of edges that are nearer than a limit; without edges if none is.
Approach nearestApproach(const Body& first, const Body& second, double squared_limit) {
  Approach nearest{nullptr, nullptr, 0, 0, squared_limit};
  forEachPairOfEdges(first, second, [&nearest](const Edge& of_first, const Edge& of_second) {
    const Approach approach = approachOf(of_first, of_second);
    if (approach.squared_distance < nearest.squared_distance) nearest = approach;
  });
  return nearest;
}

constexpr double kLeastSquaredSine = 0x1p-24;  // of 50 seconds of arc

/// Of edges that pass nearly side by side, small changes move the nearest points far.
bool areNearlyParallel(const Edge& first, const Edge& second) {
  const double both = first.along.dot(second.along);
  return !(both * both < (1 - kLeastSquaredSine) * first.squared_length * second.squared_length);
}

/// Whether all corners but those of an edge, or where `from` is `to` one, lie clearly in a
/// direction from there.
bool othersLieTowards(const Vector3d& direction, const Body& body, int from, int to) {
  for (int i = 0; i < 3; ++i) {
    const Vector3d& corner = body.corner(i);
    if (corner == body.corner(from) || corner == body.corner(to)) continue;
    const Vector3d step = corner - body.corner(from);
    const double ahead = direction.dot(step);
    if (!(ahead > 0 &&
          ahead * ahead > kLeastSquaredSine * squaredLength(direction) * squaredLength(step)))
      return false;
  }
  return true;
}

double squaredLongest(const Body& first, const Body& second) {
  return std::max(first.squared_longest, second.squared_longest);
}

/// The nearest points if it is clear which features they are on. REQUIRES: products of four of the
/// longest edge neither overflow nor underflow.
std::optional<ClosestPair> clearPair(const Body& first, const Body& second) {
  constexpr double kLeastSquare = 0x1p-32;        // of the offset, to that of the longest edge
  constexpr double kComparableSquare = 0x1p-100;  // of an edge, or of that to an offset
  const double squared_longest = squaredLongest(first, second);
  if (!(std::min(first.squared_longest, second.squared_longest) >
        kComparableSquare * squared_longest))
    return std::nullopt;
  const Approach nearest = nearestApproach(first, second, squared_longest / kComparableSquare);
  if (nearest.of_first == nullptr) return std::nullopt;

  const Edge& edge = *nearest.of_first;
  const Edge& other = *nearest.of_second;
  const auto is_apart = [&](const ClosestPair& pair) {
    return pair.on_second.squared_distance > kLeastSquare * squared_longest;
  };
  if (inside(nearest.on_first) && inside(nearest.on_second)) {
    if (areNearlyParallel(edge, other)) return std::nullopt;
    const std::optional<ClosestPair> pair = insideEdges(edge, other, offsetsBetween(first, second));
    const bool is_clear = pair && is_apart(*pair) &&
                          othersLieTowards(-pair->on_second.offset, first, edge.from, edge.to) &&
                          othersLieTowards(pair->on_second.offset, second, other.from, other.to);
    return is_clear ? pair : std::nullopt;
  }
  if (!inside(nearest.on_first)) {
    const int corner = nearest.on_first > 0 ? edge.to : edge.from;
    const ClosestPair pair = fromFirst(first, corner, second);
    if (is_apart(pair) && othersLieTowards(-pair.on_second.offset, first, corner, corner))
      return pair;
  }
  if (!inside(nearest.on_second)) {
    const int corner = nearest.on_second > 0 ? other.to : other.from;
    const ClosestPair pair = fromSecond(first, corner, second);
    if (is_apart(pair) && othersLieTowards(pair.on_second.offset, second, corner, corner))
      return pair;
  }
  return std::nullopt;
}

/// The same of edges of any length, in a unit in which products are safe.
std::optional<ClosestPair> clearPairScaled(const Body& first, const Body& second) {
  double largest = 0;
  for (const Body* body : {&first, &second})
    for (const Edge& edge : body->edges) largest = std::max(largest, largestCoordinate(edge.along));
  if (largest == 0) return std::nullopt;
  const double factor = normalisingFactor(largest);
  const auto scaled = [factor](const Triangle& t) -> Triangle {
    return {factor * t.a, factor * t.b, factor * t.c};
  };
  const Triangle scaled_first = scaled(first.triangle);
  const Triangle scaled_second = scaled(second.triangle);
  std::optional<ClosestPair> pair = clearPair(Body(scaled_first), Body(scaled_second));
  if (!pair) return std::nullopt;
  pair->point_on_first /= factor;
  pair->on_second.point /= factor;
  const Box offsets = offsetsBetween(first, second);  // of coordinates that were lost, too
  pair->on_second.offset =
      (pair->on_second.offset / factor).cwiseMax(offsets.low).cwiseMin(offsets.high);
  pair->on_second.squared_distance = squaredLength(pair->on_second.offset);
  return pair;
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
  for (int i = 0; i < 3; ++i) consider(fromSecond(first, i, second), best);

  const Box offsets = offsetsBetween(first, second);
  forEachPairOfEdges(first, second, [&](const Edge& of_first, const Edge& of_second) {
    const std::optional<ClosestPair> pair = insideEdges(of_first, of_second, offsets);
    if (pair) consider(*pair, best);
  });
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

/// A common point of bodies that intersect, but for rounding: where an edge of one pierces the
/// other; or, as in one plane, of their boundaries.
ClosestPair commonPoint(const Body& first, const Body& second) {
  constexpr double kUnitRoundoff = 0x1p-53;
  const double rounding = kUnitRoundoff * std::max(largestCoordinate(first.triangle),
                                                   largestCoordinate(second.triangle));
  ClosestPair best{};
  best.on_second.squared_distance = std::numeric_limits<double>::infinity();
  const auto is_found = [&] { return std::sqrt(best.on_second.squared_distance) <= rounding; };
  const auto pierce = [&](const Body& one, const Body& other) {
    for (const Edge& edge : one.edges) {
      if (is_found()) return;
      if (const std::optional<Vector3d> point = crossing(edge, other.triangle)) {
        const Vector3d on_first = closestPointOnTriangle(*point, first.triangle).point;
        consider({on_first, closestPointOnTriangle(on_first, second.triangle)}, best);
      }
      if (one.is_segment) return;
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
  const bool is_safe = isSafe(squaredLongest(one, other));
  const std::optional<ClosestPair> clear =
      is_safe ? clearPair(one, other) : clearPairScaled(one, other);
  if (clear) return *clear;
  return trianglesIntersect(first, second) ? commonPoint(one, other)
                                           : betweenBoundaries(one, other);
}

}  // namespace organ_collision::core
