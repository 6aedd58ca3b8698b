#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace organ_collision::core {

/// Index of a vertex in its mesh. The numbers are the file's.
enum class VertexId : std::uint32_t {};
/// Index of a triangle in its mesh. The numbers are the file's.
enum class TriangleId : std::uint32_t {};

constexpr std::size_t index(VertexId id) { return static_cast<std::size_t>(id); }
constexpr std::size_t index(TriangleId id) { return static_cast<std::size_t>(id); }

/// The three vertices of a triangle, in the file's order; seen from outside they run anticlockwise.
using Corners = std::array<VertexId, 3>;

}  // namespace organ_collision::core
