#pragma once

#include <cstdint>
#include <vector>

namespace organ_collision::core {

/// Instructions by which the search measures eight boxes or triangles at a time. The baseline is
/// what every machine of the architecture has: SSE2 on x86-64.
enum class VectorUnit : std::uint8_t { kBaseline, kAvx2, kAvx512 };

/// Those that this machine has, the widest last.
std::vector<VectorUnit> availableVectorUnits();

/// The one in use: the widest, unless another was chosen.
VectorUnit vectorUnit();

/// Lets all searches that begin from now on use another one, which changes no bit of any answer:
/// for tests and measurements. Throws std::invalid_argument if the machine does not have it.
void useVectorUnit(VectorUnit unit);

}  // namespace organ_collision::core
