#pragma once

#include "core/bounds.h"
#include "core/kernels.h"
#include "core/lane_vector.h"

// Places of vertices, and packets of triangles, for whichever vector unit includes it.
namespace organ_collision::core {
namespace {

inline void place(const double* positions, std::size_t count, const PlainUnitFrame& frame,
                  VertexPlace* places) {
  const std::array<double, 3>& centre = frame.centre;
#if defined(__AVX__)
  using Four __attribute__((vector_size(32))) = double;
  using Mask __attribute__((vector_size(32))) = long long;
  using Rounded __attribute__((vector_size(16))) = float;
  const Four middle = {centre[0], centre[1], centre[2], 0.0};
  for (std::size_t i = 0; i < count; ++i) {
    const Four position = __builtin_ia32_maskloadpd256(  // of the fourth, memory may have none
        reinterpret_cast<const Four*>(positions + 3 * i), Mask{-1, -1, -1, 0});
    *reinterpret_cast<Rounded*>(places + i) =
        __builtin_convertvector(frame.scale * (position - middle), Rounded);
  }
#else
  const auto coordinate = [&](std::size_t i, std::size_t axis) {
    return static_cast<float>(frame.scale * (positions[3 * i + axis] - centre[axis]));
  };
  for (std::size_t i = 0; i < count; ++i)
    places[i] = {coordinate(i, 0), coordinate(i, 1), coordinate(i, 2)};
#endif
}

/// The leaf in a lane, or the one that it repeats.
inline std::uint32_t leafIn(const TrianglePacket& packet, std::uint32_t lane) {
  return packet.first_leaf + (lane < packet.lane_count ? lane : 0);
}

/// One corner of each of a packet's triangles, in the unit frame.
inline LaneVector<float> cornerOf(const PlainMesh& mesh, const TrianglePacket& packet,
                                  std::uint32_t corner) {
  return gather([&](std::uint32_t lane) {
    return mesh.places + static_cast<std::uint32_t>(mesh.corners[leafIn(packet, lane)][corner]);
  });
}

/// The largest magnitude of a coordinate.
inline Lanes<float> largestCoordinate(const LaneVector<float>& v) {
  return larger(larger(magnitudeOf(v.x), magnitudeOf(v.y)), magnitudeOf(v.z));
}

/// Of the ball around all points whose coordinates are not larger. A root would take longer.
inline float radiusAround(const Lanes<float>& largest) {
  constexpr float kDiagonal = 1.7321F;  // of a cube, rounded up
  return kDiagonal * mostOf(largest) + kPlaceRounding;
}

/// What rounding makes of the square of a flat triangle's normal: this part of that of two edges.
/// The edges are off by 2*kPlaceRounding and shorter than 8.
constexpr float kFlat = 0x1p-36F;

[[gnu::always_inline]] inline PacketTally fillOne(const PlainMesh& mesh, TrianglePacket& packet,
                                                  LanePoints& centroids) {
  const LaneVector<float> a = cornerOf(mesh, packet, 0);
  const LaneVector<float> b = cornerOf(mesh, packet, 1);
  const LaneVector<float> c = cornerOf(mesh, packet, 2);
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

  packet.radius =
      radiusAround(larger(larger(largestCoordinate(corner), largestCoordinate(b - origin)),
                          largestCoordinate(c - origin)));

  const LaneVector<float> normal = cross(ab, ac);
  const Lanes<float> squared_edges = dot(ab, ab) + dot(ac, ac);
  const Truth<float> in_use = lanesInUse<float>(packet);
  const Truth<float> may_be_flat = dot(normal, normal) <= Lanes<float>::all(kFlat) * squared_edges;
  const Lanes<float> none{};
  return {sumOf(select(in_use, dot(a, normal), none)), sumOf(select(in_use, squared_edges, none)),
          (in_use & may_be_flat).bits()};
}

inline void fill(const PlainMesh& mesh, TrianglePacket* packets, std::size_t count,
                 PacketSplits* splits, PacketTally* tallies) {
  constexpr std::size_t kAhead = 8;  // packets
  for (std::size_t i = 0; i < count; ++i) {
    __builtin_prefetch(&packets[i + kAhead].origin, 1);
    tallies[i] = fillOne(mesh, packets[i], splits[i].centroids);
  }
}

}  // namespace
}  // namespace organ_collision::core
