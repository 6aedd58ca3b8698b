// How far segments and triangles are told to be from the triangles of a packet, against the
// measurement in double precision: on the baseline.
#include "core/kernels/gap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <random>

#include "organ_collision/core/triangle_distance.h"
#include "random_packets.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

/// Of all tips and triangles.
struct Seen {
  double most_off = 0.0;  ///< as a part of what is given away
  std::uint64_t count = 0;
  std::uint64_t close = 0;  ///< lower bounds that are nearly the distance
};

/// How far the second is ahead of the first along an axis.
double separation(const Eigen::Vector3d& axis, const Triangle& first, const Triangle& second) {
  const auto along = [&](const Eigen::Vector3d& corner) { return axis.dot(corner); };
  return std::min({along(second.a), along(second.b), along(second.c)}) -
         std::max({along(first.a), along(first.b), along(first.c)});
}

/// A tip is as far from triangles as it is told, but for what rounding takes.
template <class Real, std::uint32_t kCorners>
void look(const Triangles& triangles, const Triangle& tip, Seen& seen) {
  const TrianglePacket packet = packetOf(triangles);
  const std::array<Eigen::Vector3d, 3> corners = cornersOf(tip);
  Vector<Real> relative_tip[kCorners];  // NOLINT(modernize-avoid-c-arrays): as kernels take it
  Real reach = 0;
  for (std::uint32_t i = 0; i < kCorners; ++i) {
    const Eigen::Vector3d& corner = corners[i];
    relative_tip[i] = relative<Real>({static_cast<Real>(corner.x()), static_cast<Real>(corner.y()),
                                      static_cast<Real>(corner.z())},
                                     packet.origin);
    reach = std::max(reach, reachOf(relative_tip[i]));
  }
  const double rounding = kGapRoundings<kCorners> * double{roundingOf(reach, packet.radius)};
  const Gap<Real> gap = gapToTriangles(relative_tip, packet);
  for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) {
    const double distance =
        std::sqrt(closestPoints(tip, triangles[lane]).on_second.squared_distance);
    const auto low = static_cast<double>(gap.low[lane]);
    const auto high = static_cast<double>(gap.high[lane]);
    EXPECT_LE(low - rounding, distance) << lane;
    EXPECT_GE(high + rounding, distance) << lane;
    const Eigen::Vector3d axis =
        Eigen::Vector3d(gap.axis.x[lane], gap.axis.y[lane], gap.axis.z[lane]);
    const double apart = separation(axis.normalized(), tip, triangles[lane]);
    EXPECT_TRUE(low <= rounding || apart >= low - rounding) << lane;
    seen.most_off =
        std::max({seen.most_off, (low - distance) / rounding, (distance - high) / rounding});
    ++seen.count;
    seen.close += low + rounding > 0.999 * distance ? 1 : 0;
  }
}

/// Long and short, from near one of the triangles to anywhere.
template <std::uint32_t kCorners>
Triangle randomTip(std::mt19937& generator, const Triangles& triangles) {
  std::uniform_real_distribution<double> digits(0.0, 8.0);
  const auto near = [&](const Eigen::Vector3d& point) {
    return rounded(point + test::randomPoint(generator, std::pow(10.0, -digits(generator))));
  };
  const Triangle& triangle = triangles[generator() % kLaneCount];
  Triangle tip;
  tip.a =
      near(generator() % 2 == 0 ? triangle.a : Eigen::Vector3d(0.5 * (triangle.b + triangle.c)));
  tip.b = near(generator() % 2 == 0 ? tip.a : triangle.b);
  tip.c = kCorners == 2 ? tip.b : near(tip.b);
  return tip;
}

template <std::uint32_t kCorners>
void holdsTheDistance(unsigned seed) {
  std::mt19937 generator(seed);
  Seen seen;
  for (const double thinness : {1.0, 1e-1, 1e-2, 1e-4, 1e-6, 1e-8, 0.0}) {
    for (const double digits : {0.0, 4.0, 12.0}) {
      SCOPED_TRACE(testing::Message() << thinness << ", " << digits);
      for (int i = 0; i < 1000; ++i) {
        const Triangles triangles = randomTriangles(generator, thinness, digits);
        const Triangle tip = randomTip<kCorners>(generator, triangles);
        look<float, kCorners>(triangles, tip, seen);
        look<double, kCorners>(triangles, tip, seen);
        const Eigen::Vector3d away = test::randomPoint(generator, 1e6);
        look<double, kCorners>(triangles, {tip.a + away, tip.b + away, tip.c + away}, seen);
        ASSERT_FALSE(testing::Test::HasFailure());
      }
    }
  }
  EXPECT_GT(seen.most_off, 0.0);
  EXPECT_LT(seen.most_off, 0.5);  // what is given away is more than what it is for
  EXPECT_GT(seen.close, seen.count / 100 * 99);
}

TEST(Gap, OfSegmentsHoldsTheDistance) { holdsTheDistance<2>(61); }
TEST(Gap, OfTrianglesHoldsTheDistance) { holdsTheDistance<3>(62); }

}  // namespace
}  // namespace organ_collision::core
