#include "core/pair_sign.h"

#include <algorithm>
#include <vector>

#include "core/nearest_pair_search.h"
#include "core/perhaps_inside.h"
#include "organ_collision/core/sign.h"

namespace organ_collision::core {

using Eigen::Isometry3d;
using Eigen::Vector3d;

namespace {

/// Where the part of `other` that hangs together with a vertex is: the first place of it that
/// rounding does not take to the other side of the solid's surface. Torn welds are not crossed.
Vector3d placeClearOf(const CollisionMesh& solid, const CollisionMesh& other,
                      const Isometry3d& solid_from_other, VertexId vertex, double rounding) {
  const auto place_of = [&](VertexId corner) -> Vector3d {
    return solid_from_other * other.mesh().position(corner);
  };
  std::vector<VertexId> around = {vertex};
  std::vector<bool> known(other.mesh().positions().size());
  for (std::size_t i = 0; i < around.size(); ++i) {
    Vector3d place = place_of(around[i]);
    if (nearestTriangle(solid, place, {}, Sign::kNone).distance > rounding) return place;
    for (const TriangleId triangle :
         other.topology().trianglesAt(other.topology().weld(around[i]))) {
      const Corners& corners = other.mesh().triangles()[index(triangle)];
      const bool meets = std::any_of(corners.begin(), corners.end(), [&](VertexId corner) {
        return other.mesh().position(corner) == other.mesh().position(around[i]);
      });
      if (!meets) continue;
      for (const VertexId corner : corners) {
        if (known[index(corner)]) continue;
        known[index(corner)] = true;
        around.push_back(corner);
      }
    }
  }
  return place_of(vertex);
}

/// The vertices that have met where welds have parted: of all that was torn off there is one.
std::vector<VertexId> partedVertices(const CollisionMesh& organ) {
  const MeshTopology& topology = organ.topology();
  std::vector<bool> has_parted(organ.mesh().positions().size());  // welds, by number
  for (const Corners& corners : organ.mesh().triangles()) {
    for (const VertexId corner : corners)
      if (!topology.isAtWeld(corner, organ.mesh())) has_parted[topology.weld(corner)] = true;
  }
  std::vector<VertexId> vertices;
  for (const Corners& corners : organ.mesh().triangles()) {
    for (const VertexId corner : corners)
      if (has_parted[topology.weld(corner)]) vertices.push_back(corner);
  }
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

/// For surfaces that are farther apart than `lower_bound` [m]: a part of `other` that hangs
/// together is inside the solid.
bool holdsPartOf(const CollisionMesh& solid, const CollisionMesh& other,
                 const Isometry3d& solid_from_other, double lower_bound, double rounding) {
  if (!solid.health().isSolid()) return false;
  const auto is_inside = [&](VertexId vertex) {
    const Vector3d place = lower_bound > rounding
                               ? Vector3d(solid_from_other * other.mesh().position(vertex))
                               : placeClearOf(solid, other, solid_from_other, vertex, rounding);
    return windingNumber(solid, place) != 0;
  };
  const auto is_any_inside = [&](const std::vector<VertexId>& vertices) {
    return std::any_of(vertices.begin(), vertices.end(), is_inside);
  };
  return is_any_inside(other.topology().parts()) ||
         (!other.holdsTogether() && is_any_inside(partedVertices(other)));
}

/// The same: one, or a part of it, is inside the other's solid.
bool isOneInsideTheOther(const CollisionMesh& first, const Isometry3d& second_from_first,
                         const CollisionMesh& second, double lower_bound) {
  const double rounding = 2 * poseRounding(first, second_from_first, second);
  return holdsPartOf(second, first, second_from_first, lower_bound, rounding) ||
         holdsPartOf(first, second, Isometry3d(second_from_first.inverse(Eigen::Affine)),
                     lower_bound, rounding);
}

}  // namespace

NearestPair withSign(const CollisionMesh& first, const Isometry3d& second_from_first,
                     const CollisionMesh& second, NearestPair pair) {
  const bool may_hold = first.health().isSolid() || second.health().isSolid();
  const bool apart = pair.nearest.lower_bound > 0.0;
  if (may_hold && (apart || pair.nearest.isExact())) {
    pair.nearest.distance_signed = true;
    if (apart && isOneInsideTheOther(first, second_from_first, second, pair.nearest.lower_bound))
      turnInside(pair.nearest);
  }
  return pair;
}

}  // namespace organ_collision::core
