#include "organ_collision/io/robot_geometry.h"

#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <cmath>
#include <memory>
#include <sstream>
#include <stdexcept>

namespace organ_collision::io {
namespace {

[[noreturn]] void refuse(const std::string& link, const std::string& why) {
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
  refuse(name, "there is none of this name; there are: " + known);
}

const urdf::Collision& onlyCollision(const urdf::Link& link) {
  if (link.collision_array.empty()) refuse(link.name, "it has no <collision> that can be read");
  if (link.collision_array.size() > 1) {
    refuse(link.name, "it has " + std::to_string(link.collision_array.size()) +
                          " <collision>: more than one is not supported by this version");
  }
  return *link.collision_array.front();
}

const urdf::Mesh& mesh(const std::string& link, const urdf::Collision& collision) {
  if (!collision.geometry) refuse(link, "its <collision> has no geometry");
  if (const auto* const mesh = dynamic_cast<const urdf::Mesh*>(collision.geometry.get()))
    return *mesh;
  refuse(link, std::string("its <collision> is ") + name(*collision.geometry) +
                   ", which is not supported by this version; supported: a mesh");
}

Eigen::Vector3d scale(const std::string& link, const urdf::Mesh& mesh) {
  Eigen::Vector3d scale(mesh.scale.x, mesh.scale.y, mesh.scale.z);
  if (scale.allFinite() && (scale.array() != 0.0).all()) return scale;
  std::ostringstream message;
  message << "its mesh has the scale (" << scale.transpose()
          << "), but it must be finite and not 0";
  refuse(link, message.str());
}

Eigen::Isometry3d isometry(const urdf::Pose& pose) {
  const auto& [x, y, z, w] = pose.rotation;
  const Eigen::Vector3d translation(pose.position.x, pose.position.y, pose.position.z);
  return Eigen::Translation3d(translation) * Eigen::Quaterniond(w, x, y, z);
}

}  // namespace

LinkMesh linkMesh(const std::string& robot_description, const std::string& link) {
  const urdf::ModelInterfaceSharedPtr robot = urdf::parseURDF(robot_description);
  if (!robot) refuse(link, "the description cannot be read as URDF");
  const urdf::Collision& collision = onlyCollision(linkNamed(*robot, link));
  const urdf::Mesh& file = mesh(link, collision);
  const Eigen::Isometry3d origin = isometry(collision.origin);
  if (!origin.matrix().allFinite()) refuse(link, "the origin of its <collision> is not finite");
  return {file.filename, scale(link, file), origin};
}

}  // namespace organ_collision::io
