#include "convex/tool_proximity.h"

#include <algorithm>

#include "convex/hull_distance.h"
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

/// Where the corners of both are of about the size 1.
core::UnitFrame unitFrameOf(const Hull& first, const Hull& second) {
  core::Box box;
  for (const Hull* hull : {&first, &second}) {
    for (const Vector3d& corner : hull->corners) box.add(corner);
  }
  return core::unitFrame(box);
}

/// Coordinates that FCL's squares would lose become 0; only of denormal sizes all are that small.
Points inFrame(const core::UnitFrame& frame, Points points) {
  constexpr double kLeast = 0x1p-500;
  for (Vector3d& point : points) {
    point = frame(point);
    point = (point.array().abs() < kLeast).select(0.0, point);
  }
  return points;
}

}  // namespace

Proximity hullProximity(const core::Shape& first, const core::Shape& second) {
  core::requireUsable(first);
  core::requireUsable(second);
  const Hull first_hull = hullOf(first);
  const Hull second_hull = hullOf(second);
  const core::UnitFrame unit = unitFrameOf(first_hull, second_hull);
  const HullDistance found =
      hullDistance(inFrame(unit, first_hull.corners), inFrame(unit, second_hull.corners));
  const auto back = [&unit](const Vector3d& point) -> Vector3d {
    return point / unit.scale + unit.centre;
  };
  const double radii = first_hull.radius + second_hull.radius;
  const double upper_bound = found.most / unit.scale - radii;
  const double gap = gapAlong(found.normal, first_hull.corners, second_hull.corners);
  const double lower_bound = std::min(gap - radii, upper_bound);
  const bool colliding = upper_bound <= 0.0;
  return {back(found.on_first) + first_hull.radius * found.normal,
          back(found.on_second) - second_hull.radius * found.normal,
          found.normal,
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
  return areConvex(first, second) ? hullProximity(first, second)
                                  : core::proximity(first, second, accuracy);
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
