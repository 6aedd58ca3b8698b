#pragma once

#include "organ_collision/core/instrument.h"
#include "organ_collision/core/proximity.h"

// Instruments against each other: what needs no triangles because it is convex.
namespace organ_collision::convex {

/// Of the convex hulls of two shapes in one frame, by hullDistance(): so unlike that of two
/// surfaces the distance tells how deep they overlap. But for 1e-12 of the shapes' size the
/// bounds do not rest on the precision of GJK and EPA: the extents of both hulls along the normal
/// prove lower_bound, which is mostly within 1e-8 of their size of upper_bound, the distance. Where
/// it is not, the points may be as far apart as lower_bound tells, not as the distance.
/// Throws as requireUsable() of both does.
/// Cost: grows with the meshes' vertices, mostly tens of microseconds for dozens, milliseconds for
/// thousands; some times that where they are thin.
core::Proximity hullProximity(const core::Shape& first, const core::Shape& second);

/// Of two instruments: the nearest of their pieces. Pieces of which one is a convex mesh and the
/// other convex or round by hullProximity(), all others by core::proximity(); in the second's
/// frame. Throws as these do. REQUIRES: at least one piece each.
core::Proximity toolProximity(const core::Shapes& first, const Eigen::Isometry3d& second_from_first,
                              const core::Shapes& second, const core::Accuracy& accuracy);

}  // namespace organ_collision::convex
