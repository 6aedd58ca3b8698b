#pragma once

#include <Eigen/Geometry>
#include <memory>

#include "organ_collision/core/nearest_pair.h"
#include "organ_collision/core/tracking.h"

namespace organ_collision::core {

/// Follows two surfaces that move against each other, as Tracker follows a tip: kept are the pairs
/// of packets of triangles that were near with lower bounds of their distances, and one bound for
/// all the rest. Where the surfaces meet nothing is kept.
class PairTracker {
 public:
  PairTracker();
  ~PairTracker();
  PairTracker(PairTracker&&) noexcept;
  PairTracker& operator=(PairTracker&&) noexcept;

  /// The same as the function of that name gives, bit for bit but for `work`; of lengths below
  /// 1e-150 m another of the nearest pairs may be named. Throws as that does. Allocates the first
  /// time, and where that does. For `travel` see Tracker::nearestTriangle().
  NearestPair nearestPair(const CollisionMesh& first, double travel_of_first,
                          const Eigen::Isometry3d& second_from_first, const CollisionMesh& second,
                          double travel_of_second);

 private:
  struct Memory;
  std::unique_ptr<Memory> memory_;
};

}  // namespace organ_collision::core
