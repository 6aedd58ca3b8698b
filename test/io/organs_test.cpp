// The shipped liver, and the organs of the folder that the environment variable ORGAN_MESHES names.
// TEST_QUERIES sets the queries for each (scripts/soak asks for 100000).
#include <gtest/gtest.h>

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>

#include "brute_force.h"
#include "core/organs_and_tips.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/self_intersections.h"
#include "organ_collision/core/triangle_intersection.h"
#include "organ_collision/io/mesh_io.h"
#include "paper_hierarchy.h"
#include "test_meshes.h"

namespace organ_collision {
namespace {

using core::Accuracy;
using core::CollisionMesh;
using core::NearestTriangle;
using core::Triangle;
using core::TriangleId;
using core::TriangleMesh;
using test::queryCount;
using test::rounding;

constexpr std::size_t kDefaultQueries = 1000;
constexpr std::size_t kLargestPaperMesh =
    12000;  // triangles; the literal transcription takes their square

std::filesystem::path liver() { return std::filesystem::path(MESHES) / "liver.obj"; }

std::vector<std::filesystem::path> organFiles() {
  std::vector<std::filesystem::path> files = {liver()};
  const char* folder = std::getenv("ORGAN_MESHES");
  if (folder == nullptr) return files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".obj") files.push_back(entry.path());
  }
  return files;
}

/// A third each: within 5 mm or so of the surface, in a box twice as large as the organ, inside its
/// box.
Eigen::Vector3d randomTip(std::mt19937& generator, const CollisionMesh& organ) {
  const core::Box& box = organ.health().box;
  const Eigen::Vector3d half = 0.5 * (box.high - box.low);
  const Eigen::Vector3d middle = 0.5 * (box.low + box.high);
  const auto triangle = static_cast<TriangleId>(generator() % organ.mesh().triangleCount());
  switch (generator() % 3) {
    case 0:
      return core::centroid(organ.mesh().triangle(triangle)) +
             test::randomPoint(generator, 0.05 * half.maxCoeff());
    case 1:
      return middle + 2.0 * half.cwiseProduct(test::randomPoint(generator, 1.0));
    default:
      return middle + half.cwiseProduct(test::randomPoint(generator, 1.0));
  }
}

class Organs : public testing::TestWithParam<std::filesystem::path> {
 protected:
  const CollisionMesh organ_{io::loadMesh(GetParam())};
  std::mt19937 generator_{41};
};

TEST_P(Organs, ExactAnswersEqualBruteForceAndBoundsHoldTheTruth) {
  for (std::size_t i = 0; i < queryCount(kDefaultQueries); ++i) {
    const Eigen::Vector3d tip = randomTip(generator_, organ_);
    const double truth = std::sqrt(test::squaredDistanceByBruteForce(organ_.mesh(), tip));
    const NearestTriangle exact = core::nearestTriangle(organ_, tip);
    ASSERT_EQ(std::abs(exact.distance), truth);
    ASSERT_TRUE(exact.isExact());
    ASSERT_EQ(exact.distance_signed, organ_.health().isSolid());
    for (const Accuracy& accuracy :
         {Accuracy::greedy(), Accuracy{0.05, 0, 0}, Accuracy{0, 0, 16}}) {
      const NearestTriangle nearest = core::nearestTriangle(organ_, tip, accuracy);
      const double expected = nearest.distance_signed ? exact.distance : truth;
      ASSERT_LE(nearest.lower_bound, expected + rounding(organ_, tip));
      ASSERT_GE(nearest.upper_bound, expected - rounding(organ_, tip));
    }
  }
}

TEST_P(Organs, GreedyAnswersEqualThePapersPseudoCode) {
  if (queryCount(kDefaultQueries) <= kDefaultQueries &&
      organ_.mesh().triangleCount() > kLargestPaperMesh) {
    GTEST_SKIP() << "more than " << kLargestPaperMesh << " triangles: in scripts/soak only";
  }
  const test::PaperHierarchy paper(organ_.mesh());
  for (std::size_t i = 0; i < queryCount(kDefaultQueries); ++i) {
    const Eigen::Vector3d tip = randomTip(generator_, organ_);
    ASSERT_EQ(core::nearestTriangle(organ_, tip, Accuracy::greedy()).triangle, paper.search(tip));
  }
}

/// With a number, as files in different folders may have the same.
std::string testName(const testing::TestParamInfo<std::filesystem::path>& file) {
  std::string name = file.param.stem().string() + "_" + std::to_string(file.index);
  for (char& letter : name)
    if (std::isalnum(static_cast<unsigned char>(letter)) == 0) letter = '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, Organs, testing::ValuesIn(organFiles()), testName);

TEST(RealOrgans, AreTestedToo) {
  if (std::getenv("ORGAN_MESHES") == nullptr)
    GTEST_SKIP() << "ORGAN_MESHES is not set: only the shipped liver is";
  EXPECT_GT(organFiles().size(), 1U);
}

class Liver : public testing::Test {
 protected:
  const CollisionMesh liver_{io::loadMesh(liver())};
};

TEST_F(Liver, IsAClosedOrganOfHumanSizeWithoutAnythingToWarnOf) {
  EXPECT_TRUE(liver_.health().isSolid());
  EXPECT_TRUE(core::warnings(liver_.health()).empty());
  EXPECT_EQ(core::warning(core::selfIntersections(liver_, 1)), "");
  const Eigen::Vector3d size = liver_.health().box.high - liver_.health().box.low;
  EXPECT_GT(size.maxCoeff(), 0.15);
  EXPECT_LT(size.maxCoeff(), 0.25);
  EXPECT_GE(liver_.mesh().triangleCount(), 5000U);
  EXPECT_LE(liver_.mesh().triangleCount(), 20000U);
}

TEST_F(Liver, HasNoHandleAndIsInOnePiece) {
  // Euler: V - E + F = 2 for a closed surface of genus 0, and E = 3F/2.
  const std::size_t faces = liver_.mesh().triangleCount();
  EXPECT_EQ(liver_.mesh().positions().size(), 2 + faces / 2);
  std::vector<core::TriangleId> open = {core::TriangleId{0}};
  std::set<core::TriangleId> seen(open.begin(), open.end());
  while (!open.empty()) {
    const core::Corners corners = liver_.mesh().corners(open.back());
    open.pop_back();
    for (const core::VertexId corner : corners) {
      for (const core::TriangleId next :
           liver_.topology().trianglesAt(liver_.topology().weld(corner))) {
        if (seen.insert(next).second) open.push_back(next);
      }
    }
  }
  EXPECT_EQ(seen.size(), faces);
}

TEST_F(Liver, HasWellShapedTriangles) {
  constexpr double kSharpest = 15.0 * M_PI / 180.0;
  for (std::size_t i = 0; i < liver_.mesh().triangleCount(); ++i) {
    const Triangle t = liver_.mesh().triangle(static_cast<TriangleId>(i));
    for (const auto& [at, to, from] :
         {std::tie(t.a, t.b, t.c), std::tie(t.b, t.c, t.a), std::tie(t.c, t.a, t.b)}) {
      const Eigen::Vector3d first = to - at;
      const Eigen::Vector3d second = from - at;
      EXPECT_GT(std::atan2(first.cross(second).norm(), first.dot(second)), kSharpest)
          << "triangle " << i;
    }
  }
}

TEST_F(Liver, DoesNotCrossItself) {
  const TriangleMesh& mesh = liver_.mesh();
  const auto touching = [&](TriangleId i, TriangleId j) {
    for (const core::VertexId corner : mesh.corners(i)) {
      for (const core::VertexId other : mesh.corners(j)) {
        if (corner == other) return true;
      }
    }
    return false;
  };
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    const auto first = static_cast<TriangleId>(i);
    const core::Box box = core::boxOf(mesh.triangle(first));
    for (std::size_t j = 0; j < i; ++j) {
      const auto second = static_cast<TriangleId>(j);
      if (core::squaredDistance(box, core::boxOf(mesh.triangle(second))) > 0.0 ||
          touching(first, second))
        continue;
      EXPECT_FALSE(core::trianglesIntersect(mesh.triangle(first), mesh.triangle(second)))
          << i << " and " << j;
    }
  }
}

}  // namespace
}  // namespace organ_collision
