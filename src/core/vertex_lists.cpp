#include "core/vertex_lists.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <numeric>

#include "core/for_each.h"

namespace organ_collision::core {
namespace {

constexpr std::size_t kGrain = 16;  // nodes that are worth a task

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
[[gnu::always_inline]] inline void forEachCorner(const WideNode& node,
                                                 const TrianglePacket* packets,
                                                 const Corners* corners, const See& see) {
  const std::uint32_t end = node.first_packet + node.lane_count - node.node_count;
  for (std::uint32_t packet = node.first_packet; packet < end; ++packet) {
    const Corners* const leaves = corners + packets[packet].first_leaf;
    const std::uint32_t in_use = packets[packet].lane_count;
    for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) {
      const Corners& vertices = leaves[lane < in_use ? lane : 0];
      for (std::size_t corner = 0; corner < 3; ++corner)
        see(packet, corner, lane, vertices[corner]);
    }
  }
}

}  // namespace

VertexLists listVertices(const HugePageVector<WideNode>& nodes,
                         const HugePageVector<TrianglePacket>& packets,
                         const HugePageVector<Corners>& corners) {
  VertexLists lists;
  lists.corners.resize(packets.size());
  lists.firsts.assign(nodes.size() + 1, 0);
  forEach(nodes.size(), kGrain, [&](std::size_t self) {
    Numbering numbering;
    std::uint32_t count = 0;
    forEachCorner(
        nodes[self], packets.data(), corners.data(),
        [&](std::uint32_t packet, std::size_t corner, std::uint32_t lane, VertexId vertex) {
          const std::uint32_t number = numbering(vertex, count);
          count += number == count ? 1 : 0;
          lists.corners[packet][corner][lane] = static_cast<std::uint8_t>(number);
        });
    lists.firsts[self + 1] = count;
  });
  std::partial_sum(lists.firsts.begin(), lists.firsts.end(), lists.firsts.begin());
  lists.vertices.resize(lists.firsts.back());
  forEach(nodes.size(), kGrain, [&](std::size_t self) {
    VertexId* const vertices = lists.vertices.data() + lists.firsts[self];
    forEachCorner(nodes[self], packets.data(), corners.data(),
                  [&](std::uint32_t packet, std::size_t corner, std::uint32_t lane,
                      VertexId vertex) { vertices[lists.corners[packet][corner][lane]] = vertex; });
  });
  return lists;
}

}  // namespace organ_collision::core
