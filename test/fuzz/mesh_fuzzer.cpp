// The readers that are this package's own, and what is built from what they let through. The first
// byte says which reader, the rest is the file.
#include <array>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <string_view>

#include "io/mesh_readers.h"
#include "organ_collision/core/collision_mesh.h"
#include "organ_collision/core/nearest_triangle.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using namespace organ_collision;
  constexpr std::array kReaders = {io::readObj, io::readOff, io::readPly, io::readStl};
  if (size == 0) return -1;
  const std::string_view file(reinterpret_cast<const char*>(bytes + 1), size - 1);
  try {
    const core::CollisionMesh organ(kReaders[bytes[0] % kReaders.size()](file));
    core::nearestTriangle(organ, Eigen::Vector3d::Zero());
  } catch (const std::exception&) {  // a refusal
  }
  return 0;
}
