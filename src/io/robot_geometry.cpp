#include "organ_collision/io/robot_geometry.h"

#include <tinyxml.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <cmath>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "primitive_mesh.h"

namespace organ_collision::io {
namespace {

[[noreturn]] void refuseLink(const std::string& link, const std::string& why) {
  throw std::invalid_argument("link '" + link + "' of the robot description: " + why);
}

const char* name(const urdf::Geometry& geometry) {
  switch (geometry.type) {
    case urdf::Geometry::SPHERE:
      return "a sphere";
    case urdf::Geometry::BOX:
      return "a box";
    case urdf::Geometry::CYLINDER:
      return "a cylinder";
    default:
      return "a geometry of unknown kind";
  }
}

const urdf::Link& linkNamed(const urdf::ModelInterface& robot, const std::string& name) {
  if (const urdf::LinkConstSharedPtr link = robot.getLink(name)) return *link;
  std::string known;
  for (const auto& [other, link] : robot.links_) {
    known.append(known.empty() ? "" : ", ").append(other);
  }
  refuseLink(name, "there is none of this name; there are: " + known);
}

const urdf::Collision& onlyCollision(const urdf::Link& link) {
  if (link.collision_array.size() == 1) return *link.collision_array.front();
  refuseLink(link.name, "it has " + std::to_string(link.collision_array.size()) +
                            " <collision>, but an organ is one mesh");
}

const urdf::Mesh& mesh(const std::string& link, const urdf::Collision& collision) {
  if (!collision.geometry) refuseLink(link, "its <collision> has no geometry");
  if (const auto* const mesh = dynamic_cast<const urdf::Mesh*>(collision.geometry.get()))
    return *mesh;
  refuseLink(link, std::string("its <collision> is ") + name(*collision.geometry) +
                       ", but an organ is a mesh");
}

Eigen::Vector3d scale(const std::string& link, const urdf::Mesh& mesh) {
  Eigen::Vector3d scale(mesh.scale.x, mesh.scale.y, mesh.scale.z);
  if (scale.allFinite() && (scale.array() != 0.0).all()) return scale;
  std::ostringstream message;
  message << "its mesh has the scale (" << scale.transpose()
          << "), but it must be finite and not 0";
  refuseLink(link, message.str());
}

Eigen::Isometry3d isometry(const urdf::Pose& pose) {
  const auto& [x, y, z, w] = pose.rotation;
  const Eigen::Vector3d translation(pose.position.x, pose.position.y, pose.position.z);
  return Eigen::Translation3d(translation) * Eigen::Quaterniond(w, x, y, z);
}

Eigen::Isometry3d origin(const std::string& link, const urdf::Collision& collision) {
  Eigen::Isometry3d origin = isometry(collision.origin);
  if (!origin.matrix().allFinite()) refuseLink(link, "the origin of its <collision> is not finite");
  return origin;
}

/// Returns the size [m] if it can be one.
double size(const std::string& link, const char* what, double size) {
  if (std::isfinite(size) && size > 0.0) return size;
  std::ostringstream message;
  message << "its " << what << " is " << size << ", but it must be finite and above 0";
  refuseLink(link, message.str());
}

core::Shape convex(const core::TriangleMesh& mesh, const Eigen::Isometry3d& pose) {
  return core::RigidMesh{std::make_shared<const core::CollisionMesh>(mesh), pose, true};
}

LinkPiece piece(const std::string& link, const urdf::Collision& collision) {
  const Eigen::Isometry3d pose = origin(link, collision);
  const urdf::Geometry* const geometry = collision.geometry.get();
  if (const auto* const sphere = dynamic_cast<const urdf::Sphere*>(geometry)) {
    return core::Sphere{pose.translation(), size(link, "sphere's radius", sphere->radius)};
  }
  if (const auto* const box = dynamic_cast<const urdf::Box*>(geometry)) {
    const auto& [x, y, z] = box->dim;
    return convex(
        boxMesh({size(link, "box's x", x), size(link, "box's y", y), size(link, "box's z", z)}),
        pose);
  }
  if (const auto* const cylinder = dynamic_cast<const urdf::Cylinder*>(geometry)) {
    return convex(prismMesh(size(link, "cylinder's radius", cylinder->radius),
                            size(link, "cylinder's length", cylinder->length), kCylinderSides),
                  pose);
  }
  const urdf::Mesh& file = mesh(link, collision);
  return LinkMesh{file.filename, scale(link, file), pose};
}

/// How many <collision> the text has: urdfdom leaves out those after one that it cannot read.
std::size_t collisionCount(const std::string& robot_description, const std::string& link) {
  TiXmlDocument document;
  document.Parse(robot_description.c_str());
  std::size_t count = 0;
  const TiXmlElement* each = document.RootElement()->FirstChildElement("link");
  for (; each != nullptr; each = each->NextSiblingElement("link")) {
    if (each->Attribute("name") != link) continue;
    const TiXmlElement* collision = each->FirstChildElement("collision");
    for (; collision != nullptr; collision = collision->NextSiblingElement("collision")) ++count;
  }
  return count;
}

/// The link, every <collision> of which could be read: one or more.
std::shared_ptr<const urdf::Link> readLink(const std::string& robot_description,
                                           const std::string& name) {
  const urdf::ModelInterfaceSharedPtr robot = urdf::parseURDF(robot_description);
  if (!robot) refuseLink(name, "the description cannot be read as URDF");
  const urdf::Link& link = linkNamed(*robot, name);
  const std::size_t count = link.collision_array.size();
  if (count == 0) refuseLink(name, "it has no <collision> that can be read");
  const std::size_t wanted = collisionCount(robot_description, name);
  if (count != wanted) {
    refuseLink(name, "only " + std::to_string(count) + " of its " + std::to_string(wanted) +
                         " <collision> can be read");
  }
  return {robot, &link};  // which the robot owns
}

}  // namespace

std::vector<LinkPiece> linkPieces(const std::string& robot_description, const std::string& link) {
  const auto read = readLink(robot_description, link);
  std::vector<LinkPiece> pieces;
  for (const urdf::CollisionSharedPtr& collision : read->collision_array)
    pieces.push_back(piece(link, *collision));
  return pieces;
}

LinkMesh linkMesh(const std::string& robot_description, const std::string& link) {
  const auto read = readLink(robot_description, link);
  const urdf::Collision& collision = onlyCollision(*read);
  const urdf::Mesh& file = mesh(link, collision);
  return {file.filename, scale(link, file), origin(link, collision)};
}

}  // namespace organ_collision::io
