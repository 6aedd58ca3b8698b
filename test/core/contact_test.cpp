#include "organ_collision/core/contact.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector3d;

Triangle tipAt(const Eigen::Vector3d& corner) {
  return {corner, corner + Eigen::Vector3d(0.1, 0, 0), corner + Eigen::Vector3d(0, 0.1, 0)};
}

TEST(Contact, OfAPointCollidesInsideAndOnTheSurfaceOfASolid) {
  const CollisionMesh cube(test::cube());
  for (const double z : {0.5, 0.0, 1.0}) {
    const Contact touching = contact(cube, Eigen::Vector3d(0.5, 0.5, z));
    EXPECT_TRUE(touching.colliding);
    EXPECT_TRUE(touching.colliding_certain);
  }
  const Contact apart = contact(cube, Eigen::Vector3d(0.5, 0.5, 1.0 + 1e-9));
  EXPECT_FALSE(apart.colliding);
  EXPECT_TRUE(apart.colliding_certain);
}

TEST(Contact, OfATriangleCollidesWhenItCrossesTouchesOrIsInside) {
  const CollisionMesh cube(test::cube());
  EXPECT_TRUE(contact(cube, tipAt({0.5, 0.5, 0.5})).colliding);  // wholly inside
  EXPECT_LT(contact(cube, tipAt({0.5, 0.5, 0.5})).nearest.distance, 0.0);
  EXPECT_TRUE(contact(cube, tipAt({0.95, 0.5, 0.5})).colliding);  // through a face
  EXPECT_TRUE(contact(cube, tipAt({0.5, 0.5, 1.0})).colliding);   // flat on a face
  EXPECT_TRUE(contact(cube, tipAt({1.0, 1.0, 1.0})).colliding);   // by a vertex
  const Contact apart = contact(cube, tipAt({0.5, 0.5, 1.5}));
  EXPECT_FALSE(apart.colliding);
  EXPECT_EQ(apart.nearest.distance, 0.5);
}

TEST(Contact, WithAnOpenSurfaceIsTouchingIt) {
  const CollisionMesh grid(test::grid(4, 4));
  EXPECT_TRUE(contact(grid, Eigen::Vector3d(1.3, 2.2, 0.0)).colliding);
  const Contact below = contact(grid, Eigen::Vector3d(1.3, 2.2, -0.5));
  EXPECT_FALSE(below.colliding);
  EXPECT_TRUE(below.colliding_certain);
}

TEST(Contact, IsUncertainWhereTheAccuracyDoesNotDecideIt) {
  const CollisionMesh organ(test::blob(4));
  const Contact greedy = contact(organ, Eigen::Vector3d(0, 0, 0), Accuracy::greedy());
  EXPECT_FALSE(greedy.colliding);
  EXPECT_FALSE(greedy.colliding_certain);
  EXPECT_TRUE(contact(organ, Eigen::Vector3d(1, 1, 1), Accuracy::greedy()).colliding_certain);
  EXPECT_TRUE(contact(organ, Eigen::Vector3d(0, 0, 0)).colliding_certain);
}

// What follows is said of the cube [0, 1]^3 and can be checked by hand.

TEST(Contact, OfASphereIsThatOfItsCentreLessTheRadius) {
  const CollisionMesh cube(test::cube());
  const Contact apart = contact(cube, Sphere{{0.5, 0.5, 3.0}, 0.5});
  EXPECT_EQ(apart.nearest.distance, 1.5);
  EXPECT_EQ(apart.nearest.tip_point, Vector3d(0.5, 0.5, 2.5));
  EXPECT_FALSE(apart.colliding);
  const Contact touching = contact(cube, Sphere{{0.5, 0.5, 1.5}, 0.5});
  EXPECT_EQ(touching.nearest.distance, 0.0);
  EXPECT_TRUE(touching.colliding);
  const Contact crossing = contact(cube, Sphere{{0.5, 0.5, 1.25}, 0.5});
  EXPECT_EQ(crossing.nearest.distance, -0.25);
  EXPECT_EQ(crossing.nearest.tip_point, Vector3d(0.5, 0.5, 0.75));
  const Contact deep = contact(cube, Sphere{{0.5, 0.5, 0.75}, 0.5});
  EXPECT_EQ(deep.nearest.distance, -0.75);
  EXPECT_EQ(deep.nearest.tip_point, Vector3d(0.5, 0.5, 0.25));
  EXPECT_TRUE(deep.colliding_certain);
}

TEST(Contact, OfASphereWhoseCentreIsOnTheSurfaceIsDeepestInside) {
  const CollisionMesh cube(test::cube());
  const Contact crossing = contact(cube, Sphere{{0.5, 0.5, 1.0}, 0.5});
  EXPECT_EQ(crossing.nearest.distance, -0.5);
  EXPECT_EQ(crossing.nearest.tip_point, Vector3d(0.5, 0.5, 0.5));
}

TEST(Contact, OfACapsuleIsThatOfItsAxisLessTheRadius) {
  const CollisionMesh cube(test::cube());
  const Contact beside = contact(cube, Capsule{{2.0, 0.5, -5.0}, {2.0, 0.5, 5.0}, 0.25});
  EXPECT_EQ(beside.nearest.distance, 0.75);
  EXPECT_EQ(beside.nearest.tip_point.x(), 1.75);
  const Contact above = contact(cube, Capsule{{0.5, 0.5, 1.5}, {0.5, 0.5, 9.0}, 0.25});
  EXPECT_EQ(above.nearest.distance, 0.25);
  EXPECT_EQ(above.nearest.tip_point, Vector3d(0.5, 0.5, 1.25));
  const Contact inside = contact(cube, Capsule{{0.5, 0.5, 0.25}, {0.5, 0.5, 0.875}, 0.125});
  EXPECT_EQ(inside.nearest.distance, -0.25);
  EXPECT_EQ(inside.nearest.tip_point.z(), 0.875);  // the end towards the surface; beside it
  EXPECT_NEAR((inside.nearest.tip_point - Vector3d(0.5, 0.5, 0.875)).norm(), 0.125, 1e-15);
}

TEST(Contact, OfACapsuleWhoseAxisCrossesTheSurfaceIsMinusItsRadius) {
  const CollisionMesh cube(test::cube());
  const Capsule through{{0.5, 0.5, 0.5}, {0.5, 0.5, 1.5}, 0.25};  // perpendicular to the face
  const Contact crossing = contact(cube, through);
  EXPECT_EQ(crossing.nearest.distance, -0.25);
  EXPECT_TRUE(crossing.colliding_certain);
  EXPECT_EQ(crossing.nearest.tip_point.z(), 1.0);
  EXPECT_NEAR((crossing.nearest.tip_point - Vector3d(0.5, 0.5, 1.0)).norm(), 0.25, 1e-15);
}

TEST(Contact, OfARoundShapeWithAnOpenSurfaceIsTouchingIt) {
  const CollisionMesh grid(test::grid(4, 4));
  const Contact below = contact(grid, Sphere{{1.3, 2.2, -0.5}, 0.25});
  EXPECT_FALSE(below.colliding);
  EXPECT_TRUE(below.colliding_certain);
  EXPECT_TRUE(contact(grid, Sphere{{1.3, 2.2, -0.5}, 0.5}).colliding);
  const Contact pierced = contact(grid, Sphere{{1.3, 2.2, -0.25}, 1.0});
  EXPECT_TRUE(pierced.colliding);
  EXPECT_TRUE(pierced.colliding_certain);
  EXPECT_EQ(pierced.nearest.distance, 0.0);  // no sign, no depth; that is between the points
  EXPECT_EQ(pierced.nearest.lower_bound, 0.0);
  EXPECT_EQ(pierced.nearest.upper_bound, 0.0);
  EXPECT_EQ(pierced.nearest.tip_point.z(), 0.75);
}

TEST(Contact, WithoutASignIsNeverBelowZero) {
  const CollisionMesh organ(test::blob(4));
  const Contact greedy = contact(organ, Sphere{{0, 0, 0}, 1.0}, Accuracy::greedy());
  EXPECT_FALSE(greedy.nearest.distance_signed);
  EXPECT_TRUE(greedy.colliding);
  EXPECT_EQ(greedy.nearest.distance, 0.0);
  EXPECT_TRUE(greedy.nearest.isExact());
}

TEST(Contact, OfAMeshAroundAnOpenSurfaceHasNoSignButCollides) {
  const CollisionMesh grid(test::grid(1, 1));
  const auto around = [](double half) {
    Points points = test::cube(2 * half).positions();
    for (Eigen::Vector3d& point : points) point += Eigen::Vector3d(1.5 - half, 1.5 - half, -half);
    return RigidMesh{
        std::make_shared<const CollisionMesh>(TriangleMesh(points, test::cube().triangles())),
        Eigen::Isometry3d::Identity(), false};
  };
  const Contact within = contact(grid, around(4));
  EXPECT_FALSE(within.nearest.distance_signed);
  EXPECT_EQ(within.nearest.distance, 0.0);
  EXPECT_TRUE(within.nearest.isExact());
  EXPECT_TRUE(within.colliding);
  const Contact crossing = contact(grid, around(1));
  EXPECT_FALSE(crossing.nearest.distance_signed);
  EXPECT_TRUE(crossing.colliding);
  const Sphere beside{{2, 2, 0.75}, 0.5};
  const Contact both =
      contact(grid, Shapes{around(4), beside}, Eigen::Isometry3d::Identity(), Accuracy::exact());
  EXPECT_EQ(both.nearest.distance, 0.0);
  EXPECT_TRUE(both.colliding);
}

TEST(Contact, OfASphereLooksAtNoMoreThanTheAccuracyAsksFor) {
  std::mt19937 generator(84);
  const CollisionMesh organ(test::blob(5));
  int spent = 0, again = 0;
  for (int i = 0; i < 300; ++i) {
    const Vector3d centre = 0.3 * test::randomPoint(generator, 1.0).normalized();
    const auto triangles_of_core = [&](const Accuracy& accuracy) {
      return nearestTriangle(organ, centre, accuracy).work.triangles;
    };
    const auto triangles_within = [&](double radius, const Accuracy& accuracy) {
      return contact(organ, Sphere{centre, radius}, accuracy).nearest.work.triangles;
    };
    const double nearly_touching = 0.999 * nearestTriangle(organ, centre).distance;
    const Accuracy few = {1e-6, 0.0, 4};
    if (triangles_of_core(few) >= few.max_leaves) {
      EXPECT_EQ(triangles_within(nearly_touching, few), triangles_of_core(few));
      ++spent;
    }
    const Accuracy rough = {0.5, 0.0, 0};
    EXPECT_EQ(triangles_within(0.3, rough), triangles_of_core(rough)) << "it meets the organ";
    const Accuracy absolute = {0.5, 0.01, 0};
    const NearestTriangle first = nearestTriangle(organ, centre, absolute);
    if (first.upper_bound - first.lower_bound > 0.01 && first.upper_bound > nearly_touching) {
      EXPECT_EQ(triangles_within(nearly_touching, absolute),
                triangles_of_core(absolute) + triangles_of_core({0.0, 0.01, 0}));
      ++again;
    }
  }
  EXPECT_GT(spent, 20);
  EXPECT_GT(again, 20);
}

TEST(Contact, OfABallAroundTheWholeOrganIsACollision) {
  const CollisionMesh cube(test::cube());
  const Contact around = contact(cube, Sphere{{0.5, 0.5, 1.5}, 10.0});
  EXPECT_EQ(around.nearest.distance, 0.5 - 10.0);
  EXPECT_TRUE(around.colliding_certain);
}

TEST(Contact, OfATriangleThatPiercesElsewhereIsUncertainWhereTheSearchStoppedEarly) {
  const CollisionMesh organ(test::blob(4));
  // One corner far outside, so that the greedy answer's point is outside the organ's box.
  const Triangle spear{{0.0, 0.0, 0.01}, {0.001, 0.0, 0.01}, {0.9, 0.9, 0.9}};
  const Contact greedy = contact(organ, spear, Accuracy::greedy());
  EXPECT_TRUE(greedy.colliding || !greedy.colliding_certain);
  EXPECT_TRUE(contact(organ, spear).colliding);
}

TEST(Contact, RefusesShapesThatAreNotUsable) {
  const CollisionMesh cube(test::cube());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(
      [&] {
        contact(cube, Sphere{{0, 0, 0}, -1e-9});
      },
      testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("is -1e-09:")));
  EXPECT_THROW(contact(cube, Sphere{{0, 0, 0}, nan}), std::invalid_argument);
  EXPECT_THROW(contact(cube, Sphere{{0, nan, 0}, 1}), std::invalid_argument);
  EXPECT_THROW(contact(cube, Capsule{{0, 0, 0}, {0, 0, nan}, 1}), std::invalid_argument);
  EXPECT_THROW(contact(cube, Capsule{{0, 0, 0}, {0, 0, 1}, 1e200}), std::invalid_argument);
  EXPECT_THROW(contact(cube, RigidMesh{nullptr, Eigen::Isometry3d::Identity()}),
               std::invalid_argument);
}

TEST(ContactTracker, FollowsAllPiecesAsIfItAskedAnew) {
  const CollisionMesh organ(test::blob(4));
  const Shapes shapes = {Vector3d(0, 0, 0.02), Sphere{{0, 0, 0.01}, 0.01},
                         Capsule{{0, 0, 0}, {0, 0, 0.2}, 0.004}, tipAt({0, 0.01, 0}),
                         RigidMesh{std::make_shared<const CollisionMesh>(test::cube(0.01)),
                                   Eigen::Isometry3d(Eigen::Translation3d(0, 0.02, 0))}};
  ContactTracker tracker;
  std::mt19937 generator(35);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  for (int i = 0; i < 300; ++i) {
    pose = pose * test::randomPose(generator, 0.0);
    pose.translation() += test::randomPoint(generator, i % 50 == 0 ? 0.1 : 0.001);
    for (const Accuracy& accuracy : {Accuracy::exact(), Accuracy::greedy()}) {
      const Contact tracked = tracker.contact(organ, 0.0, shapes, pose, accuracy);
      const Contact asked = contact(organ, shapes, pose, accuracy);
      ASSERT_EQ(tracked.nearest.distance, asked.nearest.distance);
      ASSERT_EQ(tracked.nearest.lower_bound, asked.nearest.lower_bound);
      ASSERT_EQ(tracked.nearest.triangle, asked.nearest.triangle);
      ASSERT_EQ(tracked.colliding, asked.colliding);
      ASSERT_EQ(tracked.colliding_certain, asked.colliding_certain);
    }
  }
}

TEST(ContactTracker, RefusesAnAccuracyBelowZero) {
  const CollisionMesh cube(test::cube());
  EXPECT_THROW(ContactTracker().contact(cube, 0.0, {Vector3d(0, 0, 3)},
                                        Eigen::Isometry3d::Identity(), {0, -1.0, 0}),
               std::invalid_argument);
}

TEST(Contact, OfSeveralPiecesIsThatOfTheNearest) {
  const CollisionMesh cube(test::cube());
  const Eigen::Isometry3d up(Eigen::Translation3d(0, 0, 2));
  const Shapes shapes = {Sphere{{0.5, 0.5, 3.0}, 0.5}, Vector3d(0.5, 0.5, 0.25),
                         Capsule{{5, 0, 0}, {5, 0, 1}, 1.0}};
  const Contact whole = contact(cube, shapes, up);
  EXPECT_EQ(whole.nearest.distance, 1.25);
  EXPECT_EQ(whole.nearest.tip_point, Vector3d(0.5, 0.5, 2.25));
  EXPECT_TRUE(whole.nearest.isExact());
  EXPECT_TRUE(whole.colliding_certain);
  EXPECT_GT(whole.nearest.work.triangles, contact(cube, shapes[1]).nearest.work.triangles);
  EXPECT_TRUE(contact(cube, shapes, Eigen::Isometry3d::Identity()).colliding);
}

TEST(Contact, OfSeveralPiecesTellsTheDepthThatIsProvenWhereAnotherMayBeDeeper) {
  const CollisionMesh organ(test::blob(4));
  const Shape shallow = Vector3d(0, 0, 0.04);
  const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
  for (const Shape& deep : {Shape(Vector3d(0.01, 0, 0)), Shape(Sphere{{0.01, 0, 0}, 0.03}),
                            Shape(Sphere{{0, 0.001, 0.002}, 0.2})}) {
    const double exact = contact(organ, {shallow, deep}, here).nearest.distance;
    std::size_t open = 0;
    for (std::uint32_t leaves = 1; leaves < 1000; ++leaves) {
      const Accuracy accuracy{0, 0, leaves};
      if (!contact(organ, shallow, accuracy).nearest.distance_signed) continue;
      if (contact(organ, deep, accuracy).nearest.distance_signed) continue;
      ++open;
      const NearestTriangle nearest = contact(organ, {shallow, deep}, here, accuracy).nearest;
      EXPECT_TRUE(nearest.distance_signed);
      EXPECT_TRUE(std::isfinite(nearest.lower_bound));
      EXPECT_LE(nearest.lower_bound, exact);
      EXPECT_GE(nearest.upper_bound, exact);
      EXPECT_EQ(nearest.distance, nearest.upper_bound);
    }
    EXPECT_GT(open, 0U);
  }
}

TEST(Contact, OfSeveralPiecesTellsOneOfItsBoundsWhereTheSearchStoppedEarly) {
  std::mt19937 generator(83);
  const CollisionMesh organ(test::blob(5));
  const auto ball =
      std::make_shared<const CollisionMesh>(test::placed(test::blob(3), 0.02, {0, 0, 0}));
  const auto direction = [&] { return test::randomPoint(generator, 1.0).normalized(); };
  int deeper = 0;
  for (int i = 0; i < 3000; ++i) {
    const Accuracy accuracy = {0.0, 0.0, i % 2 == 0 ? 4U : 16U};
    RigidMesh inside = {ball, Eigen::Isometry3d::Identity()};
    const NearestTriangle surface = nearestTriangle(organ, direction());
    inside.pose.translation() = surface.closest.point - (0.01 + 1e-5 * i) * surface.normal;
    const Eigen::Vector3d centre = (0.13 + 1.6e-4 * i) * direction();
    const NearestTriangle outside = nearestTriangle(organ, centre, accuracy);
    if (outside.distance <= 1e-5) continue;
    const Shapes pieces = {inside, Sphere{centre, outside.distance - 1e-5}};
    const Eigen::Isometry3d here = Eigen::Isometry3d::Identity();
    const NearestTriangle found = contact(organ, pieces, here, accuracy).nearest;
    const NearestTriangle exact = contact(organ, pieces, here).nearest;
    ASSERT_TRUE(found.distance == found.lower_bound || found.distance == found.upper_bound) << i;
    if (!found.distance_signed) continue;
    ASSERT_LE(found.lower_bound, exact.distance + 1e-15) << i;
    ASSERT_GE(found.upper_bound, exact.distance - 1e-15) << i;
    if (found.distance > found.lower_bound) ++deeper;
  }
  EXPECT_GT(deeper, 20);
}

TEST(Contact, OfSeveralPiecesIsCertainIfOneCollidesOrAllAreCertain) {
  const CollisionMesh organ(test::blob(4));
  const Shape unsure = Vector3d(0, 0, 0);
  const Shape away = Vector3d(1, 1, 1);
  const Shape on = organ.mesh().position(VertexId{7});
  const auto greedy = [&](const Shapes& shapes) {
    return contact(organ, shapes, Eigen::Isometry3d::Identity(), Accuracy::greedy());
  };
  EXPECT_FALSE(greedy({away, unsure}).colliding_certain);
  const Shape just_outside = Vector3d(0, 0, 0.07);
  EXPECT_TRUE(greedy({just_outside}).nearest.distance_signed);
  EXPECT_FALSE(greedy({just_outside, unsure}).nearest.distance_signed);
  EXPECT_EQ(greedy({just_outside, unsure}).nearest.distance,
            greedy({just_outside}).nearest.distance);
  EXPECT_TRUE(greedy({away, away}).colliding_certain);
  EXPECT_TRUE(greedy({unsure, Sphere{{0, 0, 0}, 1.0}}).colliding_certain);
  EXPECT_TRUE(contact(organ, {away, on}, Eigen::Isometry3d::Identity()).colliding_certain);
}

TEST(Contact, OfASphereWhoseCentreIsAllButOnTheOrganHasItsPointOnTheSphere) {
  const CollisionMesh organ(
      TriangleMesh({{0, 0, 0}, {-1, 0, 0}, {0, -1, 0}}, {test::corners(0, 1, 2)}));
  for (const double off : {1e-300, 1e-320, 5e-324}) {
    const Sphere sphere{{off, off, 0}, 0.01};
    EXPECT_NEAR((contact(organ, sphere).nearest.tip_point - sphere.centre).norm(), 0.01, 1e-17);
  }
}

TEST(Contact, OfACapsuleThatIsNearlyASphereHasItsPointTowardsTheOrgan) {
  std::mt19937 generator(61);
  const CollisionMesh organ(test::cube());
  for (int i = 0; i < 20000; ++i) {
    const Vector3d a = Vector3d(3, 3, 3) + test::randomPoint(generator, 1.5);
    const Vector3d b = a + test::randomPoint(generator, std::ldexp(1.0, -44 - i % 8));
    const NearestTriangle nearest = contact(organ, Capsule{a, b, 0.5}).nearest;
    ASSERT_NEAR((nearest.tip_point - nearest.closest.point).norm(), nearest.distance, 1e-10);
  }
}

}  // namespace
}  // namespace organ_collision::core
