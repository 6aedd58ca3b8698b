#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "stability.h"

namespace organ_collision::tools {

/// The command `measure_stability`. `words`: without the program's name. The report goes to `out`,
/// one message of what went wrong to `errors`. Returns the exit code: 0, 1 (a broken promise too),
/// or 2 for wrong arguments.
int measureStability(const std::vector<std::string>& words, std::ostream& out, std::ostream& errors,
                     const Library& library = {});

}  // namespace organ_collision::tools
