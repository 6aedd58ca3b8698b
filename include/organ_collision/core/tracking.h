#pragma once

#include <cstdint>
#include <memory>

#include "organ_collision/core/nearest_triangle.h"

namespace organ_collision::core {

/// How a mesh has moved, as whoever moves it counts it.
struct MeshMotion {
  std::uint64_t build = 0;  ///< another number for every hierarchy that was built
  /// [m] Sum, over the refits since, of the farthest that a vertex was moved; another number after
  /// each, also where rounding would take a step from it.
  double travel = 0.0;

  /// [m] No vertex has moved farther since `before`, of the same build.
  double since(const MeshMotion& before) const {
    constexpr double kRoundoff = 0x1p-53;
    return travel == before.travel ? 0.0 : travel - before.travel + 4 * kRoundoff * travel;
  }
};

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

  /// The same as the function of that name gives, bit for bit but for `work`. `organ` is at
  /// `motion`. Throws as that does. Does not allocate once the thread has seen its widest search.
  NearestTriangle nearestTriangle(const CollisionMesh& organ, const MeshMotion& motion,
                                  const Eigen::Vector3d& tip, Sign sign = Sign::kProven);
  NearestTriangle nearestTriangle(const CollisionMesh& organ, const MeshMotion& motion,
                                  const Triangle& tip, Sign sign = Sign::kProven);

 private:
  class Patience;
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

}  // namespace organ_collision::core
