#include "organ_collision/core/farthest_pair_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>

#include "every_vector_unit.h"
#include "paper_hierarchy.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using Set = FarthestPairTree::Set;

/// Calls `visit` for every set that is split.
template <class Visit>
void forEachSplit(const FarthestPairTree& tree, const Visit& visit) {
  std::vector<Set> open = {tree.root()};
  while (!open.empty()) {
    const Set set = open.back();
    open.pop_back();
    if (set.isLeaf()) continue;
    visit(set);
    for (const Set& child : tree.children(set)) open.push_back(child);
  }
}

Eigen::Vector3d centroidOf(const FarthestPairTree& tree, const TriangleMesh& mesh,
                           FarthestPairTree::Leaf leaf) {
  return centroid(mesh.triangle(tree.triangle(leaf)));
}

const std::vector<TriangleMesh>& meshes() {
  static const std::vector<TriangleMesh> all = {test::cube(),       test::grid(8, 8),
                                                test::grid(38, 39), test::row(101),
                                                test::blob(4),      test::soup(500, 3)};
  return all;
}

TEST(FarthestPairTree, HoldsEveryTriangleInExactlyOneLeaf) {
  for (const TriangleMesh& mesh : meshes()) {
    const FarthestPairTree tree(mesh);
    ASSERT_EQ(tree.root().size(), mesh.triangleCount());
    std::set<TriangleId> all;
    for (FarthestPairTree::Leaf leaf = 0; leaf < tree.root().size(); ++leaf)
      all.insert(tree.triangle(leaf));
    EXPECT_EQ(all.size(), mesh.triangleCount());
    std::set<std::uint32_t> nodes;
    forEachSplit(tree, [&](const Set& set) {
      EXPECT_TRUE(nodes.insert(set.node).second);
      const auto [first, second] = tree.children(set);
      EXPECT_TRUE(set.begin == first.begin && first.begin < first.end &&
                  first.end == second.begin && second.begin < second.end && second.end == set.end);
    });
    EXPECT_EQ(nodes.size(), mesh.triangleCount() - 1);
  }
}

void expectPaperHierarchy(const TriangleMesh& mesh) {
  const FarthestPairTree tree(mesh);
  const test::PaperHierarchy paper(mesh);
  std::size_t deepest = 0;
  struct Pair {
    Set set;
    const test::PaperHierarchy::Set* expected;
    std::size_t depth;
  };
  std::vector<Pair> open = {{tree.root(), &paper.root(), 0}};
  while (!open.empty()) {
    const auto [set, expected, depth] = open.back();
    open.pop_back();
    deepest = std::max(deepest, depth);
    ASSERT_EQ(set.isLeaf(), expected->first == nullptr);
    if (set.isLeaf()) {
      EXPECT_EQ(centroidOf(tree, mesh, set.begin),
                centroid(mesh.triangle(expected->triangles.front())));
      continue;
    }
    EXPECT_EQ(centroidOf(tree, mesh, tree.poles(set)[0]), expected->first_pole);
    EXPECT_EQ(centroidOf(tree, mesh, tree.poles(set)[1]), expected->second_pole);
    open.push_back({tree.children(set)[0], expected->first.get(), depth + 1});
    open.push_back({tree.children(set)[1], expected->second.get(), depth + 1});
  }
  EXPECT_EQ(tree.depth(), deepest);
}

class FarthestPairTreeOnEveryVectorUnit : public test::EveryVectorUnit {};
ORGAN_COLLISION_ON_EVERY_VECTOR_UNIT(FarthestPairTreeOnEveryVectorUnit);

TEST_P(FarthestPairTreeOnEveryVectorUnit, EqualsALiteralTranscriptionOfThePaper) {
  for (const TriangleMesh& mesh : meshes()) expectPaperHierarchy(mesh);
}

TEST_P(FarthestPairTreeOnEveryVectorUnit, EqualsItForAFewTrianglesThatTieOrCoincide) {
  std::mt19937 generator(9);
  for (std::size_t count = 1; count <= 80; ++count) {
    Points points;
    std::vector<Corners> triangles;
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector3d corner(generator() % 4, generator() % 3, generator() % 2);
      for (const Eigen::Vector3d& edge :
           {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(3, 0, 0), Eigen::Vector3d(0, 3, 0)})
        points.push_back(corner + edge);
      triangles.push_back(test::corners(3 * i, 3 * i + 1, 3 * i + 2));
    }
    expectPaperHierarchy(TriangleMesh(points, triangles));
  }
}

TEST(FarthestPairTree, DoesNotDependOnTheNumbersOfTheTriangles) {
  for (const TriangleMesh& mesh : meshes()) {
    const FarthestPairTree tree(mesh);
    const TriangleMesh renumbered = test::shuffled(mesh, 5);
    const FarthestPairTree other(renumbered);
    forEachSplit(tree, [&](const Set& set) {
      EXPECT_EQ(tree.poles(set), other.poles(set));
      EXPECT_EQ(tree.children(set)[0].end, other.children(set)[0].end);
    });
    for (FarthestPairTree::Leaf leaf = 0; leaf < tree.root().size(); ++leaf)
      EXPECT_EQ(centroidOf(tree, mesh, leaf), centroidOf(other, renumbered, leaf));
  }
}

TEST(FarthestPairTree, CoincidentTrianglesEndInALogarithmOfLevels) {
  // 1000 equilateral triangles turned about one centre: their centroids agree but for rounding.
  Points points;
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < 1000; ++i) {
    for (const int corner : {0, 1, 2}) {
      const double angle = 2.0 * M_PI * (static_cast<double>(i) / 3000.0 + corner / 3.0);
      points.emplace_back(std::cos(angle), std::sin(angle), 0.0);
    }
    triangles.push_back(test::corners(3 * i, 3 * i + 1, 3 * i + 2));
  }
  EXPECT_LE(FarthestPairTree(TriangleMesh(points, triangles)).depth(), 64U);
  const std::vector<Corners> copies(1000, test::corners(0, 1, 2));
  EXPECT_EQ(FarthestPairTree(TriangleMesh(points, copies)).depth(), 10U);
}

TEST(FarthestPairTree, ExponentiallySpacedTrianglesGoDeepWithoutRecursion) {
  Points points;
  std::vector<Corners> triangles;
  for (std::size_t i = 0; i < 900; ++i) {
    const double x = std::ldexp(1.0, 300 - static_cast<int>(i));
    points.insert(points.end(), {{x, 0, 0}, {x, x, 0}, {x, 0, x}});
    triangles.push_back(test::corners(3 * i, 3 * i + 1, 3 * i + 2));
  }
  const FarthestPairTree tree(TriangleMesh(points, triangles));
  EXPECT_GT(tree.depth(), 300U);
}

TEST(FarthestPairTree, OfOneTriangleIsALeaf) {
  const TriangleMesh mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {test::corners(0, 1, 2)});
  const FarthestPairTree tree(mesh);
  EXPECT_TRUE(tree.root().isLeaf());
  EXPECT_EQ(tree.depth(), 0U);
}

TEST(FarthestPairTree, OrdersTurnedDuplicatesWhateverTheirNumbers) {
  const auto first = [](const Corners& one, const Corners& other) {
    const TriangleMesh mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {one, other});
    return mesh.corners(FarthestPairTree(mesh).triangle(0));
  };
  EXPECT_EQ(first(test::corners(0, 1, 2), test::corners(0, 2, 1)),
            first(test::corners(0, 2, 1), test::corners(0, 1, 2)));
}

TEST(FarthestPairTree, HasAPoleOfEachHalfOfCoincidentTriangles) {
  const FarthestPairTree tree(TriangleMesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                           std::vector<Corners>(100, test::corners(0, 1, 2))));
  forEachSplit(tree, [&](const Set& set) {
    const auto [first, second] = tree.poles(set);
    EXPECT_LT(first, tree.children(set)[0].end);
    EXPECT_GE(second, tree.children(set)[1].begin);
  });
}

/// Two triangles with one centroid: which comes first, their vertices decide.
TEST(FarthestPairTree, OrdersCoincidentTrianglesWhicheverCornerComesFirst) {
  const Points points = {{3, 0, 0}, {0, 3, 0}, {-3, -3, 0}, {6, 0, 0}, {0, 6, 0}, {-6, -6, 0}};
  const auto ordered = [&](const std::vector<Corners>& triangles) {
    const TriangleMesh mesh(points, triangles);
    const FarthestPairTree tree(mesh);
    std::vector<Corners> leaves;
    for (FarthestPairTree::Leaf leaf = 0; leaf < triangles.size(); ++leaf) {
      Corners corners = mesh.corners(tree.triangle(leaf));
      std::sort(corners.begin(), corners.end());
      leaves.push_back(corners);
    }
    return leaves;
  };
  EXPECT_EQ(ordered({test::corners(0, 1, 2), test::corners(3, 4, 5)}),
            ordered({test::corners(2, 0, 1), test::corners(3, 4, 5)}));
  EXPECT_EQ(ordered({test::corners(0, 1, 2), test::corners(3, 4, 5)}),
            ordered({test::corners(0, 1, 2), test::corners(5, 3, 4)}));
}

}  // namespace
}  // namespace organ_collision::core
