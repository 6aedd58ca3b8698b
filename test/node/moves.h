#pragma once

#include <initializer_list>
#include <utility>

#include "node/vertex_moves.h"

namespace organ_collision::test {

/// New positions of the vertices with these numbers.
inline node::VertexMoves movesOf(std::initializer_list<std::size_t> numbers,
                                 core::Points positions) {
  node::VertexMoves moves = {{}, std::move(positions)};
  for (const std::size_t number : numbers)
    moves.vertices.push_back(static_cast<core::VertexId>(number));
  return moves;
}

}  // namespace organ_collision::test
