#include "organ_collision/core/mesh_health.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>

#include "organ_collision/core/collision_mesh.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using test::corners;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

MeshHealth healthOf(const TriangleMesh& mesh) { return CollisionMesh(mesh).health(); }

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

/// How often meshes were closed, open, wound wrongly, with duplicates.
using Seen = std::array<int, 4>;

void compareCounts(const TriangleMesh& mesh, Seen& seen) {
  const Counts expected = countsOf(mesh);
  const MeshTopology topology(mesh);
  ASSERT_EQ(topology.closed(), expected.closed);
  ASSERT_EQ(topology.consistentlyWound(), expected.consistently_wound);
  ASSERT_EQ(topology.duplicateTriangles(), expected.duplicate_triangles);
  ++seen[expected.closed ? 0 : 1];
  seen[2] += expected.consistently_wound ? 0 : 1;
  seen[3] += expected.duplicate_triangles > 0 ? 1 : 0;
}

TEST(MeshHealth, CountsAsPositionsTellWhateverTheVerticesAre) {
  std::mt19937 generator(7);
  Seen seen = {};
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
    ASSERT_NO_FATAL_FAILURE(compareCounts(TriangleMesh(points, triangles), seen));
  }
  for (const int often : seen) EXPECT_GT(often, 100);
}

/// Closed: from a pole at 0 and one at 1 to a ring of so many.
std::vector<Corners> bipyramid(std::size_t sides) {
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < sides; ++i) {
    const std::size_t one = 2 + i;
    const std::size_t next = 2 + (i + 1) % sides;
    triangles.push_back(corners(0, one, next));
    triangles.push_back(corners(1, next, one));
  }
  return triangles;
}

TEST(MeshHealth, FindsWhatIsWrongAroundVerticesOfManyTriangles) {
  std::mt19937 generator(8);
  Seen seen = {};
  for (int i = 0; i < 6000; ++i) {
    const std::size_t sides = 3 + generator() % 8;
    std::vector<Corners> triangles = bipyramid(sides);
    Points points;
    for (std::size_t vertex = 0; vertex < 2 + sides; ++vertex)
      points.emplace_back(static_cast<double>(vertex), 0, 0);
    for (auto faults = generator() % 3; faults > 0; --faults) {
      const std::size_t one = generator() % triangles.size();
      switch (generator() % 5) {
        case 0:
          triangles.erase(triangles.begin() + static_cast<std::ptrdiff_t>(one));
          break;
        case 1:
          std::swap(triangles[one][0], triangles[one][1]);
          break;
        case 2:
          triangles.push_back({triangles[one][2], triangles[one][0], triangles[one][1]});
          break;
        case 3:  // both sides of one more
          triangles.push_back(corners(0, 2, 4));
          triangles.push_back(corners(2, 0, 4));
          break;
        default:
          points[generator() % points.size()] = points[generator() % points.size()];
      }
    }
    std::shuffle(triangles.begin(), triangles.end(), generator);
    ASSERT_NO_FATAL_FAILURE(compareCounts(TriangleMesh(points, triangles), seen));
  }
  for (const int often : seen) EXPECT_GT(often, 100);
}

}  // namespace
}  // namespace organ_collision::core
