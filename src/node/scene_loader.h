#pragma once

#include <ros/node_handle.h>

#include "node/instrument.h"
#include "node/organ.h"
#include "organ_collision/io/scene.h"

namespace organ_collision::node {

/// The scene from the private parameter `scene`. Throws std::invalid_argument naming the key's
/// path.
io::Scene readScene(const ros::NodeHandle& private_node);

/// Loads every organ of the scene and builds its hierarchy, telling the log how far it is and what
/// is odd about a mesh. Links are looked up in the parameter `robot_description`. Throws
/// std::exception naming the key's path and the resolved one.
Organs loadOrgans(const io::Scene& scene, const ros::NodeHandle& node);

/// The same for the instruments that a pair names.
Instruments loadInstruments(const io::Scene& scene, const ros::NodeHandle& node);

}  // namespace organ_collision::node
