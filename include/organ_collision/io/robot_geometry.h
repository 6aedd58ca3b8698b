#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <variant>
#include <vector>

#include "organ_collision/core/instrument.h"

namespace organ_collision::io {

/// The mesh of a link's `<collision>`: `transformed(loadMesh(url), scale, origin)` is in the link's
/// frame.
struct LinkMesh {
  std::string url;
  Eigen::Vector3d scale;      ///< [m] per unit of the file, along the mesh's axes; never 0
  core::Pose link_from_mesh;  ///< [m]
};

/// A piece of a link's geometry in the link's frame: a mesh that is yet to be read, or a shape.
using LinkPiece = std::variant<LinkMesh, core::Shape>;

/// Every <collision> of `link` in `robot_description`, a URDF document. A box becomes its own 12
/// triangles, a cylinder the prism of kCylinderSides whose faces touch it; both are convex.
/// The document is read in a child process, so that one that crashes the parser, by elements or
/// joints one in another by the ten thousands, ends as an error here; it costs a fork, with the
/// caution at loadMesh(). Throws std::runtime_error naming the link if the document cannot be read,
/// or unless the link is there and has a <collision>; std::invalid_argument naming the link and the
/// value unless sizes are above 0 (a mesh's scale: finite and not 0), and they and the coordinates
/// of origins below core::kLargestCoordinate.
std::vector<LinkPiece> linkPieces(const std::string& robot_description, const std::string& link);

/// Such a prism holds the cylinder; its edges are outside by at most 0.5 % of the radius.
constexpr int kCylinderSides = 32;

/// The collision mesh of `link` in `robot_description`, a URDF document that is read as by
/// linkPieces(), with its errors; std::invalid_argument also unless the link has exactly one
/// `<collision>`, a mesh with a finite scale that is not 0.
LinkMesh linkMesh(const std::string& robot_description, const std::string& link);

}  // namespace organ_collision::io
