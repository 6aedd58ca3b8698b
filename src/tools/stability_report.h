#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "stability.h"

namespace organ_collision::tools {

/// All that was measured.
struct Stability {
  std::size_t samples;
  std::uint64_t seed;
  std::vector<StabilityRow> rows;
};

/// One sentence for each class and subject whose promise is broken; none if all are kept.
std::vector<std::string> brokenPromises(const Stability& stability);

/// What is printed, in lines of at most 110 characters: the table, and what is promised or broken.
std::string report(const Stability& stability);

/// One row for each class and subject that there were trials of, units in the header.
std::string csv(const Stability& stability);

}  // namespace organ_collision::tools
