#include "organ_collision/core/closest_point.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <tuple>

#include "core/accurate_offset.h"
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
  Vector3d offset;          ///< [m] from the query
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
    return Corner{position, squaredLength(position - query), slot};
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
        to_right(right.position - base.position),
        lost(lostOf(offset, base.position, query,
                    std::max(squaredLength(to_left), squaredLength(to_right)))) {}

  const Vector3d& query;
  const Corner& base;
  const Corner& left;
  const Corner& right;
  Vector3d offset;             ///< [m] from the query to base
  Vector3d to_left, to_right;  ///< [m]
  Vector3d lost;               ///< [m] of the offset
};

/// The weights at a corner. Others are sums of these: written one by one, they would be loaded as
/// vectors soon after, and a load that is wider than what was stored waits for it.
Eigen::Map<const Vector3d> unit(const Corner& corner) {
  static constexpr std::array<std::array<double, 3>, 3> kUnits = {
      {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  return Eigen::Map<const Vector3d>(kUnits[static_cast<std::size_t>(corner.slot)].data());
}

Candidate atBase(const View& view) {
  return {&view.base,      Vector3d::Zero(),
          view.offset,     view.base.squared_distance,
          unit(view.base), static_cast<Feature>(view.base.slot)};
}

Feature featureOf(const Vector3d& barycentric) {
  constexpr std::array<Feature, 8> kFeatures{Feature::kFace,   Feature::kVertexA, Feature::kVertexB,
                                             Feature::kEdgeAB, Feature::kVertexC, Feature::kEdgeCA,
                                             Feature::kEdgeBC, Feature::kFace};
  return kFeatures[(barycentric.x() > 0 ? 1U : 0U) | (barycentric.y() > 0 ? 2U : 0U) |
                   (barycentric.z() > 0 ? 4U : 0U)];
}

/// So little is left of an offset that most of it may be rounding, also along edge or face.
bool isNearlyNothing(const Vector3d& rest, const Vector3d& offset) {
  return !(squaredLength(rest) > kNearlyNothing * squaredLength(offset));
}

/// The point nearest to the query between the corners, unless it is `nearer` itself.
void considerEdge(const Vector3d& query, const Corner& nearer, const Corner& farther,
                  Candidate& best) {
  const Vector3d offset = nearer.position - query;
  const Vector3d edge = farther.position - nearer.position;
  const double along = -offset.dot(edge);
  if (!(along > 0)) return;
  const double squared_edge = squaredLength(edge);
  double t = along / squared_edge;
  if (!(t < 1)) return;
  Vector3d step = t * edge;
  Vector3d rest = offset + (step + lostOf(offset, nearer.position, query, squared_edge));
  if (isNearlyNothing(rest, offset)) {
    AccurateSum sum(nearer.position, query);
    sum.add(t, farther.position, nearer.position);
    rest = sum.value();
    const double more = -rest.dot(edge) / squared_edge;
    rest += more * edge;
    t += more;
    step = t * edge;
  }
  const double squared_distance = squaredLength(rest);
  if (!(squared_distance < best.squared_distance)) return;
  const Vector3d weights = (1 - t) * unit(nearer) + t * unit(farther);
  best = {&nearer, step, rest, squared_distance, weights, featureOf(weights)};
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

/// Of left and right, and of what is left over for the nearest corner.
struct Weights {
  Weights(double of_left, double of_right)
      : left(of_left), right(of_right), base(1 - (of_left + of_right)) {}

  /// Corrects them by numbers so small that it matters what rounding takes of left + right.
  void add(const Vector2d& more) {
    const double sum = left + right;
    const double lost = (left - (sum - right)) + (right - (sum - (sum - right)));
    base = ((1 - sum) - lost) - (more.x() + more.y());
    left += more.x();
    right += more.y();
  }

  bool areInside() const { return left > 0 && right > 0 && base > 0; }
  Vector3d step(const View& view) const { return left * view.to_left + right * view.to_right; }
  Vector3d barycentric(const View& view) const {
    return base * unit(view.base) + left * unit(view.left) + right * unit(view.right);
  }

  double left, right, base;
};

void considerFace(const View& view, Candidate& best) {
  const auto& [query, base, left, right, offset, to_left, to_right, lost] = view;
  if (base.position == left.position || left.position == right.position) return;
  const std::optional<Vector2d> weights = accuratePlaneCoordinates(-offset, to_left, to_right);
  if (!weights) return;
  if (isNarrow(to_left, to_right) && collinear(base.position, left.position, right.position))
    return;
  Weights inside(weights->x(), weights->y());
  Vector3d rest = offset + (inside.step(view) + lost);
  if (isNearlyNothing(rest, offset)) {
    AccurateSum sum(base.position, query);
    sum.add(inside.left, left.position, base.position);
    sum.add(inside.right, right.position, base.position);
    rest = sum.value();
    const std::optional<Vector2d> more = accuratePlaneCoordinates(-rest, to_left, to_right);
    if (more) {
      rest += more->x() * to_left + more->y() * to_right;
      inside.add(*more);
    }
  }
  if (!inside.areInside()) return;
  const double squared_distance = squaredLength(rest);
  if (squared_distance < best.squared_distance)
    best = {&base,         inside.step(view), rest, squared_distance, inside.barycentric(view),
            Feature::kFace};
}

/// sin^2 of 14 degrees: so far from parallel that plain products of edges tell what is below a
/// query clearly above the face.
constexpr double kFairlyShaped = 0x1p-4;

/// Most triangles are well shaped: where the query is clearly above such a face, plain products
/// tell accurately enough what is below it. Their rounding moves that, along the face, by less than
/// 2^10*u of the way to the nearest corner; that changes the distance, which is 2^-20 of that way
/// or more, by less than 2^-13*u of it.
[[gnu::always_inline]] inline std::optional<Weights> plainWeights(const Products& products) {
  const auto& [left, right, both, along_left, along_right] = products;
  const double edges = left * right;
  const double squared_normal = edges - both * both;
  if (!products.areComparable() || !(squared_normal > kFairlyShaped * edges)) return std::nullopt;
  return Weights((both * along_right - right * along_left) / squared_normal,
                 (both * along_left - left * along_right) / squared_normal);
}

/// REQUIRES: of the corners of `view`, left is not farther than right.
void considerEdges(const View& view, Candidate& best) {
  considerEdge(view.query, view.base, view.left, best);
  considerEdge(view.query, view.base, view.right, best);
  considerEdge(view.query, view.left, view.right, best);
}

/// To where a step from a corner leads, at an offset from the query, neither of which rounding may
/// carry out of the triangle's box; leaves out weights and feature. Not called, so that a step just
/// found is not stored and loaded. Where nearly all of the offset lies along one axis, rounding
/// takes most: 1*u by its sum, 1.5*u by the square and the sums of squares, 1*u by the root. So
/// would the difference of corner and query, if what it lost were not given back, wherever
/// candidates are compared.
[[gnu::always_inline]] inline void goTo(const Vector3d& corner, const Vector3d& step,
                                        const Vector3d& offset, const Vector3d& query,
                                        const Box& box, ClosestPoint& closest) {
  closest.offset = offset.cwiseMax(box.low - query).cwiseMin(box.high - query);
  closest.point = (corner + step).cwiseMax(box.low).cwiseMin(box.high);
  closest.squared_distance = squaredLength(closest.offset);
}

/// What is nearest on the edges, and, where that is not clear, inside the face. Not written into
/// the caller, which seldom asks.
[[gnu::noinline]] ClosestPoint closestBeside(const Vector3d& query, const Corner& base,
                                             const Corner& left, const Corner& right, bool face_too,
                                             const Box& box) {
  const View view =
      isNearer(left, right) ? View(query, base, left, right) : View(query, base, right, left);
  Candidate best = atBase(view);
  considerEdges(view, best);
  if (face_too) considerFace(view, best);
  ClosestPoint closest;
  goTo(best.base->position, best.step, best.offset, query, box, closest);
  closest.barycentric = best.barycentric;
  closest.feature = best.feature;
  return closest;
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
  const Products products(view.offset, view.to_left, view.to_right);
  if (products.along_left >= 0 && products.along_right >= 0 && products.areSafe()) {
    return {view.base.position, view.offset, unit(view.base), static_cast<Feature>(view.base.slot),
            view.base.squared_distance};
  }
  const Box box = boxOf(a, b, c);
  bool is_clear = false;
  const std::optional<Weights> weights =
      plainWeights(products.areSafe() ? products : inSafeUnit(view));
  if (weights) {
    ClosestPoint closest;
    const Vector3d step = weights->step(view);
    const Vector3d offset = view.offset + (step + view.lost);
    goTo(view.base.position, step, offset, query, box, closest);
    is_clear = closest.squared_distance > kNearlyNothing * view.base.squared_distance;
    if (is_clear && weights->areInside() && closest.squared_distance < view.base.squared_distance) {
      closest.barycentric = weights->barycentric(view);
      closest.feature = Feature::kFace;
      return closest;
    }
  }
  return closestBeside(query, view.base, view.left, view.right, !is_clear, box);
}

}  // namespace organ_collision::core
