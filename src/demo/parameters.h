#pragma once

#include <ros/node_handle.h>

#include <stdexcept>
#include <string>

namespace organ_collision::demo {

/// The parameter `key`. Throws std::invalid_argument naming it if it is missing or not a T.
template <typename T>
T required(const ros::NodeHandle& node, const std::string& key) {
  T value{};
  if (!node.getParam(key, value)) {
    throw std::invalid_argument("parameter " + node.resolveName(key) +
                                " is missing or of another type");
  }
  return value;
}

}  // namespace organ_collision::demo
