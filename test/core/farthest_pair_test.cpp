#include "organ_collision/core/farthest_pair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "every_vector_unit.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using Cloud = std::function<Eigen::Vector3d(std::mt19937&)>;

class Columns {
 public:
  explicit Columns(const Points& points) : count_(points.size()) {
    for (const Eigen::Index axis : {0, 1, 2}) {
      for (const Eigen::Vector3d& point : points) values_.push_back(point[axis]);
    }
  }
  std::size_t count() const { return count_; }
  PointColumns columns() const {
    return {values_.data(), values_.data() + count_, values_.data() + 2 * count_};
  }

 private:
  std::size_t count_;
  std::vector<double> values_;
};

FarthestPair farthestPairOf(const Points& points) {
  const Columns columns(points);
  return farthestPair(columns.columns(), columns.count());
}

/// Bit for bit, ties included.
void expectBruteForce(const Points& points) {
  const Columns columns(points);
  const FarthestPair found = farthestPair(columns.columns(), columns.count());
  const FarthestPair expected = farthestPairBruteForce(columns.columns(), columns.count());
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

class FarthestPairOnEveryVectorUnit : public test::EveryVectorUnit {};
ORGAN_COLLISION_ON_EVERY_VECTOR_UNIT(FarthestPairOnEveryVectorUnit);

TEST(FarthestPair, OfOnePointIsThatPointTwice) {
  const Points points = {{1, 2, 3}};
  const FarthestPair pair = farthestPairOf(points);
  EXPECT_EQ(pair.first, 0U);
  EXPECT_EQ(pair.second, 0U);
  EXPECT_EQ(pair.squared_distance, 0.0);
}

TEST(FarthestPair, OfASquareIsItsFirstDiagonal) {
  const Points points = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {1, 1, 0}};
  const FarthestPair pair = farthestPairOf(points);
  EXPECT_EQ(pair.first, 0U);
  EXPECT_EQ(pair.second, 3U);
  EXPECT_EQ(pair.squared_distance, 2.0);
}

TEST_P(FarthestPairOnEveryVectorUnit, EqualsBruteForceInABall) {
  expectBruteForceOn([](std::mt19937& generator) { return test::randomPoint(generator, 1.0); });
}

TEST_P(FarthestPairOnEveryVectorUnit,
       EqualsBruteForceOnASphereWhereNearlyAllPointsAreOutsideTheBall) {
  expectBruteForceOn([](std::mt19937& generator) {
    return test::randomPoint(generator, 1.0).normalized().eval();
  });
}

TEST_P(FarthestPairOnEveryVectorUnit, EqualsBruteForceOnTiesOfCubesGridsAndRings) {
  expectBruteForceOn([](std::mt19937& generator) -> Eigen::Vector3d {
    // Four diagonals tie; who is farthest outside their ball is no end of any.
    if (generator() % 5 == 0) return {0.5, 0.5, 1.375};
    if (generator() % 5 == 0) return {0.5, 0.25, 0.75};
    return Eigen::Vector3d(generator() % 2, generator() % 2, generator() % 2);
  });
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

/// What is farthest outside a ball leads to another pair that is as long as the best.
TEST(FarthestPair, OfALatticeIsNotLostToAnotherAsLongAsTheBestSoFar) {
  expectBruteForce({{0, 0, 2}, {0, 5, 4}, {1, 0, 0}, {1, 2, 3}, {1, 4, 2}, {1, 4, 3}, {1, 4, 4},
                    {1, 5, 5}, {2, 0, 0}, {2, 0, 4}, {2, 1, 4}, {2, 2, 1}, {2, 2, 3}, {2, 5, 3},
                    {3, 2, 2}, {3, 3, 2}, {3, 3, 3}, {3, 4, 2}, {3, 5, 3}, {3, 5, 4}, {4, 0, 4},
                    {4, 2, 4}, {4, 2, 5}, {4, 3, 0}, {4, 4, 0}, {4, 4, 3}, {4, 4, 4}, {4, 5, 4},
                    {5, 0, 4}, {5, 1, 4}, {5, 2, 5}, {5, 4, 3}, {5, 4, 4}});
}

TEST_P(FarthestPairOnEveryVectorUnit, EqualsBruteForceWhereRoundingBlursTies) {
  expectBruteForceOn([](std::mt19937& generator) -> Eigen::Vector3d {
    return Eigen::Vector3d(generator() % 2, 0.0, 0.0) + test::randomPoint(generator, 0x1p-51);
  });
}

TEST_P(FarthestPairOnEveryVectorUnit, EqualsBruteForceOnExponentiallySpacedPoints) {
  expectBruteForceOn([](std::mt19937& generator) {
    return Eigen::Vector3d(std::ldexp(1.0, -static_cast<int>(generator() % 200)), 0.0, 0.0);
  });
}

/// A place on the edge of the Reuleaux triangle: as far from the corner opposite as the corners are
/// from each other, whose ball leaves a third of the edge outside.
Eigen::Vector3d onReuleauxTriangle(double turn) {
  const double side = std::floor(3.0 * turn);
  const double corner = 2.0 * M_PI * side / 3.0;
  const double angle = corner + M_PI + M_PI / 3.0 * (3.0 * turn - side - 0.5);
  return {std::cos(corner) / std::sqrt(3.0) + std::cos(angle),
          std::sin(corner) / std::sqrt(3.0) + std::sin(angle), 0.0};
}

TEST_P(FarthestPairOnEveryVectorUnit,
       EqualsBruteForceAtConstantWidthWhereOtherEndsAreInsideTheBall) {
  for (const double blur : {0.0, 0x1p-50, 0.01}) {
    expectBruteForceOn([blur](std::mt19937& generator) -> Eigen::Vector3d {
      return onReuleauxTriangle(static_cast<double>(generator() % 96) / 96.0) +
             test::randomPoint(generator, blur);
    });
  }
}

TEST_P(FarthestPairOnEveryVectorUnit, EqualsBruteForceWhereCoordinatesDwarfDistances) {
  expectBruteForceOn([](std::mt19937& generator) -> Eigen::Vector3d {
    return Eigen::Vector3d(1.0, 2.0, 3.0) +
           0x1p-48 * test::randomPoint(generator, 1.0).normalized();
  });
}

TEST_P(FarthestPairOnEveryVectorUnit, EqualsBruteForceWhereSquaresUnderflow) {
  for (const double size : {0x1p-533, 0x1p-536, 0x1p-538}) {
    expectBruteForceOn([size](std::mt19937& generator) -> Eigen::Vector3d {
      return size * test::randomPoint(generator, 1.0).normalized();
    });
  }
}

TEST(FarthestPair, OfAHundredThousandPointsInTwoPlacesDoesNotComparePairs) {
  Points points(100000,
                Eigen::Vector3d::Zero());  // all pairs would take minutes: the test's time limit
  for (std::size_t i = 0; i < points.size(); i += 2) points[i].x() = 1.0;
  const FarthestPair pair = farthestPairOf(points);
  EXPECT_EQ(pair.first, 0U);
  EXPECT_EQ(pair.second, 1U);
}

TEST(FarthestPair, OfAHundredThousandPointsOnASphereDoesNotComparePairs) {
  std::mt19937 generator(7);
  Points points(100000);
  for (Eigen::Vector3d& point : points) point = test::randomPoint(generator, 1.0).normalized();
  const double distance = std::sqrt(farthestPairOf(points).squared_distance);
  EXPECT_GT(distance, 2.0 - 0x1p-20);
  EXPECT_LE(distance, 2.0 + 0x1p-50);
}

}  // namespace
}  // namespace organ_collision::core
