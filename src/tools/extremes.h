#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "organ_collision/core/triangle_mesh.h"
#include "reference/hard_triangles.h"

namespace organ_collision::tools {

/// A class of inputs that geometric programs fail on.
struct Extreme {
  using Random = core::HardTriangles;

  std::string name;
  /// A point and a triangle; none where the class is about organs.
  std::function<core::Sample(Random&)> sample;
  /// Two triangles; none where the class is about organs.
  std::function<std::pair<core::Triangle, core::Triangle>(Random&)> pair;
  core::TriangleMesh organ;  ///< solid, but for those of one and two triangles
  std::function<Eigen::Vector3d(Random&, const core::TriangleMesh&)> tip;  ///< [m] near the organ
};

/// All classes: needles, caps, triangles without area or in one place, scales from 1e-6 to 1e6 in
/// one organ, 1e3 to 1e15 m from the origin, times 1e-4, 2^-300 and 2^300, spaced exponentially,
/// one and two triangles, ties, tips on the surface and 1e30 m away.
std::vector<Extreme> extremes();

}  // namespace organ_collision::tools
