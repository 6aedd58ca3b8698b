#pragma once

#include <array>
#include <cstdint>

// What FarthestPairTree is made of: plain data, which code for any vector unit can read.
namespace organ_collision::core {

/// A set's split. Those of m leaves are m - 1 nodes, which follow one another: first the set's own,
/// then the first child's, then the other's.
struct BinaryNode {
  std::array<std::uint32_t, 2> poles;  ///< leaves
  std::uint32_t first_size;            ///< leaves of the first child
};

}  // namespace organ_collision::core
