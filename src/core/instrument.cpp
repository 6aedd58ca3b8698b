#include "organ_collision/core/instrument.h"

#include <sstream>
#include <stdexcept>

#include "core/rigid_pose.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector3d;

Vector3d moved(const Vector3d& point, const Eigen::Isometry3d& pose) { return pose * point; }

Triangle moved(const Triangle& triangle, const Eigen::Isometry3d& pose) {
  return {pose * triangle.a, pose * triangle.b, pose * triangle.c};
}

Sphere moved(const Sphere& sphere, const Eigen::Isometry3d& pose) {
  return {pose * sphere.centre, sphere.radius};
}

Capsule moved(const Capsule& capsule, const Eigen::Isometry3d& pose) {
  return {pose * capsule.start, pose * capsule.end, capsule.radius};
}

RigidMesh moved(const RigidMesh& mesh, const Eigen::Isometry3d& pose) {
  return {mesh.surface, pose * mesh.pose, mesh.convex};
}

Box boxAround(const RoundShape& shape) {
  const Box core = boxOf(shape.core);
  const Vector3d margin = Vector3d::Constant(shape.radius);
  return {core.low - margin, core.high + margin};
}

Box boxAround(const RigidMesh& mesh) {
  Box box;
  for (const Vector3d& corner : cornersOf(mesh.surface->health().box)) box.add(mesh.pose * corner);
  return box;
}

void requireUsableMesh(const RigidMesh& mesh) {
  if (!mesh.surface) throw std::invalid_argument("a mesh shape has no surface");
  if (!mesh.pose.matrix().allFinite())
    throw std::invalid_argument("a mesh shape has a pose that is not finite");
  requireRigid(mesh.pose);
}

}  // namespace

Shape transformed(const Shape& shape, const Eigen::Isometry3d& target_from_shape) {
  return std::visit([&](const auto& kind) -> Shape { return moved(kind, target_from_shape); },
                    shape);
}

Box boxOf(const Shape& shape) {
  if (const auto* mesh = std::get_if<RigidMesh>(&shape)) return boxAround(*mesh);
  return boxAround(*roundShape(shape));
}

Box boxOf(const Shapes& shapes, const Eigen::Isometry3d& target_from_shapes) {
  Box box;
  for (const Shape& shape : shapes) box.add(boxOf(transformed(shape, target_from_shapes)));
  return box;
}

void requireUsable(const Shape& shape) {
  if (const auto* mesh = std::get_if<RigidMesh>(&shape)) return requireUsableMesh(*mesh);
  const auto [core, radius] = *roundShape(shape);
  requireUsable(core);
  if (radius >= 0.0 && radius < kLargestCoordinate) return;
  std::ostringstream message;
  message << "radius is " << radius << ": it must be >= 0 and below " << kLargestCoordinate;
  throw std::invalid_argument(message.str());
}

std::optional<RoundShape> roundShape(const Shape& shape) {
  if (const auto* point = std::get_if<Vector3d>(&shape))
    return RoundShape{{*point, *point, *point}, 0.0};
  if (const auto* triangle = std::get_if<Triangle>(&shape)) return RoundShape{*triangle, 0.0};
  if (const auto* sphere = std::get_if<Sphere>(&shape))
    return RoundShape{{sphere->centre, sphere->centre, sphere->centre}, sphere->radius};
  if (const auto* capsule = std::get_if<Capsule>(&shape))
    return RoundShape{{capsule->start, capsule->end, capsule->end}, capsule->radius};
  return std::nullopt;
}

}  // namespace organ_collision::core
