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

/// Of the ball around a packet's origin that holds its triangles, each with a corner and two edges
/// from there of which `squares` are the sums: none is farther than the root of twice that.
inline float radiusAround(const Lanes<float>& squares) {
  return rootOf(2.0F * mostOf(squares)) * kRadiusRounding + kPlaceRounding;
}

/// What rounding makes of the square of a flat triangle's normal: this part of that of two edges.
/// The edges are off by 2*kPlaceRounding and shorter than 8.
constexpr float kFlat = 0x1p-36F;

/// What triangles add to their mesh's health, lane by lane.
struct LaneTally {
  Lanes<float> volume = {}, squared_edges = {};
  std::uint32_t flat = 0;

  NodeTally sum() const { return {sumOf(volume), sumOf(squared_edges), flat}; }
};

[[gnu::always_inline]] inline void fillOne(const VertexPlaces& places, const PacketCorners& corners,
                                           TrianglePacket& packet, LanePoints& centroids,
                                           LaneTally& tally) {
  const LaneVector<float> a = gather(places.data(), corners[0]);
  const LaneVector<float> b = gather(places.data(), corners[1]);
  const LaneVector<float> c = gather(places.data(), corners[2]);
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
  tally.volume = tally.volume + select(in_use, dot(a, normal), none);
  tally.squared_edges = tally.squared_edges + select(in_use, squared_edges, none);
  tally.flat += static_cast<std::uint32_t>(__builtin_popcount((in_use & may_be_flat).bits()));
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
    const std::uint32_t packet_count = node.lane_count - node.node_count;
    const PacketCorners* const corners = mesh.corners + node.first_packet;
    TrianglePacket* const packets = tree.packets + node.first_packet;
    PacketSplits* const splits = tree.packet_splits + node.first_packet;
    LaneTally tally;
    for (std::uint32_t i = 0; i < packet_count; ++i) {
      __builtin_prefetch(&packets[i + kAhead].origin, 1);
      fillOne(places, corners[i], packets[i], splits[i].centroids, tally);
    }
    tree.tallies[number] = tally.sum();
  }
}

}  // namespace
}  // namespace organ_collision::core
