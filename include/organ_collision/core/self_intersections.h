#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "organ_collision/core/collision_mesh.h"

namespace organ_collision::core {

struct TrianglePair {
  TriangleId first, second;  ///< the lower number first
};

struct SelfIntersections {
  std::vector<TrianglePair> pairs;  ///< by their numbers
  bool complete;                    ///< there are no others
};

/// The pairs of triangles that have more in common than the corners, and the edge between them,
/// that are at the same places: there the surface crosses, touches or covers itself, and what is
/// inside is not known. Where the vertices are now; exact, by the signs of predicates. Triangles of
/// zero area count for none. At most `max_pairs` of them, the first ones found. Gives up, too,
/// where a thousand boxes and triangles would have to be looked at for each triangle.
/// Cost: about n log n; where neighbours lie in one plane, far more, for exact signs.
SelfIntersections selfIntersections(const CollisionMesh& organ, std::size_t max_pairs);

/// One sentence if anything was found, or it is not known; else nothing.
std::string warning(const SelfIntersections& found);

}  // namespace organ_collision::core
