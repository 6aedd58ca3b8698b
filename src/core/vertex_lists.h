#pragma once

#include "organ_collision/core/wide_tree.h"

namespace organ_collision::core {

/// The vertices that each node's packets have, `corners` being those of the leaves. O(n), on all
/// cores.
VertexLists listVertices(const HugePageVector<WideNode>& nodes,
                         const HugePageVector<TrianglePacket>& packets,
                         const HugePageVector<Corners>& corners);

}  // namespace organ_collision::core
