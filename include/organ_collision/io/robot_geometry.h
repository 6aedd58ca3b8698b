#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>

namespace organ_collision::io {

/// The mesh of a link's `<collision>`: `transformed(loadMesh(url), scale, origin)` is in the link's
/// frame.
struct LinkMesh {
  std::string url;
  Eigen::Vector3d scale;             ///< [m] per unit of the file, along the mesh's axes; never 0
  Eigen::Isometry3d link_from_mesh;  ///< [m]
};

/// The collision mesh of `link` in `robot_description`, a URDF document.
/// Throws std::invalid_argument naming the link if the document cannot be read, or unless the link
/// is there and has exactly one `<collision>`, a mesh with a finite scale that is not 0.
LinkMesh linkMesh(const std::string& robot_description, const std::string& link);

}  // namespace organ_collision::io
