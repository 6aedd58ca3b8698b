#pragma once

#include <memory>

#include "organ_collision/core/nearest_triangle.h"

namespace organ_collision::core {

/// Follows one tip over one organ: each answer starts from what the last one learnt. Kept is the
/// front of a search: all sets of the hierarchy that it came to but did not open, and the triangles
/// near by, each with a plane between it and the tip, which still tells how far away it is at least
/// when the tip has moved. Only what may be as near as the triangle that was nearest is looked at
/// again, or opened; so the answer is exact without the way down the tree. A front that has grown
/// too much is replaced by that of another search. Where that happens again and again, none is kept
/// for a while: then a query is a search that knows how far away the last one's triangle is now.
/// What it saves: `trajectory` in docs/performance.md. Asked by one thread at a time.
class Tracker {
 public:
  Tracker();
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  /// The same as the function of that name gives, bit for bit but for `work` and the sign of a
  /// zero; of lengths below 1e-150 m another of the nearest may be named. Throws as that does.
  /// Allocates the first time, and where that does.
  ///
  /// `travel` [m]: of each organ keep one number, from 0 on, and with each refit add the farthest
  /// that it moved a vertex, rounded up. Where it did not grow between two queries with a refit
  /// between them, or the organ is another or was rebuilt, what was learnt is forgotten. REQUIRES:
  /// where it grew, vertices did not move farther, or triangles may be missed. (An older copy that
  /// is refitted has another history: rebuild it, or to the travel of the latest add the farthest
  /// that a vertex is then from where it was in that.)
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
