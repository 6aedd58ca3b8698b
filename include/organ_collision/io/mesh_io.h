#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::io {

/// What reading one file may cost. Time and memory grow with the file. Infinite seconds: no limit.
struct LoadLimits {
  double seconds = 4.0;                 ///< [s] wall clock for any file
  double seconds_per_megabyte = 1.0;    ///< [s/MB] on top of it
  std::size_t memory = 512'000'000;     ///< [bytes] for any file
  std::size_t memory_per_byte = 64;     ///< [bytes per byte of the file] on top of it
  std::uintmax_t file = 1'000'000'000;  ///< [bytes] larger files are refused
};

/// The mesh in `file`, its positions multiplied by `scale` to give metres.
/// obj, ply and off keep their numbers: vertex i and triangle j are the file's, duplicate and
/// unreferenced vertices included; a polygon becomes a fan in its place, from its first corner or
/// the next from which a fan fills it, and one that no fan fills is refused. Vertices of every
/// other format are merged by exact position and numbered in the order of first appearance. All but
/// stl goes through assimp, in single precision, with node transforms applied; dae: `<unit>` is
/// applied, `<up_axis>` is not, as in rviz. The file is read in a child process, so that a parser
/// that crashes, hangs or eats memory ends as an error here. Throws std::invalid_argument unless
/// `scale` is finite and above 0, std::runtime_error naming file and element if it cannot be read:
/// anything but a regular file, bad syntax, an index out of range, a coordinate that is not finite
/// or exceeds a 32-bit float. What goes through assimp is refused where assimp fails, logs an error
/// or a loss of triangles, or finds another format than the extension names; where a dae says a
/// unit or index below 0, or a gltf asks for extensions; where a unit or scale is 0, an axis
/// or quaternion of a rotation is not of length 1, bones move a mesh, or a node's matrix is not
/// affine. What else is wrong in them may pass, as assimp reads it.
/// Cost: that of parsing, one fork and one copy through a pipe. Other threads' locks stay locked in
/// a forked child, so a call while other threads run may, rarely, end at its time limit: load
/// before starting them, or try again.
core::TriangleMesh loadMesh(const std::filesystem::path& file, double scale = 1.0,
                            const LoadLimits& limits = {});

/// `mesh` scaled along its axes by `scale`, then moved by `origin`. A mirroring scale turns each
/// triangle round, so that outside stays outside. Throws std::invalid_argument unless scales are
/// finite and not 0 and the origin is finite, or if a position becomes unusable.
core::TriangleMesh transformed(const core::TriangleMesh& mesh, const Eigen::Vector3d& scale,
                               const Eigen::Isometry3d& origin);

/// Where a package is, if it is known.
using PackageFinder =
    std::function<std::optional<std::filesystem::path>(const std::string& package)>;

/// The file that `url` names, absolute and without symbolic links. `url` is package://PACKAGE/PATH
/// or a plain path; every other scheme is refused. If `mesh_root` is given, the file must be below
/// it after all links and `..` are resolved. Throws std::invalid_argument naming `url` and the
/// resolved path.
std::filesystem::path resolveMesh(const std::string& url, const PackageFinder& find_package,
                                  const std::optional<std::filesystem::path>& mesh_root);

}  // namespace organ_collision::io
