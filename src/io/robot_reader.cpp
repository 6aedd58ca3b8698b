#include "robot_reader.h"

#include <console_bridge/console.h>
#include <tinyxml.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "bytes.h"
#include "organ_collision/io/message_text.h"
#include "sandbox.h"

namespace organ_collision::io {
namespace {

[[noreturn]] void refuse(const std::string& why) { throw std::invalid_argument(why); }

/// While it lives, it keeps the errors that urdfdom tells. All are told as before, too.
class Errors : public console_bridge::OutputHandler {
 public:
  Errors() : former_(console_bridge::getOutputHandler()) { console_bridge::useOutputHandler(this); }
  ~Errors() override { console_bridge::useOutputHandler(former_); }
  Errors(const Errors&) = delete;
  Errors& operator=(const Errors&) = delete;

  /// Empty if there is none.
  std::string first() const { return texts_.empty() ? "" : texts_.front(); }
  /// The one just before another; empty if there is none.
  std::string before(const std::string& other) const {
    const auto found = std::find(texts_.begin(), texts_.end(), other);
    return found == texts_.begin() || found == texts_.end() ? "" : *std::prev(found);
  }

 private:
  void log(const std::string& text, console_bridge::LogLevel level, const char* file,
           int line) override {
    if (level == console_bridge::CONSOLE_BRIDGE_LOG_ERROR) texts_.push_back(text);
    if (former_ != nullptr) former_->log(text, level, file, line);
  }

  console_bridge::OutputHandler* const former_;
  std::vector<std::string> texts_;
};

const urdf::Link& linkNamed(const urdf::ModelInterface& robot, const std::string& name) {
  if (const urdf::LinkConstSharedPtr link = robot.getLink(name)) return *link;
  std::vector<std::string_view> known;
  for (const auto& entry : robot.links_) known.emplace_back(entry.first);
  refuse("there is none of this name; there are: " + joined(known));
}

/// urdfdom leaves out all but the first. `number` of the link's, from 1.
void requireOneShape(const TiXmlElement& collision, std::size_t number) {
  std::size_t count = 0;
  const TiXmlElement* geometry = collision.FirstChildElement("geometry");
  for (; geometry != nullptr; geometry = geometry->NextSiblingElement("geometry")) {
    const TiXmlElement* shape = geometry->FirstChildElement();
    for (; shape != nullptr; shape = shape->NextSiblingElement()) ++count;
  }
  if (count != 1)
    refuse("its <collision> " + std::to_string(number) + " has " + std::to_string(count) +
           " shapes, but one is wanted");
}

/// How many <collision> the text has: urdfdom leaves out those after one that it cannot read.
std::size_t collisionCount(const std::string& robot_description, const std::string& link) {
  TiXmlDocument document;
  document.Parse(robot_description.c_str());
  std::size_t count = 0;
  const TiXmlElement* each = document.FirstChildElement("robot")->FirstChildElement("link");
  for (; each != nullptr; each = each->NextSiblingElement("link")) {
    if (each->Attribute("name") != link) continue;
    const TiXmlElement* collision = each->FirstChildElement("collision");
    for (; collision != nullptr; collision = collision->NextSiblingElement("collision")) {
      requireOneShape(*collision, ++count);
    }
  }
  return count;
}

Eigen::Isometry3d isometry(const urdf::Pose& pose) {
  const auto& [x, y, z, w] = pose.rotation;
  const Eigen::Vector3d translation(pose.position.x, pose.position.y, pose.position.z);
  return Eigen::Translation3d(translation) * Eigen::Quaterniond(w, x, y, z);
}

Eigen::Vector3d eigen(const urdf::Vector3& v) { return {v.x, v.y, v.z}; }

LinkCollision collisionOf(const urdf::Collision& collision) {
  const Eigen::Isometry3d pose = isometry(collision.origin);
  const urdf::Geometry* const geometry = collision.geometry.get();
  if (const auto* const mesh = dynamic_cast<const urdf::Mesh*>(geometry))
    return {{GeometryKind::kMesh, eigen(mesh->scale), pose}, mesh->filename};
  if (const auto* const sphere = dynamic_cast<const urdf::Sphere*>(geometry))
    return {{GeometryKind::kSphere, {sphere->radius, 0.0, 0.0}, pose}, ""};
  if (const auto* const box = dynamic_cast<const urdf::Box*>(geometry))
    return {{GeometryKind::kBox, eigen(box->dim), pose}, ""};
  if (const auto* const cylinder = dynamic_cast<const urdf::Cylinder*>(geometry))
    return {{GeometryKind::kCylinder, {cylinder->radius, cylinder->length, 0.0}, pose}, ""};
  refuse("its <collision> has no geometry of a known kind");
}

// ---- collisions as bytes, for the way from the child to here

std::string encodeCollisions(const std::vector<LinkCollision>& collisions) {
  std::vector<LinkGeometry> geometries;
  geometries.reserve(collisions.size());
  for (const LinkCollision& collision : collisions) geometries.push_back(collision.geometry);
  std::string bytes;
  appendItems(bytes, geometries);
  for (const LinkCollision& collision : collisions) appendItems(bytes, collision.url);
  return bytes;
}

std::vector<LinkCollision> decodeCollisions(std::string_view bytes) {
  std::vector<LinkCollision> collisions;
  for (const LinkGeometry& geometry : takeItems<std::vector<LinkGeometry>>(bytes))
    collisions.push_back({geometry, ""});
  for (LinkCollision& collision : collisions) collision.url = takeItems<std::string>(bytes);
  return collisions;
}

}  // namespace

std::vector<LinkCollision> readCollisions(const std::string& robot_description,
                                          const std::string& link) {
  Errors errors;
  const urdf::ModelInterfaceSharedPtr robot = urdf::parseURDF(robot_description);
  if (!robot) refuse("the description cannot be read as URDF: " + errors.first());
  const auto& found = linkNamed(*robot, link).collision_array;
  const std::size_t wanted = collisionCount(robot_description, link);
  if (wanted == 0) refuse("it has no <collision>");
  if (found.size() != wanted) {
    const std::string reason =
        errors.before("Could not parse collision element for Link [" + link + "]");
    refuse(std::to_string(found.size()) + " of its " + std::to_string(wanted) +
           " <collision> can be read" + (reason.empty() ? "" : ": " + reason));
  }
  std::vector<LinkCollision> collisions;
  collisions.reserve(found.size());
  for (const urdf::CollisionSharedPtr& each : found) collisions.push_back(collisionOf(*each));
  return collisions;
}

std::vector<LinkCollision> readCollisionsInChild(const std::string& robot_description,
                                                 const std::string& link) {
  const auto job = [&] { return encodeCollisions(readCollisions(robot_description, link)); };
  return decodeCollisions(runInChild("link '" + link + "' of the robot description", job,
                                     limitsFor(robot_description.size(), LoadLimits{})));
}

}  // namespace organ_collision::io
