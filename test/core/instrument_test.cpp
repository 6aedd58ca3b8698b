#include "organ_collision/core/instrument.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector3d;

constexpr double kTolerance = 1e-15;  // [m] rounding of coordinates of a few metres

Eigen::Isometry3d quarterTurnAndStep() {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translate(Vector3d(1, 2, 3)).rotate(Eigen::AngleAxisd(M_PI / 2, Vector3d::UnitZ()));
  return pose;
}

RigidMesh rigidCube() {
  return {std::make_shared<const CollisionMesh>(test::cube()), Eigen::Isometry3d::Identity()};
}

TEST(Shape, MovesWithItsFrame) {
  const Eigen::Isometry3d pose = quarterTurnAndStep();
  const Vector3d x(1, 0, 0);
  const Vector3d moved_x(1, 3, 3);
  const auto near_moved_x = [&](const Vector3d& point) {
    return (point - moved_x).norm() < kTolerance;
  };
  EXPECT_TRUE(near_moved_x(std::get<Vector3d>(transformed(x, pose))));
  EXPECT_TRUE(
      near_moved_x(std::get<Triangle>(transformed(Triangle{{0, 0, 0}, x, {0, 1, 0}}, pose)).b));
  EXPECT_TRUE(near_moved_x(std::get<Sphere>(transformed(Sphere{x, 2}, pose)).centre));
  EXPECT_EQ(std::get<Sphere>(transformed(Sphere{x, 2}, pose)).radius, 2);
  const auto capsule = std::get<Capsule>(transformed(Capsule{x, {0, 0, 0}, 3}, pose));
  EXPECT_TRUE(near_moved_x(capsule.start));
  EXPECT_EQ(capsule.end, Vector3d(1, 2, 3));
  EXPECT_EQ(capsule.radius, 3);
  const auto mesh = std::get<RigidMesh>(transformed(transformed(rigidCube(), pose), pose));
  EXPECT_LT((mesh.pose * x - pose * moved_x).norm(), kTolerance);
}

TEST(Shape, StaysConvexWhenItMoves) {
  RigidMesh cube = rigidCube();
  for (const bool convex : {false, true}) {
    cube.convex = convex;
    EXPECT_EQ(std::get<RigidMesh>(transformed(cube, quarterTurnAndStep())).convex, convex);
  }
}

TEST(Shape, IsNotUsableWhereAnyNumberIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(requireUsable(Capsule{{0, 0, 0}, {0, nan, 0}, 1}), std::invalid_argument);
  EXPECT_THROW(requireUsable(Triangle{{0, 0, 0}, {1, 0, 0}, {0, nan, 0}}), std::invalid_argument);
  RigidMesh cube = rigidCube();
  cube.pose.translation().x() = nan;
  EXPECT_THROW(requireUsable(cube), std::invalid_argument);
}

TEST(Shape, IsNotUsableWhereAPoseStretchesIt) {
  RigidMesh cube = rigidCube();
  cube.pose = Eigen::Isometry3d(Eigen::Matrix4d(Eigen::Vector4d(2, 2, 2, 1).asDiagonal()));
  EXPECT_THROW(requireUsable(cube), std::invalid_argument);
}

TEST(Shape, IsUsableWithWhatIsLessThanTheLimits) {
  const auto stretched = [](double by) {
    RigidMesh cube = rigidCube();
    cube.pose.linear()(0, 0) = std::sqrt(1.0 + by);
    return cube;
  };
  EXPECT_NO_THROW(requireUsable(stretched(0.06)));
  EXPECT_THROW(requireUsable(stretched(0.065)), std::invalid_argument);
  EXPECT_NO_THROW(requireUsable(Sphere{{0, 0, 0}, 0.999e150}));
  EXPECT_THROW(requireUsable(Sphere{{0, 0, 0}, 1e150}), std::invalid_argument);
}

TEST(Shape, IsNotUsableWhereAPoseMirrorsIt) {
  RigidMesh cube = rigidCube();
  cube.pose = Eigen::Isometry3d(Eigen::Matrix4d(Eigen::Vector4d(1, -1, 1, 1).asDiagonal()));
  EXPECT_THROW(requireUsable(cube), std::invalid_argument);
}

TEST(Shape, HasABoxAroundAllOfIt) {
  const Box capsule = boxOf(Shape(Capsule{{0, 5, 0}, {1, 2, 0}, 0.5}));
  EXPECT_EQ(capsule.low, Vector3d(-0.5, 1.5, -0.5));
  EXPECT_EQ(capsule.high, Vector3d(1.5, 5.5, 0.5));
  const Box point = boxOf(Shape(Vector3d(1, 2, 3)));
  EXPECT_EQ(point.low, point.high);
  std::mt19937 generator(1);
  for (int i = 0; i < 100; ++i) {
    const auto mesh =
        std::get<RigidMesh>(transformed(rigidCube(), test::randomPose(generator, 2.0)));
    const Box box = boxOf(Shape(mesh));
    for (const Vector3d& position : mesh.surface->mesh().positions())
      EXPECT_TRUE(box.contains(mesh.pose * position));
  }
}

TEST(Shape, IsRoundUnlessItIsAMesh) {
  EXPECT_FALSE(roundShape(rigidCube()));
  EXPECT_EQ(roundShape(Sphere{{1, 2, 3}, 4})->core.c, Vector3d(1, 2, 3));
  EXPECT_EQ(roundShape(Capsule{{1, 2, 3}, {4, 5, 6}, 7})->core.c, Vector3d(4, 5, 6));
  EXPECT_EQ(roundShape(Capsule{{1, 2, 3}, {4, 5, 6}, 7})->radius, 7);
}

}  // namespace
}  // namespace organ_collision::core
