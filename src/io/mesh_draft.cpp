#include "mesh_draft.h"

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "shown.h"

namespace organ_collision::io {

void addVertex(MeshDraft& draft, const Eigen::Vector3d& position) {
  constexpr double kLargest = std::numeric_limits<float>::max();  // mesh updates come as float32
  if (!(position.array().abs() <= kLargest).all()) {
    throw std::invalid_argument("vertex " + std::to_string(draft.positions.size()) + " is at (" +
                                shown(position.x()) + ", " + shown(position.y()) + ", " +
                                shown(position.z()) +
                                "): coordinates must be finite and fit into a 32-bit float");
  }
  draft.positions.push_back(position);
}

core::VertexId vertexOf(std::int64_t face, double number, std::int64_t count) {
  constexpr double kLargest = std::numeric_limits<std::uint32_t>::max();
  if (number >= 0.0 && number < static_cast<double>(count) && number <= kLargest &&
      std::floor(number) == number) {
    return core::VertexId(static_cast<std::uint32_t>(number));
  }
  throw std::invalid_argument("face " + std::to_string(face) + " names vertex " + shown(number) +
                              " of " + std::to_string(count) + ", counted from 0");
}

void addPolygon(MeshDraft& draft, const std::vector<core::VertexId>& corners) {
  if (corners.size() < 3) {
    throw std::invalid_argument("the face that begins with triangle " +
                                std::to_string(draft.triangles.size()) + " has " +
                                std::to_string(corners.size()) + " corners: 3 or more are wanted");
  }
  for (std::size_t i = 2; i < corners.size(); ++i) {
    draft.triangles.push_back({corners[0], corners[i - 1], corners[i]});
  }
}

}  // namespace organ_collision::io
