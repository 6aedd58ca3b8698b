#pragma once

#include "node/organ.h"
#include "test_meshes.h"

// A small organ under test, and what is asked of it.
namespace organ_collision::node {

inline Organ cube() { return {"liver", "liver_frame", test::cube()}; }

inline double heightOfTop(const Organ& organ) {
  return 10.0 -
         core::nearestTriangle(organ.snapshot()->organ, Eigen::Vector3d(0.5, 0.5, 10.0)).distance;
}

/// Crushed along x: splits across it part nothing any more.
inline core::Points crushed(core::Points points) {
  for (Eigen::Vector3d& point : points) point.x() *= 0.01;
  return points;
}

}  // namespace organ_collision::node
