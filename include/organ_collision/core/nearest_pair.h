#pragma once

#include <Eigen/Geometry>

#include "organ_collision/core/nearest_triangle.h"

namespace organ_collision::core {

/// The nearest triangles of two surfaces.
struct NearestPair {
  TriangleId triangle_of_first;
  /// Of the second, in its frame; tip_point is the first's point. The normal is the surface's, also
  /// of a part that is inside out by itself.
  NearestTriangle nearest;
};

/// The nearest triangles of two surfaces, with the proof of how wrong that may be. The distance is
/// 0 where the surfaces meet, and negative where they do not and one, or a part of it that hangs
/// together, is inside the other's solid.
/// An exact answer is the least of all computed triangle-triangle distances, bit for bit, those of
/// the first moved by the pose; of several it names the first in the hierarchies' order. But
/// - where surfaces meet, any two triangles that do;
/// - where one is farther than 2^58 of its sizes from the other, any two that are as near but for
///   4*u*extent, and where the pose stretches, for as much as it does: the lower bound tells;
/// - where it is farther than some 2^40 of them, or one is 2^16 times as large as the other,
///   rounding lets hardly any pairs be left out: at most 2^16 are looked at, and the bounds tell
///   what that was worth;
/// - where the other's middle is farther than 2^60 sizes of a surface that is not, as one with a
///   vertex that far astray, or where one that is not is 2^500 times as large as the other: then
///   the lower bound is 0.
/// max_leaves counts pairs of triangles; 1 is the paper's search from the middle of the first's
/// box, and back. Throws std::invalid_argument for an accuracy that is not usable, or a pose that
/// is not rigid.
///
/// Cost: grows with the triangles that are about as near as the nearest, up to O(n*m) where all
/// are; least where the surfaces meet. Besides, for the sign, a winding number for each part of one
/// that may be inside the other's solid. docs/scenes.md has measured ones. Does not allocate once
/// the thread has asked its largest organs, but where surfaces are as near as rounding, or were
/// torn at their welds. Source: both hierarchies are descended at once as in S. Gottschalk, M. Lin
/// and D. Manocha, "OBBTree: a hierarchical structure for rapid interference detection" (1996).
NearestPair nearestPair(const CollisionMesh& first, const Eigen::Isometry3d& second_from_first,
                        const CollisionMesh& second, const Accuracy& accuracy = {});

}  // namespace organ_collision::core
