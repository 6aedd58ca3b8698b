#include "organ_collision/core/triangle_mesh.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include "core/kernels/kernels.h"

namespace organ_collision::core {
namespace {

/// Of so many triangles every place in WideTree has a number of 32 bits.
constexpr std::size_t kMost = 1U << 27U;

void requireFewEnough(std::size_t count, const char* what) {
  if (count <= kMost) return;
  throw std::invalid_argument("the mesh has " + std::to_string(count) + " " + what + ": at most " +
                              std::to_string(kMost) + " are possible");
}

/// Returns the positions' box.
Box requireAllUsable(const Points& positions) {
  if (positions.empty()) return {};
  const auto [low, high, finite] = boxOfPoints(positions.front().data(), positions.size());
  Box box = {Eigen::Vector3d(low.data()), Eigen::Vector3d(high.data())};
  if (!finite || !isUsable(box.low) || !isUsable(box.high)) {
    for (std::size_t i = 0; i < positions.size(); ++i) requireUsable(positions[i], "vertex", i);
  }
  return box;
}

/// (low + high) + middle: the same bits for every order of the three, and for their negatives.
double sumInAnyOrder(double p, double q, double r) {
  const double lower = std::min(p, q);
  const double higher = std::max(p, q);
  const double middle = std::max(lower, std::min(higher, r));
  return (std::min(lower, r) + std::max(higher, r)) + middle;
}

}  // namespace

void refuseUnusable(const Eigen::Vector3d& position, const char* what, std::size_t number) {
  std::ostringstream message;
  message << what << " " << number << " is at (" << position.x() << ", " << position.y() << ", "
          << position.z() << ") m: coordinates must be finite and below " << kLargestCoordinate
          << " m";
  throw std::invalid_argument(message.str());
}

TriangleMesh::TriangleMesh(Points positions, std::vector<Corners> triangles)
    : positions_(std::move(positions)), triangles_(std::move(triangles)) {
  if (triangles_.empty()) throw std::invalid_argument("the mesh has no triangle");
  requireFewEnough(triangles_.size(), "triangles");
  requireFewEnough(positions_.size(), "vertices");
  requireAllUsable(positions_);
  std::vector<bool> used(positions_.size(), false);
  for (std::size_t i = 0; i < triangles_.size(); ++i) {
    for (const VertexId corner : triangles_[i]) {
      if (index(corner) < positions_.size()) {
        used[index(corner)] = true;
        continue;
      }
      throw std::invalid_argument("triangle " + std::to_string(i) + " names vertex " +
                                  std::to_string(index(corner)) + " of " +
                                  std::to_string(positions_.size()));
    }
  }
  uses_all_vertices_ = std::find(used.begin(), used.end(), false) == used.end();
}

Box TriangleMesh::setPositions(Points positions) {
  if (positions.size() != positions_.size()) {
    throw std::invalid_argument(std::to_string(positions.size()) + " positions given for " +
                                std::to_string(positions_.size()) + " vertices");
  }
  Box box = requireAllUsable(positions);
  positions_ = std::move(positions);
  return box;
}

void TriangleMesh::requireFitting(const std::vector<VertexId>& moved,
                                  const Points& positions) const {
  if (positions.size() != moved.size()) {
    throw std::invalid_argument(std::to_string(positions.size()) + " positions given for " +
                                std::to_string(moved.size()) + " vertices");
  }
  for (std::size_t i = 0; i < moved.size(); ++i) {
    if (index(moved[i]) >= positions_.size()) {
      throw std::invalid_argument("there is no vertex " + std::to_string(index(moved[i])) +
                                  ": the mesh has " + std::to_string(positions_.size()));
    }
    requireUsable(positions[i], "vertex", index(moved[i]));
  }
}

void TriangleMesh::move(const std::vector<VertexId>& moved, const Points& positions) {
  for (std::size_t i = 0; i < moved.size(); ++i) positions_[index(moved[i])] = positions[i];
}

Eigen::Vector3d centroid(const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  return Eigen::Vector3d(sumInAnyOrder(a.x(), b.x(), c.x()), sumInAnyOrder(a.y(), b.y(), c.y()),
                         sumInAnyOrder(a.z(), b.z(), c.z())) /
         3.0;
}

}  // namespace organ_collision::core
