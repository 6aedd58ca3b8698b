#pragma once

#include <functional>
#include <ostream>
#include <string>
#include <vector>

namespace organ_collision::tools {

struct Program {
  std::string name;
  std::string usage;  ///< what --help tells
};

/// What every main() does with its words, its name left out: hands them to `run` and returns 0.
/// Where --help is among them, tells the usage instead. Where `run` throws or `out` took not all,
/// tells that as an error and returns 2 for a UsageError, 1 for others.
int runProgram(const Program& program, const std::vector<std::string>& words, std::ostream& out,
               std::ostream& errors,
               const std::function<void(const std::vector<std::string>&)>& run);

}  // namespace organ_collision::tools
