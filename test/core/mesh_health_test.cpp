#include "organ_collision/core/mesh_health.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>

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

struct Counts {
  bool closed = true;
  bool consistently_wound = true;
  std::size_t duplicate_triangles = 0;
};

/// By position, without welds.
Counts countsOf(const TriangleMesh& mesh) {
  using Place = std::array<double, 3>;
  const auto place = [&mesh](VertexId vertex) {
    const Eigen::Vector3d& position = mesh.position(vertex);
    return Place{position.x() + 0.0, position.y() + 0.0, position.z() + 0.0};
  };
  std::map<std::pair<Place, Place>, std::array<int, 2>> uses;  // of each edge, in both senses
  std::set<std::array<Place, 3>> different;
  for (const Corners& triangle : mesh.triangles()) {
    std::array<Place, 3> places = {place(triangle[0]), place(triangle[1]), place(triangle[2])};
    for (const std::size_t i : {0, 1, 2}) {
      const auto [low, high] = std::minmax(places[i], places[(i + 1) % 3]);
      if (low != high) ++uses[{low, high}][places[i] == low ? 0 : 1];
    }
    std::sort(places.begin(), places.end());
    different.insert(places);
  }
  Counts counts;
  for (const auto& [edge, senses] : uses) {
    counts.closed = counts.closed && (senses[0] + senses[1]) % 2 == 0;
    counts.consistently_wound = counts.consistently_wound && std::abs(senses[0] - senses[1]) <= 1;
  }
  counts.duplicate_triangles = mesh.triangleCount() - different.size();
  return counts;
}

TEST(MeshHealth, CountsAsPositionsTellWhateverTheVerticesAre) {
  std::mt19937 generator(7);
  std::array<int, 3> seen = {};
  for (int i = 0; i < 3000; ++i) {
    Points points(3 + generator() % 8);
    for (Eigen::Vector3d& point : points) {
      const auto coordinate = [&] { return std::array{-0.0, 0.0, 1.0}[generator() % 3]; };
      point = {coordinate(), coordinate(), coordinate()};
    }
    const auto vertex = [&] { return generator() % points.size(); };
    std::vector<Corners> triangles(1 + generator() % 4, corners(vertex(), vertex(), vertex()));
    for (Corners& triangle : triangles) {
      std::rotate(triangle.begin(), triangle.begin() + generator() % 3, triangle.end());
      if (generator() % 2 == 0) std::swap(triangle[0], triangle[1]);
      if (generator() % 2 == 0) triangle = corners(vertex(), vertex(), vertex());
    }
    const TriangleMesh mesh(points, triangles);
    const Counts expected = countsOf(mesh);
    const MeshTopology topology(mesh);
    ASSERT_EQ(topology.closed(), expected.closed);
    ASSERT_EQ(topology.consistentlyWound(), expected.consistently_wound);
    ASSERT_EQ(topology.duplicateTriangles(), expected.duplicate_triangles);
    seen[0] += expected.closed ? 1 : 0;
    seen[1] += expected.consistently_wound ? 0 : 1;
    seen[2] += expected.duplicate_triangles > 0 ? 1 : 0;
  }
  for (const int often : seen) EXPECT_GT(often, 100);
}

}  // namespace
}  // namespace organ_collision::core
