#include "organ_collision/core/closest_point.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <tuple>

#include "core/plane_coordinates.h"
#include "organ_collision/core/box.h"
#include "organ_collision/core/predicates.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Squared sine of an angle, (16 u)^2: rounding makes angles of a few u where there is no area.
constexpr double kPerhapsFlat = 0x1p-98;

/// A corner of the triangle, as the query sees it.
struct Corner {
  const Vector3d& position;  ///< [m]
  double squared_distance;   ///< [m^2] from the query
  int slot;                  ///< 0, 1, 2: it is a, b, c
};

using Corners3 = std::array<Corner, 3>;

/// A point of the triangle, reached by a step from one of its corners.
struct Candidate {
  const Corner* base;
  Vector3d step;            ///< [m]
  double squared_distance;  ///< [m^2]
  Vector3d barycentric;     ///< in the order of the triangle's corners
  Feature feature;
};

/// Ties are decided by coordinates, so that the order of the corners is forgotten.
bool isNearer(const Corner& left, const Corner& right) {
  if (left.squared_distance != right.squared_distance)
    return left.squared_distance < right.squared_distance;
  const Vector3d& p = left.position;
  const Vector3d& q = right.position;
  return std::tie(p.x(), p.y(), p.z()) < std::tie(q.x(), q.y(), q.z());
}

Corners3 cornersSeenFrom(const Vector3d& query, const Vector3d& a, const Vector3d& b,
                         const Vector3d& c) {
  const auto corner = [&query](const Vector3d& position, int slot) {
    const Vector3d offset = position - query;
    return Corner{position, squaredLength(offset), slot};
  };
  return {corner(a, 0), corner(b, 1), corner(c, 2)};
}

std::size_t nearestOf(const Corners3& corners) {
  const std::size_t nearer = isNearer(corners[1], corners[0]) ? 1 : 0;
  return isNearer(corners[2], corners[nearer]) ? 2 : nearer;
}

/// The triangle as its nearest corner sees it: from there the way is the shortest, and so most
/// accurate.
struct View {
  View(const Vector3d& point, const Corner& nearest, const Corner& next, const Corner& last)
      : query(point),
        base(nearest),
        left(next),
        right(last),
        offset(base.position - query),
        to_left(left.position - base.position),
        to_right(right.position - base.position) {}

  const Vector3d& query;
  const Corner& base;
  const Corner& left;
  const Corner& right;
  Vector3d offset;             ///< [m] from the query to base
  Vector3d to_left, to_right;  ///< [m]
};

/// The weights at a corner. Others are sums of these: written one by one, they would be loaded as
/// vectors soon after, and a load that is wider than what was stored waits for it.
Eigen::Map<const Vector3d> unit(const Corner& corner) {
  static constexpr std::array<std::array<double, 3>, 3> kUnits = {
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  return Eigen::Map<const Vector3d>(kUnits[static_cast<std::size_t>(corner.slot)].data());
}

Candidate atCorner(const Corner& corner) {
  return {&corner, Vector3d::Zero(), corner.squared_distance, unit(corner),
          static_cast<Feature>(corner.slot)};
}

Feature featureOf(const Vector3d& barycentric) {
  constexpr std::array<Feature, 8> kFeatures{Feature::kFace,   Feature::kVertexA, Feature::kVertexB,
                                             Feature::kEdgeAB, Feature::kVertexC, Feature::kEdgeCA,
                                             Feature::kEdgeBC, Feature::kFace};
  return kFeatures[(barycentric.x() > 0 ? 1U : 0U) | (barycentric.y() > 0 ? 2U : 0U) |
                   (barycentric.z() > 0 ? 4U : 0U)];
}

/// The point nearest to the query between the corners, unless it is `nearer` itself.
void considerEdge(const Vector3d& query, const Corner& nearer, const Corner& farther,
                  Candidate& best) {
  const Vector3d offset = nearer.position - query;
  const Vector3d edge = farther.position - nearer.position;
  const double along = -offset.dot(edge);
  if (!(along > 0)) return;
  const double t = along / squaredLength(edge);
  if (!(t < 1)) return;
  const Vector3d step = t * edge;
  const double squared_distance = squaredLength(offset + step);
  if (!(squared_distance < best.squared_distance)) return;
  const Vector3d weights = (1 - t) * unit(nearer) + t * unit(farther);
  best = {&nearer, step, squared_distance, weights, featureOf(weights)};
}

/// False only where there is an area for sure.
bool isNarrow(const Vector3d& e1, const Vector3d& e2) {
  return squaredLength(e1.cross(e2)) <= kPerhapsFlat * squaredLength(e1) * squaredLength(e2);
}

constexpr double kLeastShare = 0x1p-100;

/// Plain products of the edges from the nearest corner, and of the way there from the query.
struct Products {
  Products(const Vector3d& offset, const Vector3d& to_left, const Vector3d& to_right)
      : left(squaredLength(to_left)),
        right(squaredLength(to_right)),
        both(to_left.dot(to_right)),
        along_left(offset.dot(to_left)),
        along_right(offset.dot(to_right)) {}

  bool areSafe() const { return isSafe(left) && isSafe(right); }
  /// In whatever unit: nothing is lost beside the longer one's square.
  bool areComparable() const { return left > kLeastShare * right && right > kLeastShare * left; }

  double left, right, both, along_left, along_right;
};

/// The same in a unit in which they are safe if they are comparable.
Products inSafeUnit(const View& view) {
  const double largest =
      std::max(largestCoordinate(view.to_left), largestCoordinate(view.to_right));
  const double factor = largest > 0 ? normalisingFactor(largest) : 1;
  return {factor * view.offset, factor * view.to_left, factor * view.to_right};
}

/// A point inside the face, reached from the nearest corner.
struct Inside {
  double base, left, right;  ///< weights
  Vector3d step;             ///< [m]
  double squared_distance;   ///< [m^2]

  Vector3d barycentric(const View& view) const {
    return base * unit(view.base) + left * unit(view.left) + right * unit(view.right);
  }
};

/// The point with these weights of left and right; false if it is not inside the face, or no nearer
/// than the best so far. Not called, as most that is measured passes here.
[[gnu::always_inline]] inline bool stepInside(const View& view, double s, double t, double best,
                                              Inside& inside) {
  const double rest = 1 - (s + t);
  if (!(s > 0 && t > 0 && rest > 0)) return false;
  const Vector3d step = s * view.to_left + t * view.to_right;
  inside = {rest, s, t, step, squaredLength(view.offset + step)};
  return inside.squared_distance < best;
}

void considerFace(const View& view, Candidate& best) {
  const auto& [query, base, left, right, offset, to_left, to_right] = view;
  if (base.position == left.position || left.position == right.position) return;
  const std::optional<Vector2d> weights = accuratePlaneCoordinates(-offset, to_left, to_right);
  if (!weights) return;
  if (isNarrow(to_left, to_right) && collinear(base.position, left.position, right.position))
    return;
  Inside inside;
  if (!stepInside(view, weights->x(), weights->y(), best.squared_distance, inside)) return;
  best = {&base, inside.step, inside.squared_distance, inside.barycentric(view), Feature::kFace};
}

/// sin^2 of 14 degrees: so far from parallel that plain products of edges tell what is below a
/// query clearly above the face.
constexpr double kFairlyShaped = 0x1p-4;

/// What plain products make of the face.
enum class Plainly : std::uint8_t { kInside, kBeside, kUnclear };

/// Most triangles are well shaped: where the query is clearly above such a face, plain products
/// tell accurately enough what is below it, and steps there. Their rounding moves that, along the
/// face, by less than 2^10*u of the way to the nearest corner; that changes the distance, which is
/// 2^-20 of that way or more, by less than 2^-13*u of it.
[[gnu::always_inline]] inline Plainly stepPlainly(const View& view, const Products& products,
                                                  Inside& inside) {
  const auto& [left, right, both, along_left, along_right] = products;
  const double edges = left * right;
  const double squared_normal = edges - both * both;
  if (!products.areComparable() || !(squared_normal > kFairlyShaped * edges))
    return Plainly::kUnclear;
  const double s = (both * along_right - right * along_left) / squared_normal;
  const double t = (both * along_left - left * along_right) / squared_normal;
  const Vector3d offset = view.offset + (s * view.to_left + t * view.to_right);
  if (!(squaredLength(offset) > kNearlyNothing * view.base.squared_distance))
    return Plainly::kUnclear;
  return stepInside(view, s, t, view.base.squared_distance, inside) ? Plainly::kInside
                                                                    : Plainly::kBeside;
}

/// REQUIRES: of the corners of `view`, left is not farther than right.
void considerEdges(const View& view, Candidate& best) {
  considerEdge(view.query, view.base, view.left, best);
  considerEdge(view.query, view.base, view.right, best);
  considerEdge(view.query, view.left, view.right, best);
}

/// What plain products have not found inside the face: beside a well-shaped one nothing is.
void considerBeside(const View& view, Plainly plainly, Candidate& best) {
  const View ordered =
      isNearer(view.left, view.right) ? view : View(view.query, view.base, view.right, view.left);
  considerEdges(ordered, best);
  if (plainly == Plainly::kUnclear) considerFace(ordered, best);
}

/// To where a step from a corner leads, which rounding may not carry out of the triangle's box;
/// leaves out weights and feature. Not called, so that a step just found is not stored and loaded.
[[gnu::always_inline]] inline void goTo(const Vector3d& corner, const Vector3d& step,
                                        const Vector3d& query, const Box& box,
                                        ClosestPoint& closest) {
  closest.offset = ((corner - query) + step).cwiseMax(box.low - query).cwiseMin(box.high - query);
  closest.point = (corner + step).cwiseMax(box.low).cwiseMin(box.high);
  closest.squared_distance = squaredLength(closest.offset);
}

}  // namespace

bool isClosestCorner(const Vector3d& offset, const Vector3d& edge, const Vector3d& other_edge) {
  const auto leads_away = [&offset,
                           least = kNearlyNothing * squaredLength(offset)](const Vector3d& step) {
    // So long that no rounding makes its other end the nearer one.
    const double squared = squaredLength(step);
    return isSafe(squared) && squared > least && offset.dot(step) >= 0;
  };
  return leads_away(edge) && leads_away(other_edge);
}

bool isClosestOnEdge(const Vector3d& query, const ClosestPoint& closest, const Vector3d& start,
                     const Vector3d& end, const Vector3d& corner) {
  // Let s be the root of `squared_scale`, w the way from the point to the corner. No edge is longer
  // than 33*w; rounding takes less than 2^-46*s^2 of a squared distance that matters here.
  // - What is below the query has a weight of this corner of less than -2^-17*s by the height of it
  //   there, of which rounding takes less than 2^-36*s.
  // - The corner's squared distance is 2^-35*s^2 more than the point's, or above.
  // - Another edge leads less far towards the query than this one, by 2^-21*s or more: what is
  //   nearest on it, if it leads there at all, has a squared distance of 2^-42*s^2 more, or above.
  constexpr double kMuchLonger = 0x1p10;
  const Vector3d edge = end - start;
  const Vector3d to_corner = (corner - query) - closest.offset;  // the point itself is rounded
  const double squared_edge = squaredLength(edge);
  const double squared_way = squaredLength(to_corner);
  const double squared_scale = closest.squared_distance + squared_edge;
  const double away = closest.offset.dot(to_corner);
  if (!(isSafe(squared_edge) && isSafe(squared_way) && squared_way < kMuchLonger * squared_edge &&
        squared_edge < kMuchLonger * squared_way && squared_way > kNearlyNothing * squared_scale &&
        away > 0 && away * away > 0x1p-32 * squared_scale * squared_way))
    return false;

  // Nor does a box that holds the edge cut anything off the offset, however narrow it is.
  const auto is_within = [&](Eigen::Index i) {
    const double to_start = (start[i] - query[i]) - closest.offset[i];
    const double to_end = (end[i] - query[i]) - closest.offset[i];
    return edge[i] == 0 || to_start * to_end < 0;
  };
  return is_within(0) && is_within(1) && is_within(2);
}

double roomAtClosestCorner(const Vector3d& offset, const Vector3d& edge,
                           const Vector3d& other_edge) {
  // An edge leads away until the query has moved as far as the offset reaches along it. That is no
  // farther than the offset is long, which by then is at most twice as long.
  const double squared_offset = squaredLength(offset);
  const double rounding = 0x1p-48 * std::sqrt(squared_offset);
  const auto room_of = [&](const Vector3d& step) {
    const double squared = squaredLength(step);
    if (!(squared > 8 * kNearlyNothing * squared_offset)) return 0.0;
    return offset.dot(step) / std::sqrt(squared) - rounding;
  };
  return std::max(0.0, std::min(room_of(edge), room_of(other_edge)));
}

ClosestPoint closestPointOnTriangle(const Vector3d& query, const Vector3d& a, const Vector3d& b,
                                    const Vector3d& c) {
  const Corners3 corners = cornersSeenFrom(query, a, b, c);
  const std::size_t nearest = nearestOf(corners);
  const View view(query, corners[nearest], corners[nearest == 2 ? 0 : nearest + 1],
                  corners[nearest == 0 ? 2 : nearest - 1]);
  Candidate best = atCorner(view.base);
  const Products products(view.offset, view.to_left, view.to_right);
  if (products.along_left >= 0 && products.along_right >= 0 && products.areSafe()) {
    return {view.base.position, view.offset, best.barycentric, best.feature,
            view.base.squared_distance};
  }
  Inside inside;
  const Plainly plainly =
      stepPlainly(view, products.areSafe() ? products : inSafeUnit(view), inside);
  ClosestPoint closest;
  if (plainly == Plainly::kInside) {
    goTo(view.base.position, inside.step, query, boxOf(a, b, c), closest);
    closest.barycentric = inside.barycentric(view);
    closest.feature = Feature::kFace;
    return closest;
  }
  considerBeside(view, plainly, best);
  goTo(best.base->position, best.step, query, boxOf(a, b, c), closest);
  closest.barycentric = best.barycentric;
  closest.feature = best.feature;
  return closest;
}

}  // namespace organ_collision::core
