#include "core/kernels/unit_kernels.h"

namespace organ_collision::core {

const Kernels kBaselineKernels = kUnitKernels;

}  // namespace organ_collision::core
