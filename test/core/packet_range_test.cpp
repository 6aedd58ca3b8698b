// How far points are told to be from the triangles of a packet, against the measurement in double
// precision: on the baseline. That other vector units give the same bits is in vector_unit_test.
#include "core/kernels/packet_range.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

#include "organ_collision/core/closest_point.h"
#include "random_packets.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

/// Over the face of one of the triangles, or on it.
Eigen::Vector3d tipOver(std::mt19937& generator, const Triangle& triangle) {
  std::uniform_real_distribution<double> part(0.0, 1.0), digits(1.0, 7.0);
  const double s = part(generator);
  const double t = part(generator) * (1.0 - s);
  const Eigen::Vector3d foot =
      triangle.a + s * (triangle.b - triangle.a) + t * (triangle.c - triangle.a);
  return foot + test::randomPoint(generator, std::pow(10.0, -digits(generator)));
}

/// A point is as far from triangles as it is told, but for what rounding takes; returns the most
/// that it was off by, as a part of that.
template <class Real>
double mostOff(const Triangles& triangles, const Eigen::Vector3d& place) {
  const TrianglePacket packet = packetOf(triangles);
  const Vector<Real> point = {static_cast<Real>(place.x()), static_cast<Real>(place.y()),
                              static_cast<Real>(place.z())};
  const double rounding = double{roundingOf(packet)} + kPlaceRounding;
  const LaneFrames<Real> frames = orthonormal(framesOf<Real>(packet));
  const auto nearest = nearestInFrames(frames, point);
  const auto [low, high] = nearest.range();
  const auto [direction, gap] = nearest.planes(frames);
  double most = 0.0;
  for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) {
    const ClosestPoint closest = closestPointOnTriangle(place, triangles[lane]);
    const double distance = std::sqrt(closest.squared_distance);
    EXPECT_LE(std::sqrt(static_cast<double>(low[lane])) - rounding, distance) << lane;
    EXPECT_GE(std::sqrt(static_cast<double>(high[lane])) + rounding, distance) << lane;
    EXPECT_LE(static_cast<double>(gap[lane]) - 2 * rounding, distance) << lane;
    const double off = std::abs(std::sqrt(static_cast<double>(nearest.squared[lane])) - distance);
    most = std::max(most, off / (rounding + 0.5 * double{kRangeRounding<Real>} * distance));
  }
  return most;
}

TEST(PacketRange, HoldsTheDistance) {
  std::mt19937 generator(41);
  double most = 0.0;
  for (const double thinness : {1.0, 1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 0.0}) {
    for (const double digits : {0.0, 4.0, 12.0, 40.0}) {
      SCOPED_TRACE(testing::Message() << thinness << ", " << digits);
      for (int i = 0; i < 2000; ++i) {
        const Triangles triangles = randomTriangles(generator, thinness, digits);
        const Eigen::Vector3d tip =
            rounded(tipOver(generator, triangles[generator() % kLaneCount]));
        most = std::max(most, mostOff<float>(triangles, tip));
        most =
            std::max(most, mostOff<float>(triangles, rounded(test::randomPoint(generator, 8.0))));
        most = std::max(most, mostOff<double>(triangles, tip));
        most = std::max(most, mostOff<double>(triangles, test::randomPoint(generator, 1e6)));
        ASSERT_FALSE(HasFailure());
      }
    }
  }
  EXPECT_GT(most, 0.0);
  EXPECT_LT(most, 0.5);  // what is given away is more than what it is for
}

TEST(PacketRange, HoldsTheDistanceWhereAllCornersAreOne) {
  Triangles triangles;
  triangles.fill({{0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}});
  for (Triangle& triangle : triangles) triangle.a = triangle.b = triangle.c = rounded(triangle.a);
  std::mt19937 generator(43);
  for (int i = 0; i < 1000; ++i)
    mostOff<float>(triangles, rounded(test::randomPoint(generator, 0.5)));
  mostOff<float>(triangles, triangles.front().a);
}

}  // namespace
}  // namespace organ_collision::core
