// Surfaces of several parts.
#include <gtest/gtest.h>

#include "organ_collision/core/contact.h"
#include "organ_collision/core/sign.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::cube;
using test::joined;
using test::placed;

TEST(Parts, OneOfWhichIsInsideASolidCollideWithIt) {
  const CollisionMesh solid(cube());
  const CollisionMesh two(
      joined(placed(cube(), 0.1, {10, 0, 0}), placed(cube(), 0.1, {0.4, 0.4, 0.4})));
  for (const bool swapped : {false, true}) {
    const NearestPair pair = swapped ? nearestPair(solid, Isometry3d::Identity(), two)
                                     : nearestPair(two, Isometry3d::Identity(), solid);
    EXPECT_NEAR(pair.nearest.distance, -0.4, 1e-15);
    EXPECT_TRUE(pair.nearest.distance_signed);
  }
  const Contact found =
      contact(solid, RigidMesh{std::make_shared<const CollisionMesh>(two), Isometry3d::Identity()});
  EXPECT_TRUE(found.colliding);
}

TEST(Parts, OneOfWhichIsInsideASolidCollideWithItThoughTheOtherIsNearer) {
  const CollisionMesh solid(cube());
  const CollisionMesh two(
      joined(placed(cube(), 0.25, {1.125, 0, 0}), placed(cube(), 0.25, {0.375, 0.375, 0.375})));
  const NearestPair pair = nearestPair(two, Isometry3d::Identity(), solid);
  EXPECT_EQ(pair.nearest.distance, -0.125);
  EXPECT_EQ(pair.nearest.tip_point.x(), 1.125) << "of the nearer part";
}

/// Two cubes that share a vertex are torn apart: the one goes far away, the other becomes a tenth
/// as large and gets its corner at `place`.
CollisionMesh tornCubes(bool second_goes, const Vector3d& place) {
  const TriangleMesh welded = joined(cube(), placed(cube(), 1.0, {1, 1, 1}));
  CollisionMesh torn(welded);
  Points positions = welded.positions();
  const std::size_t half = positions.size() / 2;
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const bool is_second = i >= half;
    const Vector3d local = positions[i] - (is_second ? Vector3d(1, 1, 1) : Vector3d(0, 0, 0));
    positions[i] = is_second == second_goes ? Vector3d(local + Vector3d(10, 10, 10))
                                            : Vector3d(0.1 * local + place);
  }
  EXPECT_EQ(torn.topology().parts().size(), 1U);
  EXPECT_TRUE(torn.holdsTogether());
  torn.refit(positions);
  EXPECT_FALSE(torn.holdsTogether());
  return torn;
}

TEST(Parts, ThatWereTornOffCollideWithASolidThatTheyAreIn) {
  const CollisionMesh solid(cube());
  for (const bool second_goes : {false, true}) {
    const CollisionMesh torn = tornCubes(second_goes, {0.45, 0.45, 0.45});
    for (const bool swapped : {false, true}) {
      const NearestPair pair = swapped ? nearestPair(solid, Isometry3d::Identity(), torn)
                                       : nearestPair(torn, Isometry3d::Identity(), solid);
      EXPECT_NEAR(pair.nearest.distance, -0.45, 1e-15);
      EXPECT_TRUE(pair.nearest.distance_signed);
    }
  }
}

TEST(Parts, ThatWereTornOffAreTheirOwnWhereTheyAllButTouch) {
  const CollisionMesh solid(cube());
  for (const bool second_goes : {false, true}) {
    const CollisionMesh torn = tornCubes(second_goes, {1e-14, 0.45, 0.45});
    EXPECT_NEAR(nearestPair(torn, Isometry3d::Identity(), solid).nearest.distance, -1e-14, 1e-16);
  }
}

/// Whatever normals say.
TEST(Parts, HaveTheSideThatTheWindingNumberTells) {
  const TriangleMesh inner = placed(cube(), 0.5, {0.25, 0.25, 0.25});
  const TriangleMesh beside = placed(cube(), 0.5, {2, 0, 0});
  std::mt19937 generator(51);
  for (const TriangleMesh& mesh :
       {joined(cube(), inner), joined(cube(), test::turned(inner)), joined(cube(), beside),
        joined(cube(), test::turned(beside)), test::turned(joined(cube(), inner))}) {
    const CollisionMesh organ(mesh);
    ASSERT_TRUE(organ.health().isSolid());
    for (int i = 0; i < 2000; ++i) {
      const Vector3d tip = Vector3d(1, 0.5, 0.5) + test::randomPoint(generator, 2.0);
      const NearestTriangle nearest = nearestTriangle(organ, tip);
      ASSERT_TRUE(nearest.distance_signed);
      ASSERT_EQ(nearest.distance < 0.0, windingNumber(organ, tip) != 0);
    }
  }
}

}  // namespace
}  // namespace organ_collision::core
