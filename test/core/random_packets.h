#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <utility>

#include "core/kernels/fill.h"
#include "organ_collision/core/triangle.h"
#include "test_meshes.h"

// Packets of hard triangles, for the kernels' tests.
namespace organ_collision::core {
namespace {

using Triangles = std::array<Triangle, kLaneCount>;

inline TrianglePacket packetOf(const Triangles& triangles) {
  VertexPlaces places;
  PacketCorners corners;
  std::uint16_t place = 0;
  for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) {
    const auto& [a, b, c] = triangles[lane];
    for (const auto& [vertex, of_lanes] : {std::pair{a, 0}, std::pair{b, 1}, std::pair{c, 2}}) {
      places[place] = {static_cast<float>(vertex.x()), static_cast<float>(vertex.y()),
                       static_cast<float>(vertex.z())};
      corners[of_lanes][lane] = static_cast<std::uint16_t>(sizeof(VertexPlace) * place++);
    }
  }
  TrianglePacket packet = {};
  packet.lane_count = kLaneCount;
  LaneTally tally;
  fillOne(places, corners, packet, tally);
  for (std::uint16_t i = 0; i < place; ++i) {  // the least radius there is
    const Vector<float> offset =
        Vector<float>{places[i].x, places[i].y, places[i].z} - vectorOf<float>(packet.origin);
    packet.radius = std::max(packet.radius, rootOf(dot(offset, offset)));
  }
  return packet;
}

/// A corner in single precision.
inline Eigen::Vector3d rounded(const Eigen::Vector3d& corner) {
  return corner.cast<float>().cast<double>();
}

/// Needles and caps, the thinner the smaller `thinness` is, of many sizes, the smaller the more
/// digits there are.
inline Triangles randomTriangles(std::mt19937& generator, double thinness, double most_digits) {
  std::uniform_real_distribution<double> digits(0.0, most_digits), along(-1.0, 2.0);
  Triangles triangles;
  for (Triangle& triangle : triangles) {
    const double size = std::pow(10.0, -1.0 - digits(generator));
    const Eigen::Vector3d edge = test::randomPoint(generator, size);
    const Eigen::Vector3d a = test::randomPoint(generator, generator() % 2 == 0 ? 0.1 : size);
    triangle = {
        rounded(a), rounded(a + edge),
        rounded(a + along(generator) * edge + test::randomPoint(generator, thinness * size))};
    if (generator() % 4 == 0) triangle.c = rounded(test::randomPoint(generator, 1.0));  // tall
    if (generator() % 2 == 0) std::swap(triangle.a, triangle.c);
  }
  return triangles;
}

}  // namespace
}  // namespace organ_collision::core
