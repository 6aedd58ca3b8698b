#pragma once

#include "core/collapse.h"
#include "organ_collision/core/wide_tree.h"

namespace organ_collision::core {

/// The vertices that the packets of each of the layout's nodes have, `corners` being those of the
/// leaves, in the order in which they are to be taken. O(n), on all cores.
VertexLists listVertices(const WideLayout& layout, const HugePageVector<Corners>& corners);

}  // namespace organ_collision::core
