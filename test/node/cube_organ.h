#pragma once

#include <random>
#include <string>

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

/// Asks a thousand questions around the organ's present surface.
inline void ask(Organ& organ, const core::Accuracy& accuracy) {
  std::mt19937 generator(61);
  const auto snapshot = organ.snapshot();
  const core::TriangleMesh& mesh = snapshot->organ.mesh();
  for (int i = 0; i < 1024; ++i) {
    const auto triangle = static_cast<core::TriangleId>(generator() % mesh.triangleCount());
    const Eigen::Vector3d tip =
        core::centroid(mesh.triangle(triangle)) + test::randomPoint(generator, 0.005);
    organ.account(tip, accuracy);
  }
}

/// Flattens the organ and asks until it is to be rebuilt; returns what the last update answered.
inline std::string wearOut(Organ& organ) {
  organ.update({{}, crushed(organ.snapshot()->organ.mesh().positions())}, UpdateMode::kAuto, 0);
  std::string reason;
  for (int round = 0; round < 100000 && reason.find("rebuilding") == std::string::npos; ++round) {
    ask(organ, core::Accuracy::greedy());
    reason = organ.update({}, UpdateMode::kAuto, 0).reason;
  }
  return reason;
}

}  // namespace organ_collision::node
