#include "core/kernels/unit_kernels.h"

namespace organ_collision::core {

const Kernels kAvx2Kernels = kUnitKernels;

}  // namespace organ_collision::core
