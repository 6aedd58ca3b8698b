#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "contenders/contender.h"
#include "organ_collision/core/collision_mesh.h"

namespace organ_collision::bench {

/// Tips in units of the diagonal of the organ's box, and how they are asked for.
struct Workload {
  std::string name;
  Task task;
  core::Points tips;
};

/// A smooth walk along an organ whose box has a diagonal of 1: steps of 0.0006, 0 to 0.02 above the
/// surface.
core::Points trajectory(const core::CollisionMesh& organ, std::size_t count, std::uint64_t seed);

/// The `count` vertices nearest to the first one: where a grasper holds the organ. REQUIRES: there
/// are so many.
std::vector<core::VertexId> neighbours(const core::Points& positions, std::size_t count);

/// Of an organ whose box has a diagonal of 1, `count` tips each:
/// near: points of the surface, equally dense, moved along the normal by -5 % to +5 %;
/// far: anywhere in a box of twice the organ's size;
/// inside: anywhere inside; left out where the organ is no solid;
/// trajectory: see above;
/// batch: the tips of near at once.
/// The same seed gives the same tips.
std::vector<Workload> workloads(const core::CollisionMesh& organ, std::size_t count,
                                std::uint64_t seed);

}  // namespace organ_collision::bench
