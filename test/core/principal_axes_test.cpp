#include "core/principal_axes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <vector>

namespace organ_collision::core {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::mt19937& generator() {
  static std::mt19937 generator(1);
  return generator;
}

Vector3d normallyDistributed() {
  std::normal_distribution<double> normal;
  return Vector3d::NullaryExpr([&] { return normal(generator()); });
}

/// The corners of an octahedron of these half lengths, so that the covariance's eigenvalues are
/// their squares, twice.
std::vector<Vector3d> octahedron(const Vector3d& half_lengths, const Eigen::Quaterniond& turn) {
  std::vector<Vector3d> corners;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0})
      corners.emplace_back(turn * (side * half_lengths[axis] * Vector3d::Unit(axis)));
  return corners;
}

void expectOrthonormal(const Matrix3d& axes) {
  const Matrix3d off = axes * axes.transpose() - Matrix3d::Identity();
  EXPECT_TRUE((off.array().abs() <= 0x1p-40).all()) << axes;
}

TEST(PrincipalAxes, AreThoseOfAnEllipsoid) {
  for (int repetition = 0; repetition < 100; ++repetition) {
    const Eigen::Quaterniond turn = Eigen::Quaterniond::UnitRandom();
    const std::vector<Vector3d> points = octahedron({1, 2, 3}, turn);
    const Matrix3d axes = principalAxes(points.data(), points.size());
    expectOrthonormal(axes);
    const Matrix3d turned = axes * turn.toRotationMatrix();
    EXPECT_TRUE(turned.cwiseAbs().isIdentity(1e-9)) << turned;
  }
}

TEST(PrincipalAxes, AreAtRightAnglesWhateverTheShape) {
  std::uniform_real_distribution<double> exponent(-18.0, 0.0);
  const auto small = [&] { return std::pow(10.0, exponent(generator())); };
  for (int repetition = 0; repetition < 20'000; ++repetition) {
    const std::vector<Vector3d> shapes = {{1, 1 + small(), 1 + small()},  // nearly a ball
                                          {1, 1 + small(), small()},      // nearly a disc
                                          {1, small(), small()},          // nearly a line
                                          {1, 0, 0},
                                          {1, 1, 1},
                                          {0, 0, 0}};
    for (const Vector3d& shape : shapes) {
      for (const double size : {1.0, 1e-100, 1e-170}) {
        const Eigen::Quaterniond turn(Eigen::Vector4d(normallyDistributed().homogeneous()));
        const auto points = octahedron(
            size * shape, repetition % 2 == 0 ? turn.normalized() : Eigen::Quaterniond::Identity());
        expectOrthonormal(principalAxes(points.data(), points.size()));
      }
    }
  }
}

TEST(PrincipalAxes, OfManyPointsAreThoseOfSome) {
  std::vector<Vector3d> points(10'000);
  for (Vector3d& point : points)
    point = Vector3d(10, 0, 30) + normallyDistributed().cwiseProduct(Vector3d(1, 9, 3));
  const Matrix3d axes = principalAxes(points.data(), points.size());
  expectOrthonormal(axes);
  const Matrix3d least_first = (Matrix3d() << 1, 0, 0, 0, 0, 1, 0, 1, 0).finished();
  EXPECT_TRUE(axes.cwiseAbs().isApprox(least_first, 0.2)) << axes;
}

}  // namespace
}  // namespace organ_collision::core
