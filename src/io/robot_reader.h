#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace organ_collision::io {

enum class GeometryKind { kMesh, kSphere, kBox, kCylinder };

/// What a <collision> says, as it was read: no number of it was looked at.
struct LinkGeometry {
  GeometryKind kind;
  Eigen::Vector3d size;  ///< a mesh's scale; a box's sides; else radius, length and nothing [m]
  Eigen::Isometry3d link_from_geometry;  ///< [m]
};

struct LinkCollision {
  LinkGeometry geometry;
  std::string url;  ///< of a mesh
};

/// Every <collision> of `link` in `robot_description`. urdfdom and TinyXML call themselves for each
/// element within another and each joint after another: a description that is deep enough ends the
/// process, so readCollisionsInChild() is for those that come from outside. Throws
/// std::invalid_argument unless the description can be read, and the link is there and has a
/// <collision>, and all of them can be read.
std::vector<LinkCollision> readCollisions(const std::string& robot_description,
                                          const std::string& link);

/// The same, read in a child process, so that whatever the description does to the parser ends as
/// an error here: std::runtime_error naming the link.
std::vector<LinkCollision> readCollisionsInChild(const std::string& robot_description,
                                                 const std::string& link);

}  // namespace organ_collision::io
