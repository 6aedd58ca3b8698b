#include "organ_collision/core/vector_unit.h"

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <string>

namespace organ_collision::core {
namespace {

/// No guard is asked at each query, as of a variable in a function. Until it is set, while a
/// program starts, it is the baseline: the answers are the same.
std::atomic<VectorUnit> chosen{availableVectorUnits().back()};

}  // namespace

std::vector<VectorUnit> availableVectorUnits() {
  std::vector<VectorUnit> units = {VectorUnit::kBaseline};
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") != 0) units.push_back(VectorUnit::kAvx2);
  if (__builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512vl") != 0 &&
      __builtin_cpu_supports("avx512dq") != 0)
    units.push_back(VectorUnit::kAvx512);
#endif
  return units;
}

VectorUnit vectorUnit() { return chosen.load(std::memory_order_relaxed); }

void useVectorUnit(VectorUnit unit) {
  const std::vector<VectorUnit> units = availableVectorUnits();
  if (std::find(units.begin(), units.end(), unit) == units.end()) {
    throw std::invalid_argument("this machine has no vector unit " +
                                std::to_string(static_cast<int>(unit)));
  }
  chosen.store(unit, std::memory_order_relaxed);
}

}  // namespace organ_collision::core
