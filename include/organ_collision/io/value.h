#pragma once

#include <map>
#include <string>
#include <variant>
#include <vector>

namespace organ_collision::io {

struct Value;
using List = std::vector<Value>;
using Map = std::map<std::string, Value>;

/// What YAML and the ROS parameter server can hold; std::monostate is null.
struct Value : std::variant<std::monostate, bool, int, double, std::string, List, Map> {
  using variant::variant;
};

}  // namespace organ_collision::io
