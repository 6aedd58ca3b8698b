#include "convex/tool_proximity.h"

#include <ccd/vec3.h>
#include <fcl/geometry/shape/convex.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk.h>
#include <fcl/narrowphase/detail/convexity_based_algorithm/gjk_libccd.h>
#include <fcl/narrowphase/detail/failed_at_this_configuration.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "organ_collision/core/unit_frame.h"

namespace organ_collision::convex {
namespace {

using core::Points;
using core::Proximity;
using Eigen::Vector3d;

/// All within `radius` of the hull of `corners`.
struct Hull {
  Points corners;
  double radius;
};

/// Without vertices that no triangle has.
Points cornersOf(const core::TriangleMesh& mesh) {
  if (mesh.usesAllVertices()) return mesh.positions();
  Points points;
  for (const core::Corners& corners : mesh.triangles())
    for (const core::VertexId corner : corners) points.push_back(mesh.position(corner));
  return points;
}

Hull hullOf(const core::Shape& shape) {
  const auto* mesh = std::get_if<core::RigidMesh>(&shape);
  if (mesh == nullptr) {
    const auto [core, radius] = *core::roundShape(shape);
    return {{core.a, core.b, core.c}, radius};
  }
  Hull hull{cornersOf(mesh->surface->mesh()), 0.0};
  for (Vector3d& corner : hull.corners) corner = mesh->pose * corner;
  return hull;
}

/// The corner that is farthest along `direction`.
const Vector3d& farthest(const Hull& hull, const Vector3d& direction) {
  return *std::max_element(hull.corners.begin(), hull.corners.end(),
                           [&](const Vector3d& left, const Vector3d& right) {
                             return left.dot(direction) < right.dot(direction);
                           });
}

/// As libccd asks for it.
void support(const void* hull, const ccd_vec3_t* direction, ccd_vec3_t* corner) {
  const Eigen::Map<const Vector3d> along(direction->v);
  Eigen::Map<Vector3d>(corner->v) = farthest(*static_cast<const Hull*>(hull), along);
}

/// Where the corners of both are of about the size 1: FCL's tolerances are absolute.
core::UnitFrame unitFrameOf(const Hull& first, const Hull& second) {
  core::Box box;
  for (const Hull* hull : {&first, &second}) {
    for (const Vector3d& corner : hull->corners) box.add(corner);
  }
  return core::unitFrame(box);
}

Hull scaled(Hull hull, const core::UnitFrame& frame) {
  for (Vector3d& corner : hull.corners) corner = frame(corner);
  return hull;
}

/// What GJK and EPA find of two hulls without their radii.
struct Found {
  double distance;  // negative: minus the depth
  Vector3d on_first, on_second;
};

constexpr unsigned kIterations = 500;

fcl::Convexd convexOf(const Hull& hull) {
  // Its support function looks at the corners alone: no faces are wanted.
  return {std::make_shared<const std::vector<Vector3d>>(hull.corners), 0,
          std::make_shared<const std::vector<int>>()};
}

using Gjk = fcl::detail::GJK<double>;

Found pointsOf(const Gjk& gjk, const fcl::detail::MinkowskiDiff<double>& difference) {
  Found found{gjk.distance, Vector3d::Zero(), Vector3d::Zero()};
  const auto* simplex = gjk.getSimplex();
  for (std::size_t i = 0; i < simplex->rank; ++i) {
    const Vector3d& direction = simplex->c[i]->d;
    found.on_first += simplex->p[i] * difference.support(direction, 0);
    found.on_second += simplex->p[i] * difference.support(-direction, 1);
  }
  return found;
}

/// How far apart the hulls are along a direction; never more than their distance.
double gapAlong(const Vector3d& unit, const Hull& first, const Hull& second) {
  return unit.dot(farthest(second, -unit) - farthest(first, unit));
}

constexpr double kProven = 1e-9;  // of the size 1

/// By how much the hulls may be nearer or deeper than was found.
double leftOpen(const Found& found, const Hull& first, const Hull& second) {
  const Vector3d apart = (found.distance > 0.0 ? 1.0 : -1.0) * (found.on_second - found.on_first);
  return found.distance - gapAlong(apart.stableNormalized(), first, second);
}

/// By GJK; nothing unless the hulls are apart. FCL's ends too early in one of some hundred pairs,
/// where its simplex has become flat: it starts anew from there until the gap proves the distance.
/// FCL's other GJK, that on libccd, takes a corner that is as far as the last for the end of the
/// search, so aligned boxes stop it each time.
std::optional<Found> separated(const Hull& first, const Hull& second) {
  constexpr double kPrecision = 1e-12;  // relative, of the distance
  constexpr int kAttempts = 32;
  const fcl::Convexd first_convex = convexOf(first);
  const fcl::Convexd second_convex = convexOf(second);
  fcl::detail::MinkowskiDiff<double> difference;
  difference.shapes[0] = &first_convex;
  difference.shapes[1] = &second_convex;
  difference.toshape1.setIdentity();
  difference.toshape0.setIdentity();
  std::optional<Found> best;
  Vector3d guess = Vector3d::UnitX();
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    Gjk gjk(kIterations, kPrecision);
    if (gjk.evaluate(difference, guess) != Gjk::Valid) return best;
    const Found found = pointsOf(gjk, difference);
    if (!best || found.distance < best->distance) best = found;
    const Vector3d apart = best->on_second - best->on_first;
    if (apart.isZero(0.0)) return std::nullopt;
    if (leftOpen(*best, first, second) <= kProven) return best;
    // From there, or from more and more nearly there.
    guess = -apart;
    if (attempt % 2 != 0)
      guess = Vector3d::Unit(attempt % 3) - 0.125 * attempt * apart.stableNormalized();
  }
  return best;
}

/// By EPA; nothing unless it finds that the hulls overlap.
std::optional<Found> overlapping(Hull first, Hull second) {
  constexpr double kPrecision = 1e-10;  // of the size 1
  Found found{};
  try {
    fcl::detail::GJKSignedDistance(&first, support, &second, support, kIterations, kPrecision,
                                   &found.distance, &found.on_first, &found.on_second);
  } catch (const fcl::detail::FailedAtThisConfiguration&) {
    return std::nullopt;
  }
  if (found.distance >= 0.0) return std::nullopt;
  return found;
}

std::optional<Found> swapped(std::optional<Found> found) {
  if (found) std::swap(found->on_first, found->on_second);
  return found;
}

/// GJK takes some in a hundred thousand pairs that overlap to be apart, and EPA ends too early for
/// as many: each is asked, EPA of the swapped pair too, until the gap proves the answer.
std::optional<Found> ask(const Hull& first, const Hull& second) {
  const std::array<std::function<std::optional<Found>()>, 3> attempts = {
      [&] { return separated(first, second); }, [&] { return overlapping(first, second); },
      [&] { return swapped(overlapping(second, first)); }};
  std::optional<Found> best;
  double left_open = std::numeric_limits<double>::infinity();
  for (const auto& attempt : attempts) {
    const std::optional<Found> found = attempt();
    if (!found || !(leftOpen(*found, first, second) < left_open)) continue;
    best = found;
    left_open = leftOpen(*found, first, second);
    if (left_open <= kProven) break;
  }
  return best;
}

}  // namespace

std::optional<Proximity> hullProximity(const core::Shape& first, const core::Shape& second) {
  const Hull first_hull = hullOf(first);
  const Hull second_hull = hullOf(second);
  const core::UnitFrame unit = unitFrameOf(first_hull, second_hull);
  const std::optional<Found> found = ask(scaled(first_hull, unit), scaled(second_hull, unit));
  if (!found) return std::nullopt;
  const Vector3d apart =
      (found->distance > 0.0 ? 1.0 : -1.0) * (found->on_second - found->on_first);
  if (!apart.allFinite() || apart.isZero(0.0)) return std::nullopt;

  const auto back = [&unit](const Vector3d& point) -> Vector3d {
    return point / unit.scale + unit.centre;
  };
  const Vector3d normal = apart.stableNormalized();
  const double radii = first_hull.radius + second_hull.radius;
  const double upper_bound =
      (found->distance > 0.0 ? apart.norm() : found->distance) / unit.scale - radii;
  const double lower_bound =
      std::min(gapAlong(normal, first_hull, second_hull) - radii, upper_bound);
  const bool colliding = upper_bound <= 0.0;
  return Proximity{back(found->on_first) + first_hull.radius * normal,
                   back(found->on_second) - second_hull.radius * normal,
                   normal,
                   upper_bound,
                   lower_bound,
                   upper_bound,
                   colliding,
                   colliding || lower_bound > 0.0,
                   std::nullopt,
                   std::nullopt,
                   {}};
}

namespace {

bool isConvexMesh(const core::Shape& shape) {
  const auto* mesh = std::get_if<core::RigidMesh>(&shape);
  return mesh != nullptr && mesh->convex;
}

bool areConvex(const core::Shape& first, const core::Shape& second) {
  const auto is_convex = [](const core::Shape& shape) {
    return isConvexMesh(shape) || core::roundShape(shape).has_value();
  };
  return (isConvexMesh(first) || isConvexMesh(second)) && is_convex(first) && is_convex(second);
}

Proximity ofPieces(const core::Shape& first, const core::Shape& second,
                   const core::Accuracy& accuracy) {
  if (areConvex(first, second)) {
    if (const auto found = hullProximity(first, second)) return *found;
  }
  return core::proximity(first, second, accuracy);
}

}  // namespace

Proximity toolProximity(const core::Shapes& first, const Eigen::Isometry3d& second_from_first,
                        const core::Shapes& second, const core::Accuracy& accuracy) {
  std::optional<Proximity> nearest;
  for (const core::Shape& piece : first) {
    const core::Shape moved = core::transformed(piece, second_from_first);
    for (const core::Shape& other : second) {
      const Proximity found = ofPieces(moved, other, accuracy);
      nearest = nearest ? core::united(*nearest, found) : found;
    }
  }
  return *nearest;
}

}  // namespace organ_collision::convex
