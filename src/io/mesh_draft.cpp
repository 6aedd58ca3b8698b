#include "mesh_draft.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "shown.h"

namespace organ_collision::io {
namespace {

/// The normal of the fan's triangle that ends at corner i, twice its area long.
Eigen::Vector3d normalInFan(const core::Points& positions,
                            const std::vector<core::VertexId>& corners, std::size_t i) {
  const Eigen::Vector3d& apex = positions[index(corners[0])];
  return (positions[index(corners[i - 1])] - apex).cross(positions[index(corners[i])] - apex);
}

/// Whether all triangles of the fan face the same way as the polygon, whose normal is their sum,
/// but for what the digits of a file may make of corners in one line.
bool isFilledByFan(const core::Points& positions, const std::vector<core::VertexId>& corners) {
  constexpr double kRounding = 1e-6;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double areas = 0.0;
  for (std::size_t i = 2; i < corners.size(); ++i) {
    const Eigen::Vector3d of_triangle = normalInFan(positions, corners, i);
    normal += of_triangle;
    areas += of_triangle.norm();
  }
  if (normal.norm() < kRounding * areas) return false;  // it crosses itself
  const double least = -kRounding * normal.squaredNorm();
  for (std::size_t i = 2; i < corners.size(); ++i)
    if (normalInFan(positions, corners, i).dot(normal) < least) return false;
  return true;
}

/// Makes it a fan from the first corner from which one fills it.
void fill(const MeshDraft::Polygon& polygon, MeshDraft& draft) {
  constexpr std::size_t kMostTried = 64;  // corners, as each takes as long as the polygon is large
  const auto [first, count] = polygon;
  core::Corners* const triangles = &draft.triangles[first];
  std::vector<core::VertexId> corners = {triangles[0][0], triangles[0][1]};
  for (std::size_t i = 2; i < count; ++i) corners.push_back(triangles[i - 2][2]);
  for (std::size_t tried = 0; tried < std::min(count, kMostTried); ++tried) {
    if (isFilledByFan(draft.positions, corners)) {
      for (std::size_t i = 2; i < count; ++i)
        triangles[i - 2] = {corners[0], corners[i - 1], corners[i]};
      return;
    }
    std::rotate(corners.begin(), corners.begin() + 1, corners.end());
  }
  throw std::invalid_argument(
      "the face of " + std::to_string(count) + " corners that becomes triangles " +
      std::to_string(first) + " to " + std::to_string(first + count - 3) +
      ", counted from 0, is not convex, and no fan from one of its first " +
      std::to_string(kMostTried) + " corners fills it: save the mesh as triangles");
}

}  // namespace

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
  if (corners.size() > 3) draft.polygons.push_back({draft.triangles.size(), corners.size()});
  for (std::size_t i = 2; i < corners.size(); ++i) {
    draft.triangles.push_back({corners[0], corners[i - 1], corners[i]});
  }
}

core::TriangleMesh meshOf(MeshDraft draft) {
  for (const MeshDraft::Polygon& polygon : draft.polygons) fill(polygon, draft);
  return {std::move(draft.positions), std::move(draft.triangles)};
}

}  // namespace organ_collision::io
