#include "organ_collision/core/sign.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/plane_coordinates.h"
#include "organ_collision/core/predicates.h"

namespace organ_collision::core {
namespace {

// Rounding turns no sign that is clearer than this: the unit normal of a triangle whose angles have
// a sine above it is right to 8u / kClear, a sum of normals longer than it to 8u / kClear^2, and
// that is far below kClear.
constexpr double kClear = 0x1p-12;

/// Times a power of two, so that no product of four over- or underflows.
Eigen::Vector3d madeSafe(const Eigen::Vector3d& v) {
  return v.isZero(0.0) ? v : Eigen::Vector3d(normalisingFactor(largestCoordinate(v)) * v);
}

/// To length 1; 0 remains 0.
Eigen::Vector3d unit(const Eigen::Vector3d& v) {
  const double squared = squaredLength(v);
  if (isSafe(squared)) return v / std::sqrt(squared);
  return v.isZero(0.0) ? v : unit(madeSafe(v));
}

/// Triangles that meet at a feature, with the angles that they fill there; made of all that share
/// its welded vertices.
class Fan {
 public:
  Fan(const CollisionMesh& organ, TriangleId triangle, Feature feature) {
    switch (feature) {
      case Feature::kFace:
        add(organ.mesh().triangle(triangle), 0, Feature::kFace);
        break;
      case Feature::kVertexA:
      case Feature::kVertexB:
      case Feature::kVertexC:
        addAround(organ, corner(organ, triangle, static_cast<std::size_t>(feature)));
        break;
      case Feature::kEdgeAB:
      case Feature::kEdgeBC:
      case Feature::kEdgeCA: {
        const auto first =
            static_cast<std::size_t>(feature) - static_cast<std::size_t>(Feature::kEdgeAB);
        addAlong(organ, corner(organ, triangle, first), corner(organ, triangle, (first + 1) % 3));
        break;
      }
    }
  }

  const Eigen::Vector3d& normal() const { return normal_; }
  bool isWellShaped() const { return well_shaped_ && normal_.norm() > kClear; }

 private:
  using Weld = MeshTopology::Weld;

  static Weld corner(const CollisionMesh& organ, TriangleId triangle, std::size_t i) {
    return organ.topology().weld(organ.mesh().corners(triangle)[i]);
  }

  void addAround(const CollisionMesh& organ, Weld vertex) {
    for (const TriangleId id : organ.topology().trianglesAt(vertex)) {
      for (const std::size_t i : {0, 1, 2}) {
        if (corner(organ, id, i) == vertex) add(organ.mesh().triangle(id), i, Feature::kVertexA);
      }
    }
  }

  void addAlong(const CollisionMesh& organ, Weld from, Weld to) {
    for (const TriangleId id : organ.topology().trianglesAt(from)) {
      for (const std::size_t i : {0, 1, 2}) {
        const Weld first = corner(organ, id, i);
        const Weld second = corner(organ, id, (i + 1) % 3);
        if ((first == from && second == to) || (first == to && second == from)) {
          add(organ.mesh().triangle(id), i, Feature::kEdgeAB);
        }
      }
    }
  }

  /// Adds the normal of `triangle`, weighted by its angle at corner i where a vertex is asked for.
  void add(const Triangle& triangle, std::size_t i, Feature kind) {
    const std::array<const Eigen::Vector3d*, 3> corners = {&triangle.a, &triangle.b, &triangle.c};
    Eigen::Vector3d to_next = *corners[(i + 1) % 3] - *corners[i];
    Eigen::Vector3d to_last = *corners[(i + 2) % 3] - *corners[i];
    if (!isSafe(squaredLength(to_next)) || !isSafe(squaredLength(to_last))) {
      to_next = madeSafe(to_next);
      to_last = madeSafe(to_last);
    }
    const Eigen::Vector3d across = to_next.cross(to_last);
    const double squared_area = squaredLength(across);
    well_shaped_ = well_shaped_ &&
                   squared_area > kClear * kClear * squaredLength(to_next) * squaredLength(to_last);
    if (squared_area == 0.0) return;
    const double area = std::sqrt(squared_area);
    const double weight = kind == Feature::kVertexA ? std::atan2(area, to_next.dot(to_last)) : 1.0;
    normal_ += weight / area * across;
  }

  Eigen::Vector3d normal_ = Eigen::Vector3d::Zero();
  bool well_shaped_ = true;
};

/// Turns a mesh that is inside out.
double orientationFactor(const CollisionMesh& organ) {
  return organ.health().inverted ? -1.0 : 1.0;
}

/// +1 or -1 where the line through `point` along x crosses the triangle with its normal along +x or
/// -x, else 0. A line that meets an edge is moved by less than any number, first in y and by still
/// less in z: of the triangles around the edge exactly those that the moved line crosses are
/// counted.
int crossing(const Triangle& triangle, const Eigen::Vector3d& point) {
  const std::array<const Eigen::Vector3d*, 3> corners = {&triangle.a, &triangle.b, &triangle.c};
  int turns = 0;
  for (const std::size_t i : {0, 1, 2}) {
    const Eigen::Vector3d& from = *corners[i];
    const Eigen::Vector3d& to = *corners[(i + 1) % 3];
    const bool upwards = from.z() <= point.z();
    if (upwards == (to.z() <= point.z())) continue;
    int left = orientation(alongAxis(from, 0), alongAxis(to, 0), alongAxis(point, 0));
    if (left == 0) left = upwards ? -1 : 1;
    if (upwards && left > 0) ++turns;
    if (!upwards && left < 0) --turns;
  }
  return turns;
}

}  // namespace

Eigen::Vector3d pseudonormal(const CollisionMesh& organ, TriangleId triangle, Feature feature) {
  return surfaceNormal(organ, triangle, feature).direction;
}

SurfaceNormal surfaceNormal(const CollisionMesh& organ, TriangleId triangle, Feature feature) {
  const Fan fan(organ, triangle, feature);
  return {orientationFactor(organ) * unit(fan.normal()), fan.isWellShaped()};
}

int windingNumber(const CollisionMesh& organ, const Eigen::Vector3d& point) {
  const WideTree& tree = organ.wideTree();
  const auto meets_ray = [](const Box& box, const Eigen::Vector3d& start) {
    return start.x() <= box.high.x() && box.low.y() <= start.y() && start.y() <= box.high.y() &&
           box.low.z() <= start.z() && start.z() <= box.high.z();
  };
  int winding = 0;
  const auto count = [&](TriangleId id) {
    const Triangle triangle = organ.mesh().triangle(id);
    if (!meets_ray(boxOf(triangle), point)) return;
    const int turns = crossing(triangle, point);
    // Seen from the normal's side the triangle is ahead of the point only if the point is behind
    // it, and vice versa.
    if (turns != 0 && turns * orientation(triangle.a, triangle.b, triangle.c, point) < 0)
      winding += turns;
  };
  const Eigen::Vector3d unit_point = tree.frame()(point);
  thread_local std::vector<std::uint32_t> stack;  // nodes
  stack.assign(1, 0);
  while (!stack.empty()) {
    const WideTree::Node& node = tree.nodes()[stack.back()];
    stack.pop_back();
    for (std::uint32_t lane = 0; lane < node.lane_count; ++lane) {
      if (!meets_ray(tree.boxOf(node, lane), unit_point)) continue;
      if (lane < node.node_count) {
        stack.push_back(node.first_node + lane);
        continue;
      }
      const WideTree::Packet& packet = tree.packets()[node.first_packet + lane - node.node_count];
      for (std::uint32_t i = 0; i < packet.lane_count; ++i)
        count(organ.tree().triangle(packet.first_leaf + i));
    }
  }
  return winding;
}

std::optional<Side> sideOf(const CollisionMesh& organ, const Eigen::Vector3d& point,
                           const ClosestPoint& closest, const SurfaceNormal& normal) {
  const MeshHealth& health = organ.health();
  if (!health.isSolid()) return std::nullopt;
  if (!health.box.contains(point)) return Side::kOutside;
  const double distance = largestCoordinate(closest.offset);
  const double extent = distance + largestCoordinate(health.box.high - health.box.low);
  const double height = -unit(closest.offset).dot(normal.direction);
  const bool clear = normal.is_clear && std::abs(height) > kClear && distance > 0x1p-30 * extent;
  const bool outside = clear ? height > 0.0 : windingNumber(organ, point) == 0;
  return outside ? Side::kOutside : Side::kInside;
}

}  // namespace organ_collision::core
