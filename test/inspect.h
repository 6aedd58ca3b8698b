#pragma once

#include "organ_collision/core/mesh_health.h"
#include "organ_collision/core/predicates.h"

namespace organ_collision::test {

/// The health of a mesh, triangle by triangle.
inline core::MeshHealth inspect(const core::TriangleMesh& mesh,
                                const core::MeshTopology& topology) {
  const core::Box box = core::boxOf(mesh);
  core::HealthTally tally;
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    const core::Triangle triangle = mesh.triangle(static_cast<core::TriangleId>(i));
    if (core::collinear(triangle.a, triangle.b, triangle.c)) ++tally.degenerate_triangles;
  }
  tally.volume = core::volumeOf(mesh, core::unitFrame(box));
  return core::healthOf(topology, box, tally, core::partedCorners(mesh, topology));
}

}  // namespace organ_collision::test
