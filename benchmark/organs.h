#pragma once

#include <string>

#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::bench {

/// The shipped liver with 11,520 * 4^levels triangles.
core::TriangleMesh liver(std::size_t levels);

/// "liver", "blob" (8 triangles, that become a smooth round body when divided) or a mesh file;
/// "@K" behind it divides every triangle in four, K times. Throws std::runtime_error or
/// std::invalid_argument naming what is wrong.
core::TriangleMesh organNamed(const std::string& name);

/// Moved and scaled so that the box has its centre at the origin and a diagonal of 1.
core::TriangleMesh inUnitsOfItsDiagonal(const core::TriangleMesh& mesh);

}  // namespace organ_collision::bench
