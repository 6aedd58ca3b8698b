#pragma once

#include <vector>

#include "organ_collision/core/nearest_triangle.h"

namespace organ_collision::core {

/// nearestTriangle() of many points [m], in their order: on all processors, neighbours one after
/// the other. Throws as that does, naming the point's number, before anything is searched.
std::vector<NearestTriangle> nearestTriangles(const CollisionMesh& organ, const Points& points,
                                              const Accuracy& accuracy = {});

}  // namespace organ_collision::core
