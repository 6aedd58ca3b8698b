// Hulls that GJK and EPA find hard: flat ones, points, slivers, several ways out that are as short.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "convex/tool_proximity.h"
#include "convex_shapes.h"
#include "core/organs_and_tips.h"
#include "test_meshes.h"

namespace organ_collision::convex {
namespace {

using core::Capsule;
using core::CollisionMesh;
using core::Points;
using core::Proximity;
using core::RigidMesh;
using core::Shape;
using core::Sphere;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::queryCount;

/// Some points of a plane, the first in the middle.
RigidMesh polygon(std::mt19937& generator, const Isometry3d& pose, std::size_t count) {
  Points points = {Vector3d::Zero()};
  std::vector<core::Corners> triangles;
  for (std::size_t i = 1; i <= count; ++i) {
    points.push_back(0.5 * test::randomPoint(generator, 1.0).cwiseProduct(Vector3d(1, 1, 0)));
    triangles.push_back(test::corners(0, i, i % count + 1));
  }
  return {std::make_shared<const CollisionMesh>(core::TriangleMesh(points, triangles)), pose, true};
}

TEST(HardHulls, OfPolygonsInOnePlaneIsThatTheyTouch) {
  std::mt19937 generator(99);
  for (std::size_t i = 0; i < queryCount(1000); ++i) {
    const Isometry3d pose = test::randomPose(generator, 0.5);
    const Isometry3d aside = pose * Eigen::Translation3d(0.25, 0, 0);
    const RigidMesh first = polygon(generator, pose, 3 + generator() % 18);
    const RigidMesh second = polygon(generator, aside, 3 + generator() % 18);
    const Proximity found = hullProximity(first, second);
    ASSERT_GE(found.distance, -kTight);
    ASSERT_LE(found.distance, core::proximity(first, second).distance + kTight);
    ASSERT_NEAR((found.point_on_second - found.point_on_first).norm(), found.distance, kTight);
    const Proximity same = hullProximity(first, polygon(generator, pose, 3 + generator() % 18));
    ASSERT_NEAR(same.lower_bound, 0.0, kTight);  // the middles meet
    ASSERT_NEAR(same.upper_bound, 0.0, kTight);
    ASSERT_NEAR((same.point_on_second - same.point_on_first).norm(), 0.0, kTight);
  }
}

TEST(HardHulls, OfWhatHasNoSizeThatHasAnInverseIsANumber) {
  const double tiny = std::numeric_limits<double>::denorm_min();
  const core::TriangleMesh point({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}, {test::corners(0, 1, 2)});
  const RigidMesh mesh{std::make_shared<const CollisionMesh>(point), Isometry3d::Identity(), true};
  const Proximity found =
      hullProximity(core::Triangle{{tiny, 0, 0}, {0, tiny, 0}, {0, 0, tiny}}, mesh);
  EXPECT_NEAR(found.distance, 0.0, kTight);
  EXPECT_NEAR(found.lower_bound, 0.0, kTight);
  EXPECT_TRUE(found.point_on_first.allFinite() && found.point_on_second.allFinite());
}

TEST(HardHulls, OfFlatHullsInOnePlaneIsThatTheyTouch) {
  std::mt19937 generator(98);
  const auto flat = [](const Isometry3d& pose, const Vector3d& corner) {
    const core::TriangleMesh mesh({{0, 0, 0}, {1, 0, 0}, corner}, {test::corners(0, 1, 2)});
    return RigidMesh{std::make_shared<const CollisionMesh>(mesh), pose, true};
  };
  for (std::size_t i = 0; i < queryCount(200); ++i) {
    const Isometry3d pose = test::randomPose(generator, 0.5);
    for (const Vector3d& corner : {Vector3d(0, 1, 0), Vector3d(0.5, 0, 0), Vector3d(0, 0, 0)}) {
      for (const Shape& other :
           {Shape(flat(pose, {0.25, 0.5, 0})), Shape(Sphere{pose * Vector3d(0, 0, 0), 0}),
            Shape(Capsule{pose * Vector3d(-1, 0, 0), pose * Vector3d(1, 0, 0), 0})}) {
        const Proximity found = hullProximity(flat(pose, corner), other);
        ASSERT_NEAR(found.lower_bound, 0.0, kTight);
        ASSERT_NEAR(found.upper_bound, 0.0, kTight);
      }
    }
  }
}

RigidMesh hullOf(const Points& points) {
  std::vector<core::Corners> triangles;
  for (unsigned i = 2; i < points.size(); ++i) triangles.push_back(test::corners(0, i - 1, i));
  return {std::make_shared<const CollisionMesh>(core::TriangleMesh(points, triangles)),
          Isometry3d::Identity(), true};
}

/// EPA may come to an end at one of them, and take the points from another.
TEST(HardHulls, OfSeveralWaysOutAsShortTellsOneWithItsPoints) {
  const RigidMesh one = hullOf({{1, 1, 0}, {2, 0, 1}, {1, 1, 1}, {1, 0, 1}});
  const RigidMesh other = hullOf({{0, 0, 1}, {2, 0, 1}, {2, 1, 2}, {2, 2, 1}});
  for (const RigidMesh& mesh : {one, other}) {
    const Proximity found = hullProximity(mesh, mesh);
    EXPECT_NEAR(found.lower_bound, found.upper_bound, kTight);
    EXPECT_NEAR(
        (found.point_on_second - found.point_on_first - found.distance * found.normal).norm(), 0.0,
        kTight);
  }
  EXPECT_NEAR(hullProximity(one, one).distance, -std::sqrt(1.0 / 3.0), kTight);
}

/// Its gap is higher by a rounding along a normal whose points are any corners.
TEST(HardHulls, OfASpeckBesideANeedleTellsPointsThatAreNear) {
  const RigidMesh needle = hullOf({{1, 2, 2}, {1, 0, 2}, {1, 1, 2}});
  const Vector3d speck(0.99999980541882461, 1.0000007042327332, 2.0000008122741755);
  const Vector3d end(0.999999122823931, 0.99999989627568187, 1.999999546148536);
  const Proximity found = hullProximity(needle, hullOf({speck, end, speck}));
  EXPECT_NEAR((found.point_on_second - found.point_on_first).norm(), found.distance, kTight);
  EXPECT_NEAR((found.point_on_first - Vector3d(1, 1, 2)).norm(), 0.0, 1e-5);
}

Isometry3d posed(const Eigen::Matrix<double, 3, 4>& rows) {
  Isometry3d pose = Isometry3d::Identity();
  pose.matrix().topRows<3>() = rows;
  return pose;
}

/// Of a hundred thousand random pairs those for which FCL's GJK and its EPA ended too early.
TEST(HardHulls, IsProvenWhereGjkAndEpaEndTooEarly) {
  Eigen::Matrix<double, 3, 4> first;
  first << -0.23914759348103798, 0.3166256288477603, 0.91790884062034661, -0.28621546931968611,
      0.9708923176991886, 0.065039990793976599, 0.23051660901162385, -0.49576562475062175,
      0.013286683744501926, 0.94631813400900244, -0.32296354791337306, 0.13764815501427308;
  Eigen::Matrix<double, 3, 4> second;
  second << -0.057851523840735664, 0.89233280931477543, 0.44765540163132778, -0.15895694156982604,
      0.51043224646793217, 0.41180297111786379, -0.75490213587206134, 0.025696316443356459,
      -0.85796976808918213, 0.1848255133873582, -0.47929886985689263, -0.16962131419822163;
  Eigen::Matrix<double, 3, 4> third;
  third << 0.97552888639128754, 0.020101838903566278, -0.21895046903094223, -0.055933007837591642,
      -0.027238084016208298, 0.99918995253680321, -0.029623057381487329, 0.47829317679353167,
      0.21817763083162423, 0.034861939449720554, 0.97528619726852672, -0.27827742789039811;
  const Capsule through{{-0.041658367850324896, 0.45287476391606052, -0.31066301461764434},
                        {0.13950724686418486, 0.31072036448364032, -0.2133431976885023},
                        0.0625};
  const std::vector<std::pair<Shape, Shape>> pairs = {
      {cylinder(0.125, 0.5, posed(first)), cylinder(0.125, 0.5, posed(second))},
      {through, box({0.25, 0.125, 0.0625}, posed(third))}};
  for (const auto& [one, other] : pairs) {
    for (const auto& found : {hullProximity(one, other), hullProximity(other, one)}) {
      EXPECT_NEAR(found.lower_bound, found.upper_bound, kGjk);
    }
  }
}

/// GJK ends at three of the five corners of that face, 32 times.
TEST(HardHulls, OfAFaceWithManyCornersTellsThePointAboveNone) {
  const RigidMesh hull =
      hullOf({{-1, 1, 0}, {-1, 0, 0}, {1, 1, 0}, {1, 0, -1}, {0, -1, 0}, {1, -1, -1}, {1, 0, 0}});
  const Sphere ball{{-0.44711273183090672, -0.43220935083161843, 0.12500000071238737}, 0.125};
  for (const Proximity& found : {hullProximity(hull, ball), hullProximity(ball, hull)}) {
    EXPECT_NEAR(found.distance, 7.1238737e-10, 1e-15);
    EXPECT_NEAR((found.point_on_second - found.point_on_first).norm(), found.distance, kTight);
  }
}

/// As thin as rounding, or flat, or on a line, the one of any smaller size, near the other or
/// touching it.
TEST(HardHulls, OfThinAndSmallHullsTellsOneDistanceAndItsPoints) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> any(-0.5, 0.5), exponent(-10.0, 0.0);
  const auto thin = [&](double size) {
    const double height = std::array<double, 4>{0.0, 1e-13, 1e-9, 1.0}[generator() % 4];
    const double width = generator() % 3 == 0 ? height : 1.0;
    Points points(3 + generator() % 6);
    for (Vector3d& point : points) {
      for (const int axis : {0, 1, 2}) point[axis] = size * any(generator);
      point = point.cwiseProduct(Vector3d(1.0, width, height));
    }
    return points;
  };
  for (std::size_t i = 0; i < queryCount(4000); ++i) {
    const Points first = thin(1.0);
    Points second = thin(std::pow(10.0, exponent(generator)));
    const Vector3d aside = 0.2 * Vector3d(any(generator), any(generator), 0.0);
    const Vector3d touching = first.front() - second.front();
    for (Vector3d& point : second) point += i % 2 == 0 ? aside : touching;
    for (const Proximity& found : {hullProximity(hullOf(first), hullOf(second)),
                                   hullProximity(hullOf(second), hullOf(first))}) {
      ASSERT_NEAR(found.lower_bound, found.upper_bound, kGjk) << i;
      ASSERT_NEAR((found.point_on_second - found.point_on_first).norm(), std::abs(found.distance),
                  kGjk)
          << i;
    }
  }
}

}  // namespace
}  // namespace organ_collision::convex
