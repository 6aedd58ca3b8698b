#pragma once

#include <Eigen/Geometry>
#include <limits>
#include <utility>

#include "core/kernels/pair_search.h"
#include "organ_collision/core/nearest_pair.h"
#include "organ_collision/core/triangle_distance.h"

namespace organ_collision::core {

/// [m] How far a corner of the first surface, moved by the pose or back, may be from where it is.
double poseRounding(const CollisionMesh& first, const Eigen::Isometry3d& second_from_first,
                    const CollisionMesh& second);

/// A search for the nearest triangles of two surfaces, between the kernels, which know no organ,
/// and the public functions.
class NearestPairSearch : protected PairSearch {
 public:
  NearestPairSearch(const CollisionMesh& first_surface, const Eigen::Isometry3d& pose,
                    const CollisionMesh& second_surface, const Accuracy& accuracy);

  NearestPair run();

 protected:
  /// For its boxes: then no more is told than going to and fro does.
  bool isTooFar() const;

  /// Beside the distance or the size of one surface the other is so small that hardly any pair of
  /// triangles can be left out.
  bool isBlurred() const;

  /// Of two surfaces that have shrunk to points, all triangles are equally far, bit for bit.
  bool areAllAlike() const;

  /// The triangle to which the paper's search leads from the other surface, and back.
  void measureGreedily();

  /// From a point of one surface to the nearest of the other, and back: where that leads, a search
  /// has little left to do.
  void measureToAndFro();

  void measure(FarthestPairTree::Leaf leaf_of_first, FarthestPairTree::Leaf leaf_of_second);

  NearestPair answer() const;

  const CollisionMesh& first_;
  const CollisionMesh& second_;
  const Eigen::Isometry3d& pose_;
  const bool is_limited_;
  ClosestPair pair_ = {};
  std::pair<FarthestPairTree::Leaf, FarthestPairTree::Leaf> best_leaves_ = {};
  double squared_best_ = std::numeric_limits<double>::infinity();

 private:
  void placeFrames();
  bool areFarApart() const;
  Triangle ofFirst(FarthestPairTree::Leaf leaf) const;
  Triangle ofSecond(FarthestPairTree::Leaf leaf) const;
  NearestTriangle nearestTo(const CollisionMesh& surface, const Eigen::Vector3d& point);
};

}  // namespace organ_collision::core
