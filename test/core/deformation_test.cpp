#include <gtest/gtest.h>

#include <cstdlib>
#include <random>
#include <string>

#include "deformations.h"
#include "organ_collision/core/collision_mesh.h"

// Whatever happens to an organ, by whichever update, its answers are those of its present shape.
namespace organ_collision::core {
namespace {

using Kind = test::Deformation::Kind;

constexpr int kQueries = 4;  // after each deformation

/// TEST_DEFORMATIONS in the environment (scripts/soak asks for ten thousand), else a thousand.
std::size_t deformationCount() {
  const char* wanted = std::getenv("TEST_DEFORMATIONS");
  return wanted == nullptr ? 1000 : std::stoul(wanted);
}

/// Every triangle with vertices of its own, as in an STL file.
TriangleMesh unshared(const TriangleMesh& mesh) {
  Points points;
  std::vector<Corners> triangles;
  for (const Corners& corners : mesh.triangles()) {
    const std::size_t first = points.size();
    for (const VertexId corner : corners) points.push_back(mesh.position(corner));
    triangles.push_back(test::corners(first, first + 1, first + 2));
  }
  return {points, triangles};
}

class Deformation : public testing::TestWithParam<TriangleMesh> {};

TEST_P(Deformation, LeavesExactAnswersEqualToBruteForce) {
  const Points original = GetParam().positions();
  CollisionMesh organ(GetParam());
  Points points = original;
  bool may_cut_itself = false;
  const std::size_t count = deformationCount() / 4;  // of the four organs together
  for (std::size_t i = 0; i < count; ++i) {
    std::mt19937 generator(static_cast<std::uint32_t>(i));
    SCOPED_TRACE("deformation " + std::to_string(i));
    const test::Deformation deformation = test::randomDeformation(generator, original, points);
    deformation.apply(points);
    may_cut_itself =
        deformation.kind == Kind::kFold || (may_cut_itself && deformation.kind != Kind::kRestore);
    if (deformation.vertices.empty() || generator() % 4 == 0) {
      organ.refit(points);
    } else {
      organ.refit(deformation.vertices, deformation.positions);
    }
    if (generator() % 8 == 0) organ.rebuild();
    ASSERT_EQ(organ.mesh().positions(), points);
    ASSERT_NO_FATAL_FAILURE(test::expectTrueHealth(organ));
    for (int query = 0; query < kQueries; ++query) {
      const Eigen::Vector3d tip = test::tipAround(generator, organ);
      ASSERT_NO_FATAL_FAILURE(test::expectBruteForce(organ, tip));
      if (may_cut_itself) continue;
      ASSERT_NO_FATAL_FAILURE(test::expectTrueSign(organ, tip));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Organs, Deformation,
                         testing::Values(test::blob(3), unshared(test::blob(2)), test::soup(200, 7),
                                         test::grid(9, 11)));

}  // namespace
}  // namespace organ_collision::core
