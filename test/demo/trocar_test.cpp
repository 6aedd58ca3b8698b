#include "demo/trocar.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace organ_collision::demo {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kTolerance =
    1e-15;  // [m], [rad]: a few roundings of decimetres and of angles up to pi

/// Where the tip is [m], in the trocar's frame.
Eigen::Vector3d tipInTrocar(const TrocarJoints& joints) {
  const double across = std::cos(joints.pitch);
  return joints.insertion * Eigen::Vector3d(across * std::sin(joints.yaw), -std::sin(joints.pitch),
                                            across * std::cos(joints.yaw));
}

double distance(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return (a - b).norm(); }

TEST(Trocar, TheTipStraightBelowNeedsInsertionOnly) {
  const TrocarJoints joints = jointsForTip({0.0, 0.0, 0.1});
  EXPECT_EQ(joints.yaw, 0.0);
  EXPECT_EQ(joints.pitch, 0.0);
  EXPECT_EQ(joints.insertion, 0.1);
}

TEST(Trocar, YawTurnsZTowardsXAndPitchTurnsYTowardsZ) {  // the right-hand rule about y and about x
  EXPECT_LE(distance(tipInTrocar({kPi / 2, 0.0, 1.0}), Eigen::Vector3d::UnitX()), kTolerance);
  EXPECT_LE(distance(tipInTrocar({0.0, -kPi / 2, 1.0}), Eigen::Vector3d::UnitY()), kTolerance);
}

TEST(Trocar, ATipInTheTrocarNeedsNoMotion) {
  for (const double zero : {0.0, -0.0}) {
    const TrocarJoints joints = jointsForTip({zero, zero, zero});
    EXPECT_EQ(joints.yaw, 0.0);
    EXPECT_EQ(joints.pitch, 0.0);
    EXPECT_EQ(joints.insertion, 0.0);
  }
}

TEST(Trocar, AShaftAcrossTheTrocarStillFindsItsTip) {
  const Eigen::Vector3d tip(0.0, -0.2, 0.0);
  EXPECT_LE(distance(tipInTrocar(jointsForTip(tip)), tip), kTolerance);
}

TEST(Trocar, TheJointsBringTheTipWhereItWasWanted) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> coordinate(-0.3, 0.3);
  for (int i = 0; i < 10000; ++i) {
    const Eigen::Vector3d tip(coordinate(random), coordinate(random), coordinate(random));
    const TrocarJoints joints = jointsForTip(tip);
    EXPECT_LE(distance(tipInTrocar(joints), tip), kTolerance);
    EXPECT_LE(std::abs(joints.pitch), kPi / 2);
    EXPECT_GE(joints.insertion, 0.0);
  }
}

}  // namespace
}  // namespace organ_collision::demo
