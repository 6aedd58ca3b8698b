#pragma once

#include <Eigen/Core>

#include "organ_collision/core/box.h"

namespace organ_collision::core {

/// Coordinates in which an organ fills about [-1, 1]^3, whatever its size and place: what is kept
/// in single precision neither over- nor underflows there, and a mesh scaled by a power of two
/// looks the same.
struct UnitFrame {
  Eigen::Vector3d centre;  ///< [m]
  double scale;            ///< [1/m] a power of two

  /// Every step rounds relatively to its result.
  Eigen::Vector3d operator()(const Eigen::Vector3d& point) const {
    return (point - centre) * scale;
  }
};

/// Coordinates in it beyond which squares could overflow.
constexpr double kBeyond = 0x1p400;

/// The frame for what is in `box`. A single point gets scale 1.
UnitFrame unitFrame(const Box& box);

}  // namespace organ_collision::core
