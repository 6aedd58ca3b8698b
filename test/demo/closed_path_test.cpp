#include "demo/closed_path.h"

#include <gtest/gtest.h>

#include <cstddef>

namespace organ_collision::demo {
namespace {

constexpr double kTolerance = 1e-12;  // [m] a few roundings of coordinates of some metres

const std::vector<Eigen::Vector3d> kWaypoints = {{0, 0, 0}, {3, 0, 1}, {4, 2, 0}, {1, 5, 2}};

TEST(ClosedPath, GoesThroughEachWaypoint) {
  for (std::size_t i = 0; i < kWaypoints.size(); ++i) {
    const double turn = static_cast<double>(i) / static_cast<double>(kWaypoints.size());
    EXPECT_EQ(pointOnClosedPath(kWaypoints, turn), kWaypoints[i]);
  }
}

TEST(ClosedPath, EndsWhereItBegan) {
  EXPECT_EQ(pointOnClosedPath(kWaypoints, 1.0), kWaypoints.front());
}

TEST(ClosedPath, IsHalfWayBetweenEvenlySpacedWaypoints) {
  const std::vector<Eigen::Vector3d> on_a_line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}};
  EXPECT_LE((pointOnClosedPath(on_a_line, 1.5 / 4) - Eigen::Vector3d(1.5, 0, 0)).norm(),
            kTolerance);
}

TEST(ClosedPath, PassesAWaypointWithoutAJumpOfVelocity) {
  constexpr double kStep = 1e-6;         // of a turn
  constexpr double kBend = 1e3 * kStep;  // [m/turn] second derivatives here are below 1000 m/turn^2
  for (const double turn : {0.25, 0.5, 0.75}) {
    const Eigen::Vector3d here = pointOnClosedPath(kWaypoints, turn);
    const Eigen::Vector3d before = (here - pointOnClosedPath(kWaypoints, turn - kStep)) / kStep;
    const Eigen::Vector3d after = (pointOnClosedPath(kWaypoints, turn + kStep) - here) / kStep;
    EXPECT_LE((after - before).norm(), kBend);
    EXPECT_GE(before.norm(), 1.0);  // [m/turn]: it does move
  }
}

TEST(ClosedPath, OneWaypointStandsStill) {
  EXPECT_EQ(pointOnClosedPath({{1, 2, 3}}, 0.3), Eigen::Vector3d(1, 2, 3));
}

}  // namespace
}  // namespace organ_collision::demo
