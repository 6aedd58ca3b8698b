#include "demo/soft_organ.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/io/mesh_io.h"
#include "test_meshes.h"

namespace organ_collision::demo {
namespace {

constexpr double kTolerance = 1e-6;  // [m] roundings of Bullet's floats, a step's worth of them
constexpr double kDepth = 0.008;     // [m] below the surface at rest
constexpr double kPush = 0.00025;    // [m] in a step: 15 mm/s
constexpr double kSinking =
    0.0015;                  // [m] of the blunt end below the vertices, between which it fits
constexpr int kSecond = 60;  // steps

const core::TriangleMesh& liver() {
  static const core::TriangleMesh kMesh = io::loadMesh(MESHES "/liver.obj");
  return kMesh;
}

/// The highest vertex of the liver: it faces up.
Eigen::Vector3d summit() {
  const core::Points& positions = liver().positions();
  return *std::max_element(positions.begin(), positions.end(),
                           [](const auto& p, const auto& q) { return p.z() < q.z(); });
}

/// The highest vertex that a dent at the summit does not reach.
Eigen::Vector3d besideTheSummit() {
  constexpr double kFar = 0.04;  // [m]
  Eigen::Vector3d highest(0, 0, -1);
  for (const Eigen::Vector3d& position : liver().positions()) {
    if (position.z() > highest.z() && (position - summit()).head<2>().norm() > kFar)
      highest = position;
  }
  return highest;
}

/// An instrument from straight above, its tip `depth` [m] below `place`, at rest.
Eigen::Isometry3d fromAbove(double depth, const Eigen::Vector3d& place = summit()) {
  Eigen::Isometry3d organ_from_tip = Eigen::Isometry3d::Identity();
  organ_from_tip.linear() = Eigen::Vector3d(1.0, -1.0, -1.0).asDiagonal();
  organ_from_tip.translation() = place - depth * Eigen::Vector3d::UnitZ();
  return organ_from_tip;
}

/// Lowers the instrument from just above the summit to `depth`; false as soon as a step says so.
bool press(SoftOrgan& organ, double depth) {
  for (double now = -0.002; now < depth; now += kPush) {
    if (!organ.step({fromAbove(now)})) return false;
  }
  return true;
}

double farthestFromRest(const SoftOrgan& organ) {
  const core::Points positions = organ.positions();
  double farthest = 0.0;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    farthest = std::max(farthest, (positions[i] - liver().positions()[i]).norm());
  }
  return farthest;
}

double signedDistance(const SoftOrgan& organ, const Eigen::Vector3d& point) {
  core::CollisionMesh mesh(liver());
  mesh.refit(organ.positions());
  return core::nearestTriangle(mesh, point).distance;
}

TEST(SoftOrgan, StaysAtRestUntouched) {
  SoftOrgan organ(liver(), 1);
  for (int i = 0; i < 5 * kSecond; ++i) {
    ASSERT_TRUE(organ.step({fromAbove(-0.05)}));
    ASSERT_LE(farthestFromRest(organ), kTolerance);
  }
}

TEST(SoftOrgan, TheSurfaceGivesWayToTheTip) {
  SoftOrgan organ(liver(), 1);
  ASSERT_TRUE(press(organ, kDepth));
  const Eigen::Vector3d tip = fromAbove(kDepth).translation();
  EXPECT_GE(farthestFromRest(organ), kDepth - SoftOrgan::kBite - kSinking);
  EXPECT_LT(signedDistance(organ, tip), 0.0);  // it touches
  EXPECT_GE(signedDistance(organ, tip), -SoftOrgan::kBite - kSinking);
}

TEST(SoftOrgan, ADentIsWiderThanTheTip) {
  SoftOrgan organ(liver(), 1);
  ASSERT_TRUE(press(organ, kDepth));
  double widest = 0.0;
  for (std::size_t i = 0; i < liver().positions().size(); ++i) {
    const Eigen::Vector3d& rest = liver().positions()[i];
    const double sunk = rest.z() - organ.positions()[i].z();
    if (sunk > 0.001) widest = std::max(widest, (rest - summit()).head<2>().norm());
  }
  EXPECT_GE(widest, 2.0 * SoftOrgan::kRadius);
}

TEST(SoftOrgan, ItsBackIsHeld) {
  SoftOrgan organ(liver(), 1);
  ASSERT_TRUE(press(organ, 2.0 * kDepth));
  const core::Points positions = organ.positions();
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Eigen::Vector3d& rest = liver().positions()[i];
    if (rest.z() < -0.03) {  // below the brim
      ASSERT_LE((positions[i] - rest).norm(), kTolerance);
    }
  }
}

TEST(SoftOrgan, ReleasedItReturnsToItsShape) {
  SoftOrgan organ(liver(), 1);
  ASSERT_TRUE(press(organ, kDepth));
  for (int i = 0; i < 4 * kSecond; ++i) ASSERT_TRUE(organ.step({std::nullopt}));
  EXPECT_LE(farthestFromRest(organ), kTolerance);
}

TEST(SoftOrgan, EachInstrumentPresses) {
  SoftOrgan organ(liver(), 2);
  for (double now = -0.002; now < kDepth; now += kPush)
    ASSERT_TRUE(organ.step({fromAbove(now, besideTheSummit()), fromAbove(now)}));
  const core::Points& rest = liver().positions();
  for (const Eigen::Vector3d& place : {besideTheSummit(), summit()}) {
    const auto vertex = std::find(rest.begin(), rest.end(), place) - rest.begin();
    const Eigen::Vector3d now = organ.positions()[static_cast<std::size_t>(vertex)];
    EXPECT_GE((now - place).norm(), 0.5 * kDepth);
  }
}

TEST(SoftOrgan, RefusesMoreVerticesThanBulletCanTake) {
  const core::TriangleMesh fine = test::subdivided(test::subdivided(liver()));
  EXPECT_THAT([&] { SoftOrgan(fine, 1); },
              testing::ThrowsMessage<std::invalid_argument>(
                  testing::HasSubstr(std::to_string(fine.positions().size()))));
}

TEST(SoftOrgan, TornApartItIsPutBackToRestAndIsSoftAgain) {
  // Jumps within a step: the one throws vertices far away, the other makes NaNs of them.
  for (const double distance : {1e10, 1e30}) {  // [m]
    SoftOrgan organ(liver(), 1);
    Eigen::Isometry3d far_away = fromAbove(kDepth);
    far_away.translation().x() = distance;
    ASSERT_TRUE(organ.step({far_away}));
    ASSERT_FALSE(organ.step({fromAbove(kDepth)}));
    EXPECT_LE(farthestFromRest(organ), kTolerance);
    ASSERT_TRUE(organ.step({std::nullopt}));
    ASSERT_TRUE(press(organ, kDepth));
    EXPECT_GE(farthestFromRest(organ), kDepth - SoftOrgan::kBite - kSinking);
  }
}

TEST(SoftOrgan, ViolentPushesLeaveItFiniteAndNearItsRest) {
  SoftOrgan organ(liver(), 1);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> jump(-0.1, 0.1);  // [m]
  double farthest = 0.0;
  for (int i = 0; i < 5 * kSecond; ++i) {
    Eigen::Isometry3d organ_from_tip = fromAbove(0.05);
    organ_from_tip.translation() += Eigen::Vector3d(jump(random), jump(random), jump(random));
    organ.step({organ_from_tip});
    const core::Points positions = organ.positions();
    ASSERT_TRUE(std::all_of(positions.begin(), positions.end(),
                            [](const auto& position) { return position.allFinite(); }));
    ASSERT_LE(farthestFromRest(organ), SoftOrgan::kFarthest);
    farthest = std::max(farthest, farthestFromRest(organ));
  }
  EXPECT_GE(farthest, kDepth);  // else they were not violent
}

TEST(SoftOrgan, IsTheSameInTwoRuns) {
  SoftOrgan first(liver(), 1), second(liver(), 1);
  press(first, kDepth);
  press(second, kDepth);
  EXPECT_EQ(first.positions(), second.positions());
}

TEST(SoftOrgan, RefusesAVertexThatIsInNoTriangle) {
  const core::Points positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const core::TriangleMesh mesh(positions,
                                {{core::VertexId{0}, core::VertexId{1}, core::VertexId{3}}});
  EXPECT_THAT([&] { SoftOrgan(mesh, 0); },
              testing::ThrowsMessage<std::invalid_argument>("vertex 2 is in no triangle"));
}

TEST(SoftOrgan, RefusesWhatBulletCannotHoldAtRest) {
  const core::TriangleMesh flat = io::loadMesh(MESHES "/grid.obj");
  const core::TriangleMesh far = test::placed(test::blob(2), 1.0, {1e20, 0, 0});
  for (const core::TriangleMesh& mesh : {flat, far})
    EXPECT_THAT([&] { SoftOrgan(mesh, 1); }, testing::ThrowsMessage<std::invalid_argument>(
                                                 testing::HasSubstr("does not stay at rest")));
}

}  // namespace
}  // namespace organ_collision::demo
