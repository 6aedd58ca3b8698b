#pragma once

#include <Eigen/Core>

#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::io {

/// The box of `size` [m] around the origin: 12 triangles, wound outwards.
core::TriangleMesh boxMesh(const Eigen::Vector3d& size);

/// The prism around the z axis, from -length / 2 to length / 2 [m], whose `sides` edges are at
/// `radius` [m]: 4 * sides triangles, wound outwards. REQUIRES: sides >= 3.
core::TriangleMesh prismMesh(double radius, double length, int sides);

}  // namespace organ_collision::io
