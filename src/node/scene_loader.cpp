#include "node/scene_loader.h"

#include <ros/console.h>
#include <ros/package.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "node/conversions.h"
#include "node/stopwatch.h"
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
  if (!node.searchParam("robot_description", key))
    throw std::invalid_argument("the parameter robot_description is not set");
  if (!node.getParam(key, description))
    throw std::invalid_argument("the parameter " + key + " is no text");
  return description;
}

core::TriangleMesh load(const std::string& url, double scale, const io::Scene& scene) {
  const std::filesystem::path file = io::resolveMesh(url, findPackage, scene.mesh_root);
  ROS_INFO("reading %s", file.c_str());
  return io::loadMesh(file, scale);
}

core::TriangleMesh load(const io::LinkMesh& mesh, const io::Scene& scene) {
  return io::transformed(load(mesh.url, 1.0, scene), mesh.scale, mesh.link_from_mesh);
}

core::TriangleMesh meshOf(const io::Organ& organ, const io::Scene& scene,
                          const ros::NodeHandle& node) {
  if (const auto* file = std::get_if<io::MeshFile>(&organ.geometry))
    return load(file->url, file->scale, scene);
  return load(io::linkMesh(robotDescription(node), std::get<io::RobotLink>(organ.geometry).name),
              scene);
}

std::unique_ptr<Organ> loadOrgan(const io::Organ& description, const io::Scene& scene,
                                 const ros::NodeHandle& node) {
  core::TriangleMesh mesh = meshOf(description, scene, node);
  ROS_INFO("%s: building the hierarchy of %zu triangles", description.name.c_str(),
           mesh.triangleCount());
  auto organ = std::make_unique<Organ>(description.name, description.frame, std::move(mesh));
  for (const std::string& sentence : core::warnings(organ->snapshot()->organ.health())) {
    ROS_WARN("%s: %s", description.name.c_str(), sentence.c_str());
  }
  return organ;
}

/// Adds the time that the hierarchy takes to `build_time` [s].
core::Shape meshShape(core::TriangleMesh mesh, bool convex, double& build_time) {
  const Stopwatch watch;
  core::RigidMesh shape{std::make_shared<const core::CollisionMesh>(std::move(mesh)),
                        Eigen::Isometry3d::Identity(), convex};
  build_time += watch.elapsed();
  return shape;
}

core::Shapes shapesOfLink(const io::Instrument& instrument, const std::string& link,
                          const io::Scene& scene, const ros::NodeHandle& node, double& build_time) {
  core::Shapes shapes;
  for (const io::LinkPiece& piece : io::linkPieces(robotDescription(node), link)) {
    const auto* mesh = std::get_if<io::LinkMesh>(&piece);
    shapes.push_back(mesh != nullptr ? meshShape(load(*mesh, scene), instrument.convex, build_time)
                                     : std::get<core::Shape>(piece));
  }
  return shapes;
}

core::Shapes shapesOf(const io::Instrument& instrument, const io::Scene& scene,
                      const ros::NodeHandle& node, double& build_time) {
  if (const auto* shape = std::get_if<core::Shape>(&instrument.geometry)) return {*shape};
  if (const auto* file = std::get_if<io::MeshFile>(&instrument.geometry))
    return {meshShape(load(file->url, file->scale, scene), instrument.convex, build_time)};
  return shapesOfLink(instrument, std::get<io::RobotLink>(instrument.geometry).name, scene, node,
                      build_time);
}

/// Such as are probably not in metres.
void warnOfSize(const Instrument& instrument) {
  constexpr double kLargest = 2.0;  // [m]
  const core::Box box = core::boxOf(instrument.shapes, Eigen::Isometry3d::Identity());
  const double side = (box.high - box.low).maxCoeff();
  if (side > kLargest) ROS_WARN("%s: is %g m long: millimetres?", instrument.name.c_str(), side);
}

bool isInAPair(const io::Scene& scene, std::size_t instrument) {
  const auto names_it = [&](const io::Pair& pair) { return pair.instrument == instrument; };
  const auto likens_it = [&](const io::LikePair& pair) {
    return pair.of == io::LikePair::Of::kInstruments &&
           (pair.first == instrument || pair.second == instrument);
  };
  return std::any_of(scene.pairs.begin(), scene.pairs.end(), names_it) ||
         std::any_of(scene.like_pairs.begin(), scene.like_pairs.end(), likens_it);
}

/// "scene.organs[1].link (liver)": what an error at start is about.
template <class Thing>
std::string pathOf(const char* list, std::size_t i, const Thing& thing) {
  const bool is_link = std::holds_alternative<io::RobotLink>(thing.geometry);
  return std::string("scene.") + list + "[" + std::to_string(i) + "]." +
         (is_link ? "link" : "mesh") + " (" + thing.name + ")";
}

}  // namespace

io::Scene readScene(const ros::NodeHandle& private_node) {
  for (const char* const key : io::kSceneKeys) {
    if (!private_node.hasParam(key)) continue;
    throw std::invalid_argument("the parameter " + private_node.resolveName(key) +
                                " is set, which belongs into scene: is 'scene:' missing above it " +
                                "in the file, or is it indented too little?");
  }
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
      throw std::runtime_error(pathOf("organs", organs.size(), organ) + ": " + error.what());
    }
  }
  return organs;
}

Instruments loadInstruments(const io::Scene& scene, const ros::NodeHandle& node) {
  Instruments instruments;
  for (const io::Instrument& instrument : scene.instruments) {
    const std::size_t i = instruments.size();
    instruments.push_back({instrument.name, instrument.frame, {}, 0.0});
    if (!isInAPair(scene, i)) continue;
    try {
      instruments.back().shapes = shapesOf(instrument, scene, node, instruments.back().build_time);
    } catch (const std::exception& error) {
      throw std::runtime_error(pathOf("instruments", i, instrument) + ": " + error.what());
    }
    warnOfSize(instruments.back());
  }
  return instruments;
}

}  // namespace organ_collision::node
