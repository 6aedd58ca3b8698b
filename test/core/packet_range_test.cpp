// Between which distances the triangles of a packet are told to lie, against the measurement in
// double precision: on the baseline. That other vector units give the same bits is in
// vector_unit_test.
#include "core/packet_range.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "organ_collision/core/closest_point.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

Eigen::Vector3d pointOf(const LanePoints& points, std::uint32_t lane) {
  return {points[0][lane], points[1][lane], points[2][lane]};
}

void put(const Eigen::Vector3d& point, std::uint32_t lane, LanePoints& points) {
  for (int axis = 0; axis < 3; ++axis) points[axis][lane] = static_cast<float>(point[axis]);
}

Triangle triangleOf(const TrianglePacket& packet, std::uint32_t lane) {
  const Eigen::Vector3d a = pointOf(packet.corner, lane);
  return {a, a + pointOf(packet.edge1, lane), a + pointOf(packet.edge2, lane)};
}

/// Needles and caps, the thinner the smaller `thinness` is, of many sizes.
TrianglePacket packetOf(std::mt19937& generator, double thinness) {
  std::uniform_real_distribution<double> digits(0.0, 4.0), along(-1.0, 2.0);
  TrianglePacket packet = {};
  packet.lane_count = kLaneCount;
  for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) {
    const double size = std::pow(10.0, -1.0 - digits(generator));
    const Eigen::Vector3d edge = test::randomPoint(generator, size);
    put(test::randomPoint(generator, 0.1), lane, packet.corner);
    put(edge, lane, packet.edge1);
    put(along(generator) * edge + test::randomPoint(generator, thinness * size), lane,
        packet.edge2);
    const Triangle triangle = triangleOf(packet, lane);
    for (const Eigen::Vector3d& corner : {triangle.a, triangle.b, triangle.c})
      packet.radius = std::max(packet.radius, static_cast<float>(corner.norm() * (1.0 + 1e-6)));
  }
  return packet;
}

/// Over the face of one of the triangles, or on it.
Eigen::Vector3d tipOver(std::mt19937& generator, const Triangle& triangle) {
  std::uniform_real_distribution<double> part(0.0, 1.0), digits(1.0, 7.0);
  const double s = part(generator);
  const double t = part(generator) * (1.0 - s);
  const Eigen::Vector3d foot =
      triangle.a + s * (triangle.b - triangle.a) + t * (triangle.c - triangle.a);
  return foot + test::randomPoint(generator, std::pow(10.0, -digits(generator)));
}

/// Of how many triangles the bounds, without what rounding may take, are farther apart than that.
double shareOfWideRanges(double thinness) {
  constexpr int kTips = 20000;
  std::mt19937 generator(41);
  int wide = 0;
  for (int i = 0; i < kTips; ++i) {
    const TrianglePacket packet = packetOf(generator, thinness);
    const Eigen::Vector3f place =
        tipOver(generator, triangleOf(packet, static_cast<std::uint32_t>(i) % kLaneCount))
            .cast<float>();
    const Vector<float> tip = {place.x(), place.y(), place.z()};
    const float rounding = roundingOf(reachOf(tip), packet.radius);
    const auto [low, high] = squaredDistanceOfPoint(packet, tip, reachOf(tip) + 2 * packet.radius);
    for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) {
      const double distance = std::sqrt(
          closestPointOnTriangle(place.cast<double>(), triangleOf(packet, lane)).squared_distance);
      const double least = std::sqrt(double{low[lane]});
      const double most = std::sqrt(double{high[lane]});
      EXPECT_LE(least - double{rounding}, distance) << i << ", " << lane;
      EXPECT_GE(most + double{rounding}, distance) << i << ", " << lane;
      wide += most - least > double{rounding} ? 1 : 0;
    }
  }
  return static_cast<double>(wide) / (kTips * kLaneCount);
}

TEST(PacketRange, HoldsTheDistanceAndIsSeldomWide) { EXPECT_LT(shareOfWideRanges(1.0), 0.12); }

TEST(PacketRange, HoldsTheDistanceToNeedlesAndCaps) {
  for (const double thinness : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 0.0}) {
    SCOPED_TRACE(thinness);
    shareOfWideRanges(thinness);
  }
}

}  // namespace
}  // namespace organ_collision::core
