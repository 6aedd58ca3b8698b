// Meshes that published programs failed on. Single triangles and pairs of them are in the tests of
// the kernels.
#include <gtest/gtest.h>

#include <cmath>

#include "organ_collision/core/nearest_triangle.h"
#include "organs_and_tips.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using test::corners;
using test::queryCount;

TEST(PublishedCases, ATriangleThatIsAPointIsBuiltBesideASegment) {
  // svenstaro/bvh#44: a panic
  const CollisionMesh organ(
      TriangleMesh({{0, 0, 0}, {0, 0, 1}}, {corners(0, 0, 0), corners(0, 0, 1)}));
  const NearestTriangle nearest = nearestTriangle(organ, Eigen::Vector3d(1, 0, 0.5));
  EXPECT_EQ(nearest.distance, 1.0);
  EXPECT_EQ(index(nearest.triangle), 1U);
}

TEST(PublishedCases, AThousandTrianglesAroundOneCentroidAreSplit) {
  // hoverinc/ray-tracing-renderer#81: recursion without end
  constexpr std::size_t kCount = 1000;
  Points points;
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < kCount; ++i) {
    for (const int corner : {0, 1, 2}) {
      const double angle = 2.0 * M_PI * (static_cast<double>(i) / (3.0 * kCount) + corner / 3.0);
      points.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    }
    triangles.push_back(corners(3 * i, 3 * i + 1, 3 * i + 2));
  }
  const CollisionMesh organ(TriangleMesh(points, triangles));
  EXPECT_LE(organ.tree().depth(), 64U);
  EXPECT_EQ(nearestTriangle(organ, Eigen::Vector3d(0.1, 0.2, 0.5)).distance, 0.5);
}

TEST(PublishedCases, SixteenThousandCopiesOfATriangleCostALookAtEach) {
  // CGAL 5.5.1: 17 s, the square of the number
  constexpr std::size_t kCopies = 16000;
  const TriangleMesh copies({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                            std::vector<Corners>(kCopies, corners(0, 1, 2)));
  const CollisionMesh organ(copies);
  const NearestTriangle nearest = nearestTriangle(organ, Eigen::Vector3d(0.2, 0.2, 1.0));
  EXPECT_EQ(nearest.distance, 1.0);
  EXPECT_TRUE(nearest.isExact());
  EXPECT_LE(organ.tree().depth(), 14U);  // 2^14 > 16,000
  EXPECT_LE(nearest.work.triangles, kCopies);
}

TEST(PublishedCases, RenumberingAFlatGridChangesNoDistance) {
  // ties broken by index: 11,080 of 20,000 greedy answers change
  const CollisionMesh organ(test::grid(30, 30));
  const CollisionMesh renumbered(test::shuffled(organ.mesh(), 3));
  std::mt19937 generator(3);
  const double size = organ.health().box.high.x();
  for (std::size_t i = 0; i < queryCount(20000); ++i) {
    const Eigen::Vector3d tip =
        0.5 * (Eigen::Vector3d::Constant(size) + test::randomPoint(generator, size));
    for (const Accuracy& accuracy : {Accuracy::exact(), Accuracy::greedy()}) {
      ASSERT_EQ(nearestTriangle(organ, tip, accuracy).distance,
                nearestTriangle(renumbered, tip, accuracy).distance);
    }
  }
}

TEST(PublishedCases, AnOrganOfATenthOfAMillimetreKeepsItsDistance) {
  // FCL 0.7: 0
  const CollisionMesh organ(
      TriangleMesh({{0, 0, 0}, {1.5e-4, 0, 0}, {0, 1.5e-4, 0}}, {corners(0, 1, 2)}));
  const Eigen::Vector3d tip(5e-5, 5e-5, 1.5e-5);
  EXPECT_NEAR(nearestTriangle(organ, tip).distance, 1.5e-5, test::rounding(organ, tip));
}

}  // namespace
}  // namespace organ_collision::core
