#include "organs.h"

#include <filesystem>
#include <stdexcept>

#include "organ_collision/core/box.h"
#include "organ_collision/io/mesh_io.h"
#include "test_meshes.h"

namespace organ_collision::bench {
namespace {

constexpr std::size_t kMostLevels = 10;  // 4^10 is a million

/// The K of "NAME@K", where `at` is.
std::size_t levelsOf(const std::string& name, std::size_t at) {
  if (at == std::string::npos) return 0;
  const std::string number = name.substr(at + 1);
  const bool is_number = number.size() == 1 || number == std::to_string(kMostLevels);
  if (!is_number || number.find_first_not_of("0123456789") != std::string::npos) {
    throw std::invalid_argument("'" + name + "' is to be divided '" + number +
                                "' times: 0 to 10 are wanted");
  }
  return std::stoul(number);
}

core::TriangleMesh divided(core::TriangleMesh mesh, std::size_t levels) {
  for (std::size_t level = 0; level < levels; ++level) mesh = test::subdivided(mesh);
  return mesh;
}

}  // namespace

core::TriangleMesh liver(std::size_t levels) {
  return divided(io::loadMesh(std::filesystem::path(MESHES) / "liver.obj"), levels);
}

core::TriangleMesh organNamed(const std::string& name) {
  std::size_t at = name.find_last_of("@/");
  if (at != std::string::npos && name[at] == '/') at = std::string::npos;  // an @ is a folder's
  const std::size_t levels = levelsOf(name, at);
  const std::string what = name.substr(0, at);
  if (what == "blob") return test::blob(levels);
  if (what == "liver") return liver(levels);
  return divided(io::loadMesh(what), levels);
}

core::TriangleMesh inUnitsOfItsDiagonal(const core::TriangleMesh& mesh) {
  core::Box box;
  for (const Eigen::Vector3d& position : mesh.positions()) box.add(position);
  const Eigen::Vector3d centre = 0.5 * (box.low + box.high);
  const double diagonal = (box.high - box.low).norm();
  if (!(diagonal > 0.0)) throw std::runtime_error("all vertices are at one place");
  core::Points positions = mesh.positions();
  for (Eigen::Vector3d& position : positions) position = (position - centre) / diagonal;
  return {positions, mesh.triangles()};
}

}  // namespace organ_collision::bench
