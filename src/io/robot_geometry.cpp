#include "organ_collision/io/robot_geometry.h"

#include <cmath>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "primitive_mesh.h"
#include "robot_reader.h"

namespace organ_collision::io {
namespace {

[[noreturn]] void refuseLink(const std::string& link, const std::string& why) {
  throw std::invalid_argument("link '" + link + "' of the robot description: " + why);
}

const char* name(GeometryKind kind) {
  switch (kind) {
    case GeometryKind::kMesh:
      return "a mesh";
    case GeometryKind::kSphere:
      return "a sphere";
    case GeometryKind::kBox:
      return "a box";
    case GeometryKind::kCylinder:
      return "a cylinder";
  }
  return "";  // there is no other
}

Eigen::Isometry3d origin(const std::string& link, const LinkGeometry& geometry) {
  const Eigen::Isometry3d& origin = geometry.link_from_geometry;
  if (!origin.matrix().allFinite()) refuseLink(link, "the origin of its <collision> is not finite");
  const Eigen::Vector3d at = origin.translation();
  if (core::isUsable(at)) return origin;
  std::ostringstream message;
  message << "the origin of its <collision> is (" << at.x() << ", " << at.y() << ", " << at.z()
          << "), but its coordinates must be below " << core::kLargestCoordinate;
  refuseLink(link, message.str());
}

LinkMesh mesh(const std::string& link, const LinkCollision& collision) {
  const Eigen::Vector3d& scale = collision.geometry.size;
  if (scale.allFinite() && (scale.array() != 0.0).all())
    return {collision.url, scale, origin(link, collision.geometry)};
  std::ostringstream message;
  message << "its mesh has the scale (" << scale.transpose()
          << "), but it must be finite and not 0";
  refuseLink(link, message.str());
}

/// Returns the size [m] if it can be one.
double size(const std::string& link, const char* what, double size) {
  if (size > 0.0 && size < core::kLargestCoordinate) return size;
  std::ostringstream message;
  message << "its " << what << " is " << size << ", but it must be above 0 and below "
          << core::kLargestCoordinate;
  refuseLink(link, message.str());
}

core::Shape convex(const core::TriangleMesh& mesh, const Eigen::Isometry3d& pose) {
  return core::RigidMesh{std::make_shared<const core::CollisionMesh>(mesh), pose, true};
}

core::Shape sphere(const std::string& link, const LinkGeometry& geometry) {
  return core::Sphere{origin(link, geometry).translation(),
                      size(link, "sphere's radius", geometry.size[0])};
}

core::Shape box(const std::string& link, const LinkGeometry& geometry) {
  const auto& sides = geometry.size;
  return convex(boxMesh({size(link, "box's x", sides[0]), size(link, "box's y", sides[1]),
                         size(link, "box's z", sides[2])}),
                origin(link, geometry));
}

core::Shape cylinder(const std::string& link, const LinkGeometry& geometry) {
  const double radius = size(link, "cylinder's radius", geometry.size[0]);
  const double of_prism = radius / std::cos(M_PI / kCylinderSides);
  return convex(prismMesh(size(link, "cylinder's radius, with a prism about it,", of_prism),
                          size(link, "cylinder's length", geometry.size[1]), kCylinderSides),
                origin(link, geometry));
}

LinkPiece piece(const std::string& link, const LinkCollision& collision) {
  switch (collision.geometry.kind) {
    case GeometryKind::kSphere:
      return sphere(link, collision.geometry);
    case GeometryKind::kBox:
      return box(link, collision.geometry);
    case GeometryKind::kCylinder:
      return cylinder(link, collision.geometry);
    default:
      return mesh(link, collision);
  }
}

}  // namespace

std::vector<LinkPiece> linkPieces(const std::string& robot_description, const std::string& link) {
  std::vector<LinkPiece> pieces;
  for (const LinkCollision& collision : readCollisionsInChild(robot_description, link))
    pieces.push_back(piece(link, collision));
  return pieces;
}

LinkMesh linkMesh(const std::string& robot_description, const std::string& link) {
  const auto collisions = readCollisionsInChild(robot_description, link);
  if (collisions.size() != 1) {
    refuseLink(link, "it has " + std::to_string(collisions.size()) +
                         " <collision>, but an organ is one mesh");
  }
  const LinkCollision& collision = collisions.front();
  if (collision.geometry.kind == GeometryKind::kMesh) return mesh(link, collision);
  refuseLink(link, std::string("its <collision> is ") + name(collision.geometry.kind) +
                       ", but an organ is a mesh");
}

}  // namespace organ_collision::io
