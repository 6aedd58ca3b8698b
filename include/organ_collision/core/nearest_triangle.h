#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>

#include "organ_collision/core/closest_point.h"
#include "organ_collision/core/collision_mesh.h"

namespace organ_collision::core {

/// How wrong an answer may be. The search stops at the first limit that is met; all zero is exact.
struct Accuracy {
  double max_relative_error = 0.0;  ///< e: distance found <= (1 + e) * nearest distance
  double max_absolute_error = 0.0;  ///< [m] distance found <= nearest distance + this
  /// Most triangles to look at. 0: no limit; 1: the one that the paper's search leads to, alone;
  /// more: that one may be counted twice.
  std::uint32_t max_leaves = 0;

  static Accuracy exact() { return {}; }
  static Accuracy greedy() { return {0.0, 0.0, 1}; }
};

/// Throws std::invalid_argument naming the field and its value.
[[noreturn]] void refuseNegative(const char* field, double value);
/// The same unless both errors are finite and >= 0; every query asks that.
inline void requireUsable(const Accuracy& accuracy) {
  const auto require = [](const char* field, double value) {
    if (!(value >= 0.0 && value < std::numeric_limits<double>::infinity()))
      refuseNegative(field, value);
  };
  require("max_relative_error", accuracy.max_relative_error);
  require("max_absolute_error", accuracy.max_absolute_error);
}

/// Whether to decide inside or outside.
enum class Sign : std::uint8_t {
  kProven,  ///< where that can be proven
  kNone  ///< triangle and distance only: saves the normal, dearest where a vertex is nearest, and
         ///< the proof
};

/// What a search cost; the same on every machine. Planes that a Tracker keeps are not counted.
struct SearchWork {
  std::uint32_t bounds = 0;     ///< boxes measured; greedy: splits decided
  std::uint32_t triangles = 0;  ///< triangles looked at

  SearchWork& operator+=(const SearchWork& other) {
    bounds += other.bounds;
    triangles += other.triangles;
    return *this;
  }
};

/// The triangle of an organ nearest to an instrument's tip, with the proof of how wrong that may
/// be. Frame: the mesh's.
struct NearestTriangle {
  TriangleId triangle;
  ClosestPoint closest;       ///< on the triangle, seen from tip_point (in a Contact, see there)
  Eigen::Vector3d tip_point;  ///< [m] the tip's point nearest to the triangle
  Eigen::Vector3d normal;     ///< unit outward pseudonormal at the closest point; zero if there is
                              ///< none, or none is asked for
  double distance;            ///< [m] negative inside, where signed
  /// [m] lower_bound <= true distance <= upper_bound, signed as distance is, but for rounding of
  /// 4*u*extent. distance is one of the two; equal: exact.
  double lower_bound, upper_bound;
  bool distance_signed;  ///< the sign is proven, if the surface does not cross itself; otherwise
                         ///< distance >= 0
  SearchWork work;

  bool isExact() const { return lower_bound == upper_bound; }
};

/// The triangle nearest to a point [m]. Asked for an exact answer, the distance is the least of all
/// computed point-triangle distances, bit for bit, and of triangles that tie the first in the
/// hierarchy's order is named; of lengths below 1e-150 m, squares underflow. max_leaves = 1 is the
/// paper's search: go to the child whose pole is nearer, until one triangle is left. More leaves
/// never give a worse answer. Throws std::invalid_argument for a point or an accuracy that is not
/// usable. Allocates only until the calling thread has asked its largest organ. Its cost
/// grows with the number of triangles that are almost as near as the nearest: usually far below
/// O(n), O(n) at the centre of a sphere, unless max_leaves is set. Any threads may ask at the same
/// time, while none changes the organ.
NearestTriangle nearestTriangle(const CollisionMesh& organ, const Eigen::Vector3d& tip,
                                const Accuracy& accuracy = {}, Sign sign = Sign::kProven);

/// The same for a triangle at the instrument's tip, the paper's: routed by its centroid, then
/// measured whole.
NearestTriangle nearestTriangle(const CollisionMesh& organ, const Triangle& tip,
                                const Accuracy& accuracy = {}, Sign sign = Sign::kProven);

/// The paper's search alone: the triangle that Accuracy::greedy() answers with, not measured.
/// Throws std::invalid_argument for a point that is not usable. O(depth); does not allocate.
/// Source: Muñoz, Diaz León, Trefftz, Quid 19 (2012), algorithm 2.
TriangleId greedyTriangle(const CollisionMesh& organ, const Eigen::Vector3d& tip);

}  // namespace organ_collision::core
