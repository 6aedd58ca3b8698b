#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::demo {

/// A soft organ that instruments press into, simulated by Bullet. The vertices of its back (those
/// whose normal looks down, to -z) are held where they are; the others spring back. There is no
/// gravity. Told the same, two organs on one machine have the same positions, bit for bit.
class SoftOrgan {
 public:
  static constexpr double kStep = 1.0 / 60.0;  ///< [s] that step() simulates
  static constexpr double kBite = 0.001;       ///< [m] how far the tip sticks out of the blunt end
  static constexpr double kRadius = 0.004;     ///< [m] of the blunt end and of the shaft behind it
  static constexpr double kFarthest = 0.03;    ///< [m] that a vertex may move from its rest

  /// Where an instrument is; none: nowhere.
  using TipPose = std::optional<Eigen::Isometry3d>;

  static constexpr std::size_t kMostVertices = 20'000;  ///< Bullet counts all pairs of them

  /// `mesh` [m] is the shape at rest. Throws std::invalid_argument naming a vertex in no triangle,
  /// or their number if there are too many, or where Bullet cannot hold it at rest.
  /// O(vertices^2): 3 s for 10,000.
  SoftOrgan(core::TriangleMesh mesh, std::size_t instruments);
  ~SoftOrgan();

  /// Simulates the next kStep, with each instrument moved to `organ_from_tips`; the tip's z axis
  /// points out of it. False if a vertex got farther than kFarthest or lost its number: all are
  /// then at rest again. O(vertices), but for a new body that is put to rest, which takes as long
  /// as the first. REQUIRES: one entry for each instrument; finite poses.
  bool step(const std::vector<TipPose>& organ_from_tips);

  /// Of the mesh's vertices [m], in their order and frame; finite, and Bullet's floats.
  core::Points positions() const;

 private:
  class Simulation;
  std::unique_ptr<Simulation> simulation_;  // so that only one file knows Bullet
};

}  // namespace organ_collision::demo
