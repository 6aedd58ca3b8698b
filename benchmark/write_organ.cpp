// Writes an organ that the benchmarks know by name as a file, for a node to load.
#include <cstdio>
#include <iostream>

#include "organs.h"
#include "tools/arguments.h"
#include "tools/output.h"
#include "tools/program.h"

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

void run(const std::vector<std::string>& words) {
  if (words.size() != 2) throw tools::UsageError("an organ and a file are wanted");
  tools::writeFile(words[1], obj(organNamed(words[0])));
}

}  // namespace
}  // namespace organ_collision::bench

int main(int count, char** words) {
  using namespace organ_collision;
  return tools::runProgram({"write_organ", "usage: write_organ ORGAN FILE.obj\n"},
                           {words + 1, words + count}, std::cout, std::cerr, bench::run);
}
