#pragma once

#include <Eigen/Core>
#include <optional>

#include "organ_collision/core/instrument.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/pair_tracking.h"

namespace organ_collision::core {

/// How two things of one kind, instruments or organs, stand to each other.
struct Proximity {
  Eigen::Vector3d point_on_first, point_on_second;  ///< [m] the nearest, or deepest in the other
  Eigen::Vector3d normal;  ///< unit, from first to second; zero where there is none
  double distance;         ///< [m] negative where they overlap and the depth is known
  double lower_bound;      ///< [m] lower_bound <= true distance <= upper_bound
  double upper_bound;      ///< [m]
  bool colliding;          ///< they have a point in common
  bool colliding_certain;  ///< false where the accuracy asked for does not decide it
  std::optional<TriangleId> triangle_of_first, triangle_of_second;  ///< nothing: not a mesh
  SearchWork work;
};

/// Of two shapes in one frame. Of round ones the distance of their cores less the radii; where two
/// axes cross, -(both radii). Of a mesh and a round shape as contact() tells; of two meshes as
/// nearestPair() does: 0 where the surfaces meet, and where a part of one is inside the other's
/// solid, points, normal and bounds are those of the surfaces' nearest points, as if these were of
/// that part. Swapped shapes swap the points and turn the normal, but where several points are as
/// near or meshes meet. Throws as requireUsable() and nearestPair() do. Costs one closestPoints(),
/// of a mesh what contact() does.
Proximity proximity(const Shape& first, const Shape& second, const Accuracy& accuracy = {});

/// Follows two meshes; all else is asked anew.
class ProximityTracker {
 public:
  /// The same as the function of that name gives, each time from what the last one learnt; of two
  /// meshes exact where `accuracy` limits errors only. For `travel` see Tracker::nearestTriangle().
  Proximity proximity(const Shape& first, double travel_of_first, const Shape& second,
                      double travel_of_second, const Accuracy& accuracy = {});

 private:
  PairTracker pair_;
};

/// The same, told of (second, first).
Proximity swapped(const Proximity& proximity);

/// The same in another frame.
Proximity transformed(Proximity proximity, const Eigen::Isometry3d& target_from_source);

/// Of two things of which these are pieces: the nearer, with bounds that hold for both.
Proximity united(const Proximity& one, const Proximity& other);

}  // namespace organ_collision::core
