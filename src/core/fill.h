#pragma once

#include "core/kernels.h"
#include "core/lane_vector.h"

// Packets of triangles, for whichever vector unit includes it.
namespace organ_collision::core {
namespace {

/// A flat triangle's normal is not longer, in a packet of radius 1: its edges are off by 2^-50.
constexpr double kNormalRounding = 0x1p-44;

/// Single precision can hold it; off by at most 2^-24. REQUIRES: magnitude below 2^27.
inline double inSinglePrecision(double x) {
  constexpr double kLastBit = 0x1.8p29;  // numbers as large are multiples of 2^-23
  return (x + kLastBit) - kLastBit;
}

inline void storeRounded(const LaneVector<double>& v, LanePoints& points) {
  v.x.storeRounded(points[0]);
  v.y.storeRounded(points[1]);
  v.z.storeRounded(points[2]);
}

/// The leaf in a lane, or the one that it repeats.
inline std::uint32_t leafIn(const TrianglePacket& packet, std::uint32_t lane) {
  return packet.first_leaf + (lane < packet.lane_count ? lane : 0);
}

/// One corner of each of a packet's triangles, in the unit frame.
inline LaneVector<double> cornerOf(const PlainMesh& mesh, const TrianglePacket& packet,
                                   std::uint32_t corner) {
  const LaneVector<double> positions = gather([&](std::uint32_t lane) {
    return mesh.positions + mesh.corners[leafIn(packet, lane)][corner];
  });
  const auto& [center, scale] = mesh.frame;
  return Lanes<double>::all(scale) *
         (positions - everywhere(Vector<double>{center[0], center[1], center[2]}));
}

inline void storeCentroids(const LaneVector<double>& centroids, const TrianglePacket& packet,
                           std::array<float, 3>* places) {
  alignas(64) LanePoints rounded;
  storeRounded(centroids, rounded);
#if defined(__AVX512F__)
  // 24 numbers in the order of memory, of which the lanes in use are stored.
  using Eight __attribute__((vector_size(32))) = float;
  using Sixteen __attribute__((vector_size(64))) = float;
  const auto* rows = reinterpret_cast<const Eight*>(&rounded);
  const Sixteen xy = __builtin_shufflevector(rows[0], rows[1], 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11,
                                             12, 13, 14, 15);
  const Sixteen z =
      __builtin_shufflevector(rows[2], rows[2], 0, 1, 2, 3, 4, 5, 6, 7, 0, 1, 2, 3, 4, 5, 6, 7);
  const Sixteen first =
      __builtin_shufflevector(xy, z, 0, 8, 16, 1, 9, 17, 2, 10, 18, 3, 11, 19, 4, 12, 20, 5);
  const Sixteen last =
      __builtin_shufflevector(xy, z, 13, 21, 6, 14, 22, 7, 15, 23, 0, 0, 0, 0, 0, 0, 0, 0);
  const std::uint32_t used = (1U << (3 * packet.lane_count)) - 1;
  float* place = places[packet.first_leaf].data();
  __builtin_ia32_storeups512_mask(place, first, static_cast<std::uint16_t>(used));
  __builtin_ia32_storeups512_mask(place + 16, last, static_cast<std::uint16_t>(used >> 16));
#else
#pragma GCC unroll 8
  for (std::uint32_t lane = 0; lane < kLaneCount; ++lane)
    places[leafIn(packet, lane)] = {rounded[0][lane], rounded[1][lane], rounded[2][lane]};
#endif
}

[[gnu::always_inline]] inline PacketTally fillOne(const PlainMesh& mesh, TrianglePacket& packet,
                                                  std::array<float, 3>* centroids) {
  const LaneVector<double> a = cornerOf(mesh, packet, 0);
  const LaneVector<double> b = cornerOf(mesh, packet, 1);
  const LaneVector<double> c = cornerOf(mesh, packet, 2);
  storeCentroids(Lanes<double>::all(1.0 / 3.0) * (a + b + c), packet, centroids);

  const Vector<double> first = {inSinglePrecision(a.x[0]), inSinglePrecision(a.y[0]),
                                inSinglePrecision(a.z[0])};
  packet.origin = {static_cast<float>(first.x), static_cast<float>(first.y),
                   static_cast<float>(first.z)};
  const LaneVector<double> origin = everywhere(first);
  const LaneVector<double> ab = b - a;
  const LaneVector<double> ac = c - a;
  storeRounded(a - origin, packet.corner);
  storeRounded(ab, packet.edge1);
  storeRounded(ac, packet.edge2);

  const auto squared_reach = [&origin](const LaneVector<double>& point) {
    return dot(point - origin, point - origin);
  };
  const double squared_radius =
      mostOf(larger(larger(squared_reach(a), squared_reach(b)), squared_reach(c)));
  packet.radius = static_cast<float>(rootOf(squared_radius) * (1.0 + 0x1p-20));

  const LaneVector<double> normal = cross(ab, ac);
  const Truth<double> in_use =
      Lanes<double>::numbers() <= Lanes<double>::all(static_cast<double>(packet.lane_count - 1));
  const Truth<double> may_be_flat =
      dot(normal, normal) <= Lanes<double>::all(kNormalRounding * kNormalRounding * squared_radius);
  return {sumOf(select(in_use, dot(a, normal), Lanes<double>{})), (in_use & may_be_flat).bits()};
}

inline void fill(const PlainMesh& mesh, TrianglePacket* packets, std::size_t count,
                 std::array<float, 3>* centroids, PacketTally* tallies) {
  for (std::size_t i = 0; i < count; ++i) tallies[i] = fillOne(mesh, packets[i], centroids);
}

}  // namespace
}  // namespace organ_collision::core
