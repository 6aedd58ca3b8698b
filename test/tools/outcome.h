#pragma once

#include <functional>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

// What a command of the tools leaves behind.
namespace organ_collision::tools {

struct Outcome {
  int exit_code;
  std::string out, errors;
};

using Command = std::function<int(const std::vector<std::string>& words, std::ostream& out,
                                  std::ostream& errors)>;

inline Outcome outcomeOf(const Command& command, const std::vector<std::string>& words) {
  std::ostringstream out;
  std::ostringstream errors;
  const int exit_code = command(words, out, errors);
  return {exit_code, out.str(), errors.str()};
}

}  // namespace organ_collision::tools
