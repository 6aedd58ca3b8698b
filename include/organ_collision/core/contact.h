#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "organ_collision/core/instrument.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/pair_tracking.h"
#include "organ_collision/core/tracking.h"

namespace organ_collision::core {

/// How an instrument stands to an organ.
/// - Points, triangles, meshes: `nearest` is what nearestTriangle() or nearestPair() tells.
/// - Spheres, capsules: it is that of the centre or the axis, from where `closest` is seen; the
///   radius is subtracted from distance and bounds, which without a sign end at 0. A capsule whose
///   axis crosses the surface of a solid has the distance -radius, however far it crosses.
/// - tip_point is on the surface of the shape: the point nearest to the organ, or deepest in it. It
///   is |distance| from the organ's point (of a capsule inside with an end towards the surface,
///   beside that end); without a sign, as far as the organ's point is deep in the shape.
struct Contact {
  NearestTriangle nearest;
  bool colliding;  ///< instrument and organ (its solid, or its surface where it is open) have a
                   ///< point in common
  bool colliding_certain;  ///< false where the accuracy asked for does not decide it; of a point,
                           ///< or with a radius, it is certain but for rounding
};

/// `shape` is in the organ's frame; the promises of `accuracy` hold for the distance of the whole
/// shape. Throws as nearestTriangle() and requireUsable() do. Costs one nearestTriangle(), at most
/// two of a shape with a radius that may be wrong by a relative error, of `max_leaves` each; of a
/// mesh a nearestPair().
Contact contact(const CollisionMesh& organ, const Shape& shape, const Accuracy& accuracy = {});

/// Of an instrument of several pieces: `nearest` is that of the piece that is nearest or deepest.
/// If one piece is proven inside the organ and the accuracy leaves open whether another is deeper,
/// distance is the depth that is proven, upper_bound. REQUIRES: at least one piece; the pose is
/// rigid.
Contact contact(const CollisionMesh& organ, const Shapes& shapes,
                const Eigen::Isometry3d& organ_from_shapes, const Accuracy& accuracy = {});

/// Follows the pieces of one instrument over one organ.
class ContactTracker {
 public:
  /// The same as the function of that name gives, each time from what the last one learnt. Answers
  /// are exact where `accuracy` limits errors only. For `travel` see Tracker::nearestTriangle().
  Contact contact(const CollisionMesh& organ, double travel, const Shapes& shapes,
                  const Eigen::Isometry3d& organ_from_shapes, const Accuracy& accuracy = {});

 private:
  /// Of a piece.
  struct Followed {
    Tracker round;
    PairTracker mesh;
  };
  std::vector<Followed> pieces_;
};

}  // namespace organ_collision::core
