#include "convex/hull_distance.h"

#include <fcl/geometry/shape/convex.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "convex/polytope.h"

namespace organ_collision::convex {
namespace {

using core::Points;
using Eigen::Vector3d;
using Gjk = fcl::detail::GJK<double>;

constexpr double kProven = 1e-9;  // of the size 1
constexpr unsigned kIterations = 500;
constexpr double kPrecision = 1e-12;

/// Two hulls as FCL asks for them.
class Pair {
 public:
  Pair(const Points& first, const Points& second)
      : first_(convexOf(first)), second_(convexOf(second)) {
    difference_.shapes[0] = &first_;
    difference_.shapes[1] = &second_;
    difference_.toshape1.setIdentity();
    difference_.toshape0.setIdentity();
  }

  const fcl::detail::MinkowskiDiff<double>& difference() const { return difference_; }

  /// The point of each hull that a point of their difference stands for.
  HullDistance at(const Gjk::Simplex& simplex) const {
    HullDistance found{};
    found.on_first = found.on_second = Vector3d::Zero();
    for (std::size_t i = 0; i < simplex.rank; ++i) {
      const Vector3d& direction = simplex.c[i]->d;
      found.on_first += simplex.p[i] * difference_.support(direction, 0);
      found.on_second += simplex.p[i] * difference_.support(-direction, 1);
    }
    return found;
  }

 private:
  static fcl::Convexd convexOf(const Points& points) {
    // Its support function looks at the corners alone: no faces are wanted.
    return {std::make_shared<const std::vector<Vector3d>>(points), 0,
            std::make_shared<const std::vector<int>>()};
  }

  fcl::Convexd first_, second_;
  fcl::detail::MinkowskiDiff<double> difference_;
};

bool isProven(const HullDistance& found) { return std::abs(found.most - found.gap) <= kProven; }

/// What GJK finds of two hulls.
struct Found {
  std::optional<HullDistance> apart;
  bool have_common = false;  ///< a point, but for kPrecision
};

/// FCL's ends too early in one of some hundred pairs, where its simplex has become flat: it starts
/// anew from there until the gap proves the distance. FCL's other GJK, that on libccd, takes a
/// corner that is as far as the last for the end of the search, so aligned boxes stop it each time.
Found byGjk(const Points& first, const Points& second) {
  constexpr int kAttempts = 32;
  const Pair pair(first, second);
  std::optional<HullDistance> best;
  Vector3d guess = Vector3d::UnitX();
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    Gjk gjk(kIterations, kPrecision);
    const Gjk::Status status = gjk.evaluate(pair.difference(), guess);
    if (status == Gjk::Inside) return {best, true};
    if (status != Gjk::Valid) return {best, false};
    HullDistance found = pair.at(*gjk.getSimplex());
    const Vector3d apart = found.on_second - found.on_first;
    if (apart.isZero(0.0)) return {std::nullopt, true};
    found.most = apart.norm();
    if (!best || found.most < best->most) {
      found.normal = apart.stableNormalized();
      found.gap = gapAlong(found.normal, first, second);
      best = found;
    }
    if (isProven(*best)) break;
    // From there, or from more and more nearly there.
    guess = -best->normal;
    if (attempt % 2 != 0) guess = Vector3d::Unit(attempt % 3) - 0.125 * attempt * best->normal;
  }
  return {best, false};
}

/// Of these normals, those that lead along `way` (of faces that are as near, or narrow, some do
/// not): the one along which the gap is largest.
std::optional<Vector3d> bestNormal(const std::array<Vector3d, 3>& normals, const Vector3d& way,
                                   const Points& first, const Points& second) {
  std::optional<Vector3d> best;
  double largest_gap = -std::numeric_limits<double>::infinity();
  for (const Vector3d& normal : normals) {
    if (normal.isZero(0.0) || normal.dot(way) < way.norm() - kProven) continue;
    const double gap = gapAlong(normal, first, second);
    if (!(gap > largest_gap)) continue;
    largest_gap = gap;
    best = normal;
  }
  return best;
}

/// By EPA; nothing where no normal is known. Faces that are about as near as the nearest are ways
/// out as well: each is taken to its end, as the points may come to lie on any of them. REQUIRES:
/// the corners are not in one plane.
std::optional<HullDistance> byEpa(const Polytope::FourCorners& corners, const Points& first,
                                  const Points& second) {
  constexpr int kSteps = 256;
  Polytope polytope(corners);
  double least = std::numeric_limits<double>::max();  // of faces that no corner lies beyond
  Vector3d way_out = Vector3d::Zero();
  for (int i = 0; i < kSteps; ++i) {
    const auto [numbers, normal, offset] = polytope.nearestPlane();
    if (offset > least + kProven / 8) break;
    const Polytope::Corner corner = farthestCorner(normal, first, second);
    const bool is_outermost = normal.dot(corner.place) - offset <= kProven / 8;
    if (is_outermost && offset < least) {
      least = offset;
      way_out = normal;
    }
    if (is_outermost || !polytope.add(corner)) polytope.passByNearest();
  }
  // Of the nearest plane perhaps another triangle is known than the one that is nearest: on to it.
  for (int i = 0; i < kSteps && !polytope.holdsOrigin(); ++i) {
    const HullDistance nearest = polytope.nearestPoints();
    const Vector3d back = nearest.on_second - nearest.on_first;
    if (!polytope.add(farthestCorner(back, first, second))) break;
  }
  HullDistance found = polytope.nearestPoints();
  const Vector3d apart = found.on_second - found.on_first;
  const Vector3d way = polytope.holdsOrigin() ? -apart : apart;
  found.most = polytope.holdsOrigin() ? -way.norm() : way.norm();
  const std::optional<Vector3d> normal =
      bestNormal({found.normal, way.stableNormalized(), way_out}, way, first, second);
  if (!normal) return std::nullopt;
  found.normal = *normal;
  found.gap = gapAlong(found.normal, first, second);
  return found;
}

Points moved(Points points, const Vector3d& shift) {
  for (Vector3d& point : points) point += shift;
  return points;
}

/// How much farther or less far apart than `distance` the points are.
double misfit(const HullDistance& found, double distance) {
  return std::abs((found.on_second - found.on_first).norm() - std::abs(distance));
}

/// The other's points where they fit the gap better.
void takeNearer(HullDistance& best, const HullDistance& other) {
  if (!(misfit(other, best.gap) < misfit(best, best.gap))) return;
  best.on_first = other.on_first;
  best.on_second = other.on_second;
}

/// Uphill from a normal to one along which the gap is largest, or the depth least, of all nearby:
/// pushed apart along it, the hulls have a distance that GJK knows well, and its normal is better.
HullDistance uphill(const Points& first, const Points& second, const Vector3d& normal) {
  constexpr int kSteps = 16;
  constexpr double kRoom = 0x1p-7;
  constexpr double kRounding = 1e-15;
  constexpr double kLoss =
      16 * kPrecision;  // points of GJK are worth it: the first are any corners
  const double gap_there = gapAlong(normal, first, second);
  HullDistance best = {gap_there, gap_there, normal, farthest(first, normal),
                       farthest(second, -normal)};
  for (int i = 0; i < kSteps; ++i) {
    const Vector3d shift = (kRoom - best.gap) * best.normal;
    const std::optional<HullDistance> apart = byGjk(first, moved(second, shift)).apart;
    if (!apart) break;
    const double gap = gapAlong(apart->normal, first, second);
    const double gained = gap - best.gap;
    const HullDistance there = {gap, gap, apart->normal, apart->on_first, apart->on_second - shift};
    if (gained < -kLoss) {
      takeNearer(best, there);
      break;
    }
    best = there;
    if (gained <= kRounding) break;
  }
  return best;
}

const HullDistance& higher(const HullDistance& one, const HullDistance& other) {
  return one.gap > other.gap ? one : other;
}

/// Of the plane that they are about in.
Vector3d normalOf(const Polytope::FourCorners& corners) {
  const Vector3d along = corners[1].place - corners[0].place;
  const Vector3d normal = along.cross(corners[2].place - corners[0].place);
  if (normal.norm() > kProven * along.squaredNorm()) return normal.stableNormalized();
  return along.isZero(0.0) ? Vector3d(1, 0, 0) : along.unitOrthogonal();  // all but on a line
}

}  // namespace

const Vector3d& farthest(const Points& points, const Vector3d& direction) {
  return *std::max_element(points.begin(), points.end(),
                           [&](const Vector3d& left, const Vector3d& right) {
                             return left.dot(direction) < right.dot(direction);
                           });
}

double gapAlong(const Vector3d& unit, const Points& first, const Points& second) {
  return unit.dot(farthest(second, -unit) - farthest(first, unit));
}

HullDistance hullDistance(const Points& first, const Points& second) {
  const auto [apart, have_common] = byGjk(first, second);
  if (apart && isProven(*apart)) return *apart;
  const Polytope::FourCorners corners = farCorners(first, second);
  std::optional<HullDistance> deep;
  if (!areInOnePlane(corners)) deep = byEpa(corners, first, second);
  if (deep && isProven(*deep)) return *deep;

  const Vector3d normal = normalOf(corners);
  HullDistance best = higher(uphill(first, second, normal), uphill(first, second, -normal));
  best.most = (best.on_second - best.on_first).norm();
  if (have_common) best.most = std::min(best.most, 0.0);
  for (const auto& known : {deep, apart}) {
    if (!known) continue;
    const double most = std::min(best.most, known->most);
    best = higher(best, uphill(first, second, known->normal));
    best.most = most;
    // Where a gap is higher but by a rounding, its points may be any corners.
    if (misfit(*known, most) < misfit(best, most)) {
      best.on_first = known->on_first;
      best.on_second = known->on_second;
    }
  }
  best.most = std::max(best.gap, best.most);
  return best;
}

}  // namespace organ_collision::convex
