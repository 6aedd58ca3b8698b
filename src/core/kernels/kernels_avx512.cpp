#include "core/kernels/unit_kernels.h"

namespace organ_collision::core {

const Kernels kAvx512Kernels = kUnitKernels;

}  // namespace organ_collision::core
