#pragma once

#include "core/kernels/box_of_points.h"
#include "core/kernels/descend.h"
#include "core/kernels/enclose.h"
#include "core/kernels/far_points.h"
#include "core/kernels/fill.h"
#include "core/kernels/front_walk.h"
#include "core/kernels/kernels.h"
#include "core/kernels/pair_walk.h"
#include "core/kernels/search_walk.h"
#include "core/kernels/split_few.h"
#include "core/kernels/weigh.h"

namespace organ_collision::core {
namespace {

/// For the vector unit that includes this.
constexpr Kernels kUnitKernels = {
    walk,  follow,       descend, walkPairs,          followPairs, boxOf,       fill,     enclose,
    weigh, farthestFrom, reach,   farthestOfAllPairs, listByPower, listFarFrom, separate, splitFew};

}  // namespace
}  // namespace organ_collision::core
