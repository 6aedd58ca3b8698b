#include "core/vertex_lists.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "core/for_each.h"

namespace organ_collision::core {
namespace {

constexpr std::size_t kListGrain = 16;  // nodes that are worth a task

/// Numbers vertices in the order in which they are seen. It may forget some and number them once
/// more: looking further would take a branch, which could not be foreseen.
class Numbering {
 public:
  /// The number of `vertex`: `count`, how many there are, if it is new.
  std::uint32_t operator()(VertexId vertex, std::uint32_t count) {
    Seen& seen = seen_[index(vertex) % kPlaces];
    const std::uint32_t known = 0U - static_cast<std::uint32_t>(seen.vertex == vertex);
    const std::uint32_t number = (seen.number & known) | (count & ~known);
    seen = {vertex, number};
    return number;
  }

 private:
  static constexpr std::size_t kPlaces = 256;  // a node has some thirty

  struct Seen {
    VertexId vertex{0xFFFFFFFF};  // none: more than a mesh may have
    std::uint32_t number = 0;
  };
  std::array<Seen, kPlaces> seen_;
};

/// Calls `see(packet, corner, lane, vertex)` for all lanes of a node's packets; those that are not
/// in use repeat the first.
template <class See>
[[gnu::always_inline]] inline void forEachCorner(const WideLayout& layout, std::size_t node,
                                                 const Corners* corners, const See& see) {
  const std::uint32_t first = layout.nodes[node].first_packet;
  for (std::uint32_t packet = first; packet < first + layout.nodes[node].packet_count; ++packet) {
    const auto& [begin, end, parent] = layout.packets[packet];
    for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) {
      const Corners& vertices = corners[begin + lane < end ? begin + lane : begin];
      for (std::size_t corner = 0; corner < vertices.size(); ++corner)
        see(packet, corner, lane, vertices[corner]);
    }
  }
}

}  // namespace

VertexLists listVertices(const WideLayout& layout, const HugePageVector<Corners>& corners) {
  VertexLists lists;
  lists.corners.resize(layout.packets.size());
  lists.firsts.assign(layout.nodes.size() + 1, 0);
  forEach(layout.nodes.size(), kListGrain, [&](std::size_t self) {
    Numbering numbering;
    std::uint32_t count = 0;
    forEachCorner(
        layout, self, corners.data(),
        [&](std::uint32_t packet, std::size_t corner, std::uint32_t lane, VertexId vertex) {
          const std::uint32_t number = numbering(vertex, count);
          count += number == count ? 1 : 0;
          lists.corners[packet][corner][lane] =
              static_cast<std::uint16_t>(number * sizeof(VertexPlace));
        });
    lists.firsts[self + 1] = count;
  });
  std::partial_sum(lists.firsts.begin(), lists.firsts.end(), lists.firsts.begin());
  lists.vertices.resize(lists.firsts.back());
  forEach(layout.nodes.size(), kListGrain, [&](std::size_t self) {
    VertexId* const vertices = lists.vertices.data() + lists.firsts[self];
    forEachCorner(
        layout, self, corners.data(),
        [&](std::uint32_t packet, std::size_t corner, std::uint32_t lane, VertexId vertex) {
          vertices[lists.corners[packet][corner][lane] / sizeof(VertexPlace)] = vertex;
        });
  });
  return lists;
}

}  // namespace organ_collision::core
