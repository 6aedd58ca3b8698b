#include <cmath>
#include <memory>

#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/triangle_distance.h"
#include "organ_collision/core/triangle_intersection.h"
#include "peers.h"

namespace organ_collision::bench {

using core::Triangle;
using core::TriangleMesh;
using Eigen::Vector3d;

Peer libraryPeer() {
  return {"ours",
          [](const TriangleMesh& mesh) -> Organ {
            const auto organ = std::make_shared<core::CollisionMesh>(mesh);
            return [organ](const Vector3d& tip) {
              return std::abs(nearestTriangle(*organ, tip).distance);
            };
          },
          [](const Triangle& first, const Triangle& second) {
            return std::sqrt(closestPoints(first, second).on_second.squared_distance);
          },
          core::trianglesIntersect};
}

}  // namespace organ_collision::bench
