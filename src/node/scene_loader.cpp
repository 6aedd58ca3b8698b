#include "node/scene_loader.h"

#include <ros/console.h>
#include <ros/package.h>

#include <stdexcept>

#include "node/conversions.h"
#include "organ_collision/io/mesh_io.h"
#include "organ_collision/io/robot_geometry.h"

namespace organ_collision::node {
namespace {

std::optional<std::filesystem::path> findPackage(const std::string& package) {
  const std::string path = ros::package::getPath(package);
  if (path.empty()) return std::nullopt;
  return path;
}

std::string robotDescription(const ros::NodeHandle& node) {
  std::string key;
  std::string description;
  if (node.searchParam("robot_description", key) && node.getParam(key, description))
    return description;
  throw std::invalid_argument("the parameter robot_description is not set");
}

core::TriangleMesh load(const std::string& url, double scale, const io::Scene& scene) {
  const std::filesystem::path file = io::resolveMesh(url, findPackage, scene.mesh_root);
  ROS_INFO("reading %s", file.c_str());
  return io::loadMesh(file, scale);
}

core::TriangleMesh meshOf(const io::Organ& organ, const io::Scene& scene,
                          const ros::NodeHandle& node) {
  if (const auto* file = std::get_if<io::MeshFile>(&organ.geometry))
    return load(file->url, file->scale, scene);
  const io::LinkMesh link =
      io::linkMesh(robotDescription(node), std::get<io::RobotLink>(organ.geometry).name);
  return io::transformed(load(link.url, 1.0, scene), link.scale, link.link_from_mesh);
}

std::unique_ptr<Organ> loadOrgan(const io::Organ& description, const io::Scene& scene,
                                 const ros::NodeHandle& node) {
  core::TriangleMesh mesh = meshOf(description, scene, node);
  ROS_INFO("%s: building the hierarchy of %zu triangles", description.name.c_str(),
           mesh.triangleCount());
  auto organ = std::make_unique<Organ>(description.name, description.frame, std::move(mesh));
  const std::shared_ptr<const OrganSnapshot> loaded = organ->snapshot();
  ROS_INFO("%s: ready after %.3f s, depth %zu, %.1f MB", description.name.c_str(),
           loaded->last_duration, loaded->organ.tree().depth(),
           1e-6 * static_cast<double>(loaded->organ.memory()));
  for (const std::string& sentence : core::warnings(loaded->organ.health())) {
    ROS_WARN("%s: %s", description.name.c_str(), sentence.c_str());
  }
  return organ;
}

}  // namespace

io::Scene readScene(const ros::NodeHandle& private_node) {
  XmlRpc::XmlRpcValue parameter;
  if (!private_node.getParam("scene", parameter)) {
    throw std::invalid_argument("the parameter " + private_node.resolveName("scene") +
                                " is not set: load a scene, as organ_collision.launch does");
  }
  return io::parseScene(fromParameter(parameter));
}

Organs loadOrgans(const io::Scene& scene, const ros::NodeHandle& node) {
  Organs organs;
  for (const io::Organ& organ : scene.organs) {
    try {
      organs.push_back(loadOrgan(organ, scene, node));
    } catch (const std::exception& error) {
      throw std::runtime_error("organ " + organ.name + ": " + error.what());
    }
  }
  return organs;
}

}  // namespace organ_collision::node
