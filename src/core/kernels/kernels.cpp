#include "core/kernels/kernels.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <limits>

#include "core/for_each.h"
#include "organ_collision/core/vector_unit.h"

namespace organ_collision::core {
namespace {

PlainBox joined(PlainBox box, const PlainBox& other) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(box.low[axis], other.low[axis]);
    box.high[axis] = std::max(box.high[axis], other.high[axis]);
  }
  box.finite = box.finite && other.finite;
  return box;
}

}  // namespace

const Kernels& kernels() {
  static constexpr std::array kAll = {&kBaselineKernels, &kAvx2Kernels, &kAvx512Kernels};
  static_assert(static_cast<std::size_t>(VectorUnit::kBaseline) == 0 &&
                static_cast<std::size_t>(VectorUnit::kAvx2) == 1 &&
                static_cast<std::size_t>(VectorUnit::kAvx512) == 2);
  return *kAll[static_cast<std::size_t>(vectorUnit())];
}

PlainBox boxOfPoints(const double* points, std::size_t count) {
  constexpr std::size_t kGrain = 8192;  // points that are worth a task
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  OwnContext context;
  return tbb::parallel_reduce(
      tbb::blocked_range<std::size_t>(0, count, kGrain),
      PlainBox{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}, true},
      [points](const auto& some, const PlainBox& box) {
        return joined(box, kernels().boxOf(points + 3 * some.begin(), some.size()));
      },
      joined, context);
}

}  // namespace organ_collision::core
