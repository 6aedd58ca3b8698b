#include "core/kernels.h"

#include "organ_collision/core/vector_unit.h"

namespace organ_collision::core {

const Kernels& kernels() {
  switch (vectorUnit()) {
    case VectorUnit::kAvx512:
      return kAvx512Kernels;
    case VectorUnit::kAvx2:
      return kAvx2Kernels;
    case VectorUnit::kBaseline:
      break;
  }
  return kBaselineKernels;
}

}  // namespace organ_collision::core
