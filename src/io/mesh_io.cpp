#include "organ_collision/io/mesh_io.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "bytes.h"
#include "mesh_readers.h"
#include "sandbox.h"

namespace organ_collision::io {
namespace {

/// [bytes] of `file`. Throws unless it is a regular file of at most `largest` bytes. Never waits
/// for a FIFO's writer.
std::uintmax_t sizeOf(const std::filesystem::path& file, const std::string& what,
                      std::uintmax_t largest) {
  const int opened = ::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  struct stat status {};
  const bool known = opened >= 0 && ::fstat(opened, &status) == 0;
  const int error = errno;
  if (opened >= 0) ::close(opened);
  if (!known) throw std::runtime_error(what + ": " + std::generic_category().message(error));
  if (!S_ISREG(status.st_mode)) throw std::runtime_error(what + ": is not a regular file");
  const auto size = static_cast<std::uintmax_t>(status.st_size);
  if (size == 0) throw std::runtime_error(what + ": is empty");
  if (size <= largest) return size;
  throw std::runtime_error(what + ": has " + std::to_string(size) + " bytes, more than the " +
                           std::to_string(largest) + " allowed");
}

std::string contents(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::string lowerCaseExtension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& letter : extension) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter - 'A' + 'a');
  }
  return extension;
}

core::TriangleMesh readMesh(const std::filesystem::path& file) {
  const std::string extension = lowerCaseExtension(file);
  if (extension == ".obj") return readObj(contents(file));
  if (extension == ".off") return readOff(contents(file));
  if (extension == ".ply") return readPly(contents(file));
  if (extension == ".stl") return readStl(contents(file));
  if (extension == ".dae") checkDae(contents(file));
  if (extension == ".gltf" || extension == ".glb") checkGltf(contents(file));
  return readWithAssimp(file, extension);
}

// ---- a mesh as bytes, for the way from the child to here

std::string encode(const core::TriangleMesh& mesh) {
  std::string bytes;
  appendItems(bytes, mesh.positions());
  appendItems(bytes, mesh.triangles());
  return bytes;
}

core::TriangleMesh decode(std::string_view bytes) {
  auto positions = takeItems<core::Points>(bytes);
  auto triangles = takeItems<std::vector<core::Corners>>(bytes);
  return {std::move(positions), std::move(triangles)};
}

}  // namespace

core::TriangleMesh loadMesh(const std::filesystem::path& file, double scale,
                            const LoadLimits& limits) {
  const std::string what = "mesh '" + file.string() + "'";
  if (!(std::isfinite(scale) && scale > 0.0)) {
    std::ostringstream message;
    message << what << ": the scale is " << scale << ", but it must be a finite number above 0";
    throw std::invalid_argument(message.str());
  }
  const std::uintmax_t size = sizeOf(file, what, limits.file);
  const auto job = [&] {
    return encode(transformed(readMesh(file), Eigen::Vector3d::Constant(scale),
                              Eigen::Isometry3d::Identity()));
  };
  return decode(runInChild(what, job, limitsFor(size, limits)));
}

core::TriangleMesh transformed(const core::TriangleMesh& mesh, const Eigen::Vector3d& scale,
                               const Eigen::Isometry3d& origin) {
  const auto is_usable = [](double factor) { return std::isfinite(factor) && factor != 0.0; };
  if (!std::all_of(scale.begin(), scale.end(), is_usable)) {
    std::ostringstream message;
    message << "the scale is (" << scale.transpose() << "), but it must be finite and not 0";
    throw std::invalid_argument(message.str());
  }
  if (!origin.matrix().allFinite()) throw std::invalid_argument("the origin is not finite");

  core::Points positions = mesh.positions();
  for (Eigen::Vector3d& position : positions) position = origin * scale.cwiseProduct(position);
  std::vector<core::Corners> triangles = mesh.triangles();
  const bool mirrored = (scale.array() < 0.0).count() % 2 == 1;
  if (mirrored) {
    for (core::Corners& corners : triangles) std::swap(corners[1], corners[2]);
  }
  return {std::move(positions), std::move(triangles)};
}

}  // namespace organ_collision::io
