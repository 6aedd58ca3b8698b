#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "convex/hull_distance.h"

namespace organ_collision::convex {

/// The hull of some points of two hulls' difference, first less second, which EPA enlarges. Which
/// faces a new corner sees is decided exactly, so it stays convex and closed whatever rounding
/// does.
class Polytope {
 public:
  /// A point of the difference, and where it comes from.
  struct Corner {
    Eigen::Vector3d place, on_first, on_second;
  };
  using FourCorners = std::array<Corner, 4>;
  struct Face {
    std::array<std::uint32_t, 3> corners;  ///< anticlockwise, seen from outside
    Eigen::Vector3d normal;                ///< unit, outwards; zero where it has no area
    double offset;  ///< of its plane from the origin, along that; infinite: it is passed by
  };

  /// REQUIRES: they are not in one plane.
  explicit Polytope(const FourCorners& corners);

  /// Encloses another corner; false, and nothing changes, where it sees no face.
  bool add(const Corner& corner);

  /// The face whose plane is nearest to the origin from outside or, if the origin is not inside,
  /// farthest beyond it. One without area is passed by, unless all are.
  const Face& nearestPlane() const;

  /// Leaves that face out from now on: it is so narrow that its normal is nothing but rounding.
  void passByNearest();

  /// Inside or on it, decided exactly.
  bool holdsOrigin() const;

  /// The points of both hulls that the polytope's boundary has nearest to each other, and the
  /// normal of the face that they are of.
  HullDistance nearestPoints() const;

 private:
  std::size_t nearestFace() const;
  bool sees(const Eigen::Vector3d& place, const Face& face) const;
  void addFace(std::uint32_t a, std::uint32_t b, std::uint32_t c);

  std::vector<Corner> corners_;
  std::vector<Face> faces_;
};

/// The corner of the hulls' difference that is farthest along a direction.
Polytope::Corner farthestCorner(const Eigen::Vector3d& direction, const core::Points& first,
                                const core::Points& second);

/// Some that are far from each other: in one plane only where about all are.
Polytope::FourCorners farCorners(const core::Points& first, const core::Points& second);

bool areInOnePlane(const Polytope::FourCorners& corners);

}  // namespace organ_collision::convex
