#pragma once

#include <memory>

#include "organ_collision/core/nearest_triangle.h"

namespace organ_collision::core {

/// Follows one tip over one organ: each answer starts from what the last one learnt. The packets of
/// triangles that were near are kept with lower bounds of their distances, and so is one bound for
/// all the rest; every motion of tip and mesh lowers the bounds by its length. Only packets whose
/// bound falls below the nearest distance are looked at again, and while that of the rest does not,
/// the answer is exact without the tree. Where that does fall again and again, nothing is followed
/// for a while: then a query is a search that knows how far away the last one's triangle is now.
/// How often the tree is left out depends on how large triangles are for a step: `trajectory` in
/// docs/performance.md.
class Tracker {
 public:
  Tracker();
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  /// The same as the function of that name gives, bit for bit but for `work`. Throws as that does.
  /// Does not allocate once the thread has seen its widest search.
  /// `travel` [m] is the sum, over all refits of the organ so far, of the farthest that each moved
  /// a vertex, rounded up. Where it did not grow with a refit, or the organ is another or was
  /// rebuilt, what was learnt is forgotten. REQUIRES: where it grew, that vertices did not move
  /// farther: else triangles may be missed. (An older copy that is refitted has another history:
  /// rebuild it, or let its travel go on from the latest of all.)
  NearestTriangle nearestTriangle(const CollisionMesh& organ, double travel,
                                  const Eigen::Vector3d& tip, Sign sign = Sign::kProven);
  NearestTriangle nearestTriangle(const CollisionMesh& organ, double travel, const Triangle& tip,
                                  Sign sign = Sign::kProven);

 private:
  class Patience;
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

}  // namespace organ_collision::core
