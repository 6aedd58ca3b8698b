#include "organ_collision/core/mesh_health.h"

#include <gmock/gmock.h>

#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using test::corners;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

MeshHealth healthOf(const TriangleMesh& mesh) { return inspect(mesh, MeshTopology(mesh)); }

TEST(MeshHealth, OfAnOrganIsWithoutWarnings) {
  const MeshHealth health = healthOf(test::blob(3));
  EXPECT_TRUE(health.closed);
  EXPECT_TRUE(health.consistently_wound);
  EXPECT_FALSE(health.inverted);
  EXPECT_EQ(health.degenerate_triangles, 0U);
  EXPECT_EQ(health.duplicate_triangles, 0U);
  EXPECT_THAT(warnings(health), IsEmpty());
}

TEST(MeshHealth, CountsZeroAreaAndDuplicateTriangles) {
  const TriangleMesh mesh(
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 1, 0}, {0, 0, 0}},
      {corners(0, 1, 2), corners(0, 1, 3), corners(3, 4, 1), corners(0, 0, 0), corners(1, 0, 4)});
  const MeshHealth health = healthOf(mesh);
  EXPECT_EQ(health.degenerate_triangles, 3U);
  EXPECT_EQ(health.duplicate_triangles, 1U);  // 3 4 1 is 0 1 3: vertex 4 is where vertex 0 is
}

TEST(MeshHealth, TellsAnOpenSurfaceFromAClosedOne) {
  EXPECT_FALSE(healthOf(test::grid(3, 3)).closed);
  EXPECT_TRUE(healthOf(test::grid(3, 3)).consistently_wound);
  EXPECT_THAT(warnings(healthOf(test::grid(3, 3))), Contains(HasSubstr("not closed")));
  EXPECT_TRUE(healthOf(test::cube()).closed);
}

TEST(MeshHealth, FindsATriangleWoundTheOtherWay) {
  std::vector<Corners> triangles = test::cube().triangles();
  std::swap(triangles[5][0], triangles[5][2]);
  const MeshHealth health = healthOf(TriangleMesh(test::cube().positions(), triangles));
  EXPECT_TRUE(health.closed);
  EXPECT_FALSE(health.consistently_wound);
}

TEST(MeshHealth, GuessesMillimetres) {
  EXPECT_THAT(warnings(healthOf(test::cube(200.0))),
              Contains(AllOf(HasSubstr("200 m"), HasSubstr("0.001"))));
  EXPECT_THAT(warnings(healthOf(test::cube(0.2))), Not(Contains(HasSubstr("millimetres"))));
  EXPECT_THAT(warnings(healthOf(test::cube(0.0002))), Contains(HasSubstr("small")));
}

TEST(MeshHealth, WarnsOfEverythingThatIsWrong) {
  EXPECT_EQ(warnings({false, false, true, 1, 1, {{0, 0, 0}, {9, 9, 9}}}).size(), 6U);
  EXPECT_EQ(warnings({true, true, false, 0, 0, {{0, 0, 0}, {1e-3, 0, 0}}}).size(), 1U);
}

TEST(MeshHealth, BoxLeavesOutVerticesThatNoTriangleUses) {
  Points points = test::cube().positions();
  points.emplace_back(100, 100, 100);
  EXPECT_EQ(healthOf(TriangleMesh(points, test::cube().triangles())).box.high,
            Eigen::Vector3d(1, 1, 1));
}

}  // namespace
}  // namespace organ_collision::core
