#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "organ_collision/core/box.h"
#include "organ_collision/core/mesh_topology.h"
#include "organ_collision/core/triangle_mesh.h"
#include "organ_collision/core/unit_frame.h"

namespace organ_collision::core {

/// What a user should know of a mesh before trusting answers about it.
struct MeshHealth {
  bool closed;              ///< every edge has an even number of triangles, and no weld has parted
  bool consistently_wound;  ///< neighbours run along their edge in opposite senses
  bool inverted;  ///< closed and wound, but enclosing a negative volume: it is read inside out
  std::size_t degenerate_triangles;  ///< of zero area, exactly
  std::size_t duplicate_triangles;   ///< same corners as an earlier one
  Box box;                           ///< [m] of all triangles

  /// Inside and outside are known, if the surface does not cross itself.
  bool isSolid() const { return closed && consistently_wound; }
};

/// What triangles add to their mesh's health.
struct HealthTally {
  std::size_t degenerate_triangles = 0;
  double volume = 0.0;    ///< six times, in the unit frame
  double rounding = 0.0;  ///< what it may have made of the volume

  void add(const HealthTally& other);
  void subtract(const HealthTally& other);
};

/// Six times the signed volume that a closed mesh encloses, in the unit frame. O(n).
double volumeOf(const TriangleMesh& mesh, const UnitFrame& frame);
/// Corners of some triangles that are no longer where their weld is.
std::size_t partedCorners(const std::vector<TriangleId>& triangles, const TriangleMesh& mesh,
                          const MeshTopology& topology);
/// The same of all triangles. O(n), if there are welds.
std::size_t partedCorners(const TriangleMesh& mesh, const MeshTopology& topology);

/// The box of all triangles [m]. O(n).
Box boxOf(const TriangleMesh& mesh);

/// `box` [m], `tally` and `parted_corners`, those no longer where their weld is, are of all
/// triangles.
MeshHealth healthOf(const MeshTopology& topology, const Box& box, const HealthTally& tally,
                    std::size_t parted_corners);

/// One sentence for each thing that is likely to be a mistake, a size that is no organ's
/// (millimetres?) included.
std::vector<std::string> warnings(const MeshHealth& health);

}  // namespace organ_collision::core
