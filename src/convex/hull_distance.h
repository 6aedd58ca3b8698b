#pragma once

#include <Eigen/Core>

#include "organ_collision/core/triangle_mesh.h"

// How far apart convex hulls are, or how deep they overlap. Uses FCL.
namespace organ_collision::convex {

/// Two hulls, each of some points: the distance is positive where they are apart, otherwise minus
/// the depth. Whatever is found, it holds that gap <= the true distance <= most, but for rounding
/// and the precision of GJK, 1e-12 of the size.
struct HullDistance {
  double gap;                           ///< along `normal`
  double most;                          ///< that of points of both, or of a body that both share
  Eigen::Vector3d normal;               ///< unit, from the first to the second
  Eigen::Vector3d on_first, on_second;  ///< the nearest, or deepest in the other
};

/// By GJK and, of hulls that GJK does not prove to be apart, EPA. The GJK is FCL's. Its EPA are
/// not used: that on libccd ends the process, or never ends, where hulls overlap by a millionth to
/// a billionth of their size; the other one ends too early in one of ten pairs. Where the gap along
/// the normal does not prove what was found, as of flat hulls in one plane, both are pushed apart
/// along normals, asked there, and so on uphill. REQUIRES: neither is empty; all coordinates are of
/// about the size 1 (FCL's tolerances are absolute). Cost: grows with the points; mostly tens of
/// microseconds for dozens, some times that for thin ones. Source: E. Gilbert, D. Johnson and S.
/// Keerthi, "A fast procedure for computing the distance between complex objects in
/// three-dimensional space" (1988); G. van den Bergen, "Proximity queries and penetration depth
/// computation on 3D game objects" (2001).
HullDistance hullDistance(const core::Points& first, const core::Points& second);

/// The point that is farthest along `direction`.
const Eigen::Vector3d& farthest(const core::Points& points, const Eigen::Vector3d& direction);

/// How far apart hulls are along a direction; never more than their distance.
double gapAlong(const Eigen::Vector3d& unit, const core::Points& first, const core::Points& second);

}  // namespace organ_collision::convex
