#include "organ_collision/core/farthest_pair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using Cloud = std::function<Eigen::Vector3d(std::mt19937&)>;

/// Bit for bit, ties included.
void expectBruteForce(const Points& points) {
  const FarthestPair found = farthestPair(points.data(), points.size());
  const FarthestPair expected = farthestPairBruteForce(points.data(), points.size());
  ASSERT_EQ(found.squared_distance, expected.squared_distance) << points.size() << " points";
  ASSERT_EQ(found.first, expected.first) << points.size() << " points";
  ASSERT_EQ(found.second, expected.second) << points.size() << " points";
}

void expectBruteForceOn(const Cloud& cloud) {
  std::mt19937 generator(7);
  for (int i = 0; i < 300; ++i) {
    Points points(1 + generator() % 600);
    for (Eigen::Vector3d& point : points) point = cloud(generator);
    expectBruteForce(points);
  }
}

TEST(FarthestPair, OfOnePointIsThatPointTwice) {
  const Points points = {{1, 2, 3}};
  const FarthestPair pair = farthestPair(points.data(), 1);
  EXPECT_EQ(pair.first, 0U);
  EXPECT_EQ(pair.second, 0U);
  EXPECT_EQ(pair.squared_distance, 0.0);
}

TEST(FarthestPair, OfASquareIsItsFirstDiagonal) {
  const Points points = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}};
  const FarthestPair pair = farthestPair(points.data(), points.size());
  EXPECT_EQ(pair.first, 0U);
  EXPECT_EQ(pair.second, 3U);
  EXPECT_EQ(pair.squared_distance, 2.0);
}

TEST(FarthestPair, EqualsBruteForceInABall) {
  expectBruteForceOn([](std::mt19937& generator) { return test::randomPoint(generator, 1.0); });
}

TEST(FarthestPair, EqualsBruteForceOnASphereWhereNearlyAllPointsAreOutsideTheBall) {
  expectBruteForceOn([](std::mt19937& generator) {
    return test::randomPoint(generator, 1.0).normalized().eval();
  });
}

TEST(FarthestPair, EqualsBruteForceOnTiesOfGridsAndRings) {
  expectBruteForceOn([](std::mt19937& generator) {
    return Eigen::Vector3d(generator() % 5, generator() % 5, 0.0);
  });
  expectBruteForceOn(
      [](std::mt19937& generator) { return Eigen::Vector3d(generator() % 2, 0.0, 0.0); });
  expectBruteForceOn([](std::mt19937& generator) {
    const double angle = M_PI * static_cast<double>(generator() % 36) / 18.0;
    return Eigen::Vector3d(std::cos(angle), std::sin(angle), 0.0);
  });
}

TEST(FarthestPair, EqualsBruteForceWhereRoundingBlursTies) {
  expectBruteForceOn([](std::mt19937& generator) -> Eigen::Vector3d {
    return Eigen::Vector3d(generator() % 2, 0.0, 0.0) + test::randomPoint(generator, 0x1p-51);
  });
}

TEST(FarthestPair, EqualsBruteForceOnExponentiallySpacedPoints) {
  expectBruteForceOn([](std::mt19937& generator) {
    return Eigen::Vector3d(std::ldexp(1.0, -static_cast<int>(generator() % 200)), 0.0, 0.0);
  });
}

TEST(FarthestPair, OfAHundredThousandPointsInTwoPlacesDoesNotComparePairs) {
  Points points(100000,
                Eigen::Vector3d::Zero());  // all pairs would take minutes: the test's time limit
  for (std::size_t i = 0; i < points.size(); i += 2) points[i].x() = 1.0;
  const FarthestPair pair = farthestPair(points.data(), points.size());
  EXPECT_EQ(pair.first, 0U);
  EXPECT_EQ(pair.second, 1U);
}

}  // namespace
}  // namespace organ_collision::core
