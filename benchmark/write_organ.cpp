// Writes an organ that the benchmarks know by name as a file, for a node to load.
#include <cstdio>
#include <iostream>

#include "organs.h"
#include "tools/output.h"

namespace organ_collision::bench {
namespace {

std::string obj(const core::TriangleMesh& mesh) {
  std::string text;
  char line[100];
  for (const Eigen::Vector3d& p : mesh.positions()) {
    std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", p.x(), p.y(), p.z());
    text += line;
  }
  for (const core::Corners& corners : mesh.triangles()) {
    std::snprintf(line, sizeof line, "f %zu %zu %zu\n", index(corners[0]) + 1,
                  index(corners[1]) + 1, index(corners[2]) + 1);
    text += line;
  }
  return text;
}

}  // namespace
}  // namespace organ_collision::bench

int main(int count, char** words) {
  using namespace organ_collision;
  if (count != 3) {
    std::cerr << "usage: write_organ ORGAN FILE.obj\n";
    return 2;
  }
  try {
    tools::writeFile(words[2], bench::obj(bench::organNamed(words[1])));
    return 0;
  } catch (const std::exception& error) {
    std::cerr << "write_organ: " << error.what() << std::endl;
    return 1;
  }
}
