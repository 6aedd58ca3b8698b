#pragma once

#include "core/bounds.h"
#include "core/kernels.h"
#include "core/lane_vector.h"

// Packets of triangles, for whichever vector unit includes it.
namespace organ_collision::core {
namespace {

/// Of as many as a node's packets can have.
using VertexPlaces = std::array<VertexPlace, std::size_t{3} * kLaneCount * kLaneCount>;

/// Asks for where some vertices are: another core may have written it.
inline void fetchAll(const PlainMesh& mesh, const VertexId* begin, const VertexId* end) {
  for (const VertexId* vertex = begin; vertex != end; ++vertex)
    __builtin_prefetch(mesh.positions + 3 * static_cast<std::size_t>(*vertex));
}

/// Rounds them to their places.
inline void place(const PlainMesh& mesh, const VertexId* begin, const VertexId* end,
                  VertexPlaces& places) {
  const std::array<double, 3>& centre = mesh.frame.centre;
  const double scale = mesh.frame.scale;
  VertexPlace* place = places.data();
#if defined(__AVX__)
  using Four __attribute__((vector_size(32))) = double;
  using Mask __attribute__((vector_size(32))) = long long;
  using Rounded __attribute__((vector_size(16))) = float;
  const Four middle = {centre[0], centre[1], centre[2], 0.0};
  for (const VertexId* vertex = begin; vertex != end; ++vertex, ++place) {
    const Four position = __builtin_ia32_maskloadpd256(  // of the fourth, memory may have none
        reinterpret_cast<const Four*>(mesh.positions + 3 * static_cast<std::size_t>(*vertex)),
        Mask{-1, -1, -1, 0});
    *reinterpret_cast<Rounded*>(place) =
        __builtin_convertvector(scale * (position - middle), Rounded);
  }
#else
  for (const VertexId* vertex = begin; vertex != end; ++vertex, ++place) {
    const auto coordinate = [&](std::size_t axis) {
      return static_cast<float>(
          scale * (mesh.positions[3 * static_cast<std::size_t>(*vertex) + axis] - centre[axis]));
    };
    *place = {coordinate(0), coordinate(1), coordinate(2)};
  }
#endif
}

/// One corner of each of a packet's triangles.
inline LaneVector<float> cornerOf(const VertexPlaces& places,
                                  const std::array<std::uint8_t, kLaneCount>& numbers) {
  return gather([&](std::uint32_t lane) { return &places[numbers[lane]]; });
}

/// Of the ball around a packet's origin that holds its triangles, each with a corner and two edges
/// from there of which `squares` are the sums: none is farther than the root of twice that.
inline float radiusAround(const Lanes<float>& squares) {
  return rootOf(2.0F * mostOf(squares)) * kRadiusRounding + kPlaceRounding;
}

/// What rounding makes of the square of a flat triangle's normal: this part of that of two edges.
/// The edges are off by 2*kPlaceRounding and shorter than 8.
constexpr float kFlat = 0x1p-36F;

[[gnu::always_inline]] inline PacketTally fillOne(const VertexPlaces& places,
                                                  const PacketCorners& corners,
                                                  TrianglePacket& packet, LanePoints& centroids) {
  const LaneVector<float> a = cornerOf(places, corners[0]);
  const LaneVector<float> b = cornerOf(places, corners[1]);
  const LaneVector<float> c = cornerOf(places, corners[2]);
  const LaneVector<float> ab = b - a;
  const LaneVector<float> ac = c - a;
  store(a + Lanes<float>::all(1.0F / 3.0F) * (ab + ac), centroids);

  const Vector<float> first = {a.x[0], a.y[0], a.z[0]};
  packet.origin = {first.x, first.y, first.z};
  const LaneVector<float> origin = everywhere(first);
  const LaneVector<float> corner = a - origin;
  store(corner, packet.corner);
  store(ab, packet.edge1);
  store(ac, packet.edge2);

  const LaneVector<float> normal = cross(ab, ac);
  const Lanes<float> squared_edges = dot(ab, ab) + dot(ac, ac);
  packet.radius = radiusAround(dot(corner, corner) + squared_edges);
  const Truth<float> in_use = lanesInUse<float>(packet);
  const Truth<float> may_be_flat = dot(normal, normal) <= Lanes<float>::all(kFlat) * squared_edges;
  const Lanes<float> none{};
  return {sumOf(select(in_use, dot(a, normal), none)), sumOf(select(in_use, squared_edges, none)),
          (in_use & may_be_flat).bits()};
}

inline void fill(const PlainMesh& mesh, const PlainTree& tree, std::uint32_t begin,
                 std::uint32_t end) {
  constexpr std::uint32_t kAhead = 8;  // packets
  VertexPlaces places;
  const auto first = [&mesh](std::uint32_t number) {
    return mesh.vertices + mesh.first_vertices[number];
  };
  for (std::uint32_t number = begin; number < end; ++number) {
    if (number + 1 < end) fetchAll(mesh, first(number + 1), first(number + 2));
    place(mesh, first(number), first(number + 1), places);
    const WideNode& node = tree.nodes[number];
    const std::uint32_t last = node.first_packet + node.lane_count - node.node_count;
    for (std::uint32_t i = node.first_packet; i < last; ++i) {
      __builtin_prefetch(&tree.packets[i + kAhead].origin, 1);
      tree.tallies[i] =
          fillOne(places, mesh.corners[i], tree.packets[i], tree.packet_splits[i].centroids);
    }
  }
}

}  // namespace
}  // namespace organ_collision::core
