#pragma once

#include "core/box_of_points.h"
#include "core/descend.h"
#include "core/enclose.h"
#include "core/far_points.h"
#include "core/fill.h"
#include "core/front_walk.h"
#include "core/kernels.h"
#include "core/pair_walk.h"
#include "core/search_walk.h"
#include "core/weigh.h"

namespace organ_collision::core {
namespace {

/// For the vector unit that includes this.
constexpr Kernels kUnitKernels = {
    walk,    follow, descend,      walkPairs,          followPairs, boxOf,       fill,
    enclose, weigh,  farthestFrom, farthestOfAllPairs, listByPower, listFarFrom, separate};

}  // namespace
}  // namespace organ_collision::core
