#include "organ_collision/core/farthest_pair_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "paper_hierarchy.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using Child = FarthestPairTree::Child;

/// Visits every subset with the triangles in it, leaves first; returns the triangles of `set`.
template <class Visit>
std::vector<TriangleId> visit(const FarthestPairTree& tree, Child set, const Visit& visitNode) {
  if (set.isLeaf()) return {tree.triangle(set.leaf())};
  std::vector<TriangleId> all;
  for (const Child child : tree.node(set.node()).children) {
    const std::vector<TriangleId> part = visit(tree, child, visitNode);
    all.insert(all.end(), part.begin(), part.end());
  }
  visitNode(set.node(), all);
  return all;
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
    std::vector<TriangleId> all = visit(tree, tree.root(), [](std::size_t, const auto&) {});
    std::sort(all.begin(), all.end());
    ASSERT_EQ(all.size(), mesh.triangleCount());
    EXPECT_EQ(std::unique(all.begin(), all.end()), all.end());
    EXPECT_EQ(tree.nodeCount(), mesh.triangleCount() - 1);
  }
}

TEST(FarthestPairTree, BoxesContainTheirTrianglesAlsoAfterARefit) {
  for (const TriangleMesh& original : meshes()) {
    TriangleMesh mesh = original;
    FarthestPairTree tree(mesh);
    for (int round = 0; round < 2; ++round) {
      visit(tree, tree.root(), [&](std::size_t node, const std::vector<TriangleId>& triangles) {
        Box expected;
        for (const TriangleId id : triangles) expected.add(boxOf(mesh.triangle(id)));
        EXPECT_EQ(tree.box(node).low, expected.low);
        EXPECT_EQ(tree.box(node).high, expected.high);
      });
      Points moved = mesh.positions();
      for (Eigen::Vector3d& point : moved)
        point = Eigen::Vector3d(point.y() + 1.0, -2.0 * point.x(), point.z() * point.x());
      mesh.setPositions(moved);
      tree.refit(mesh);
    }
  }
}

TEST(FarthestPairTree, EqualsALiteralTranscriptionOfThePaper) {
  for (const TriangleMesh& mesh : meshes()) {
    const FarthestPairTree tree(mesh);
    const test::PaperHierarchy paper(mesh);
    std::vector<std::pair<Child, const test::PaperHierarchy::Set*>> open = {
        {tree.root(), &paper.root()}};
    while (!open.empty()) {
      const auto [child, set] = open.back();
      open.pop_back();
      ASSERT_EQ(child.isLeaf(), set->first == nullptr);
      if (child.isLeaf()) {
        EXPECT_EQ(centroid(mesh.triangle(tree.triangle(child.leaf()))),
                  centroid(mesh.triangle(set->triangles.front())));
        continue;
      }
      EXPECT_EQ(tree.node(child.node()).poles[0], set->first_pole);
      EXPECT_EQ(tree.node(child.node()).poles[1], set->second_pole);
      open.emplace_back(tree.node(child.node()).children[0], set->first.get());
      open.emplace_back(tree.node(child.node()).children[1], set->second.get());
    }
  }
}

TEST(FarthestPairTree, DoesNotDependOnTheNumbersOfTheTriangles) {
  for (const TriangleMesh& mesh : meshes()) {
    const FarthestPairTree tree(mesh);
    const TriangleMesh renumbered = test::shuffled(mesh, 5);
    const FarthestPairTree other(renumbered);
    ASSERT_EQ(tree.nodeCount(), other.nodeCount());
    for (std::size_t i = 0; i < tree.nodeCount(); ++i) {
      EXPECT_EQ(tree.node(i).poles, other.node(i).poles);
      EXPECT_EQ(tree.box(i).low, other.box(i).low);
      EXPECT_EQ(tree.box(i).high, other.box(i).high);
    }
  }
}

TEST(FarthestPairTree, PolesMoveWithTheirTriangles) {
  TriangleMesh mesh = test::blob(3);
  FarthestPairTree tree(mesh);
  Points moved = mesh.positions();
  for (Eigen::Vector3d& point : moved) point += Eigen::Vector3d(1.0, 2.0, 3.0) * point.x();
  mesh.setPositions(moved);
  tree.refit(mesh);
  for (std::size_t i = 0; i < tree.nodeCount(); ++i) {
    for (const std::size_t side : {0, 1}) {
      EXPECT_EQ(tree.node(i).poles[side],
                centroid(mesh.triangle(tree.node(i).pole_triangles[side])));
    }
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
  EXPECT_EQ(tree.nodeCount(), 899U);
}

TEST(FarthestPairTree, OfOneTriangleIsALeaf) {
  const TriangleMesh mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {test::corners(0, 1, 2)});
  const FarthestPairTree tree(mesh);
  EXPECT_TRUE(tree.root().isLeaf());
  EXPECT_EQ(tree.depth(), 0U);
}

}  // namespace
}  // namespace organ_collision::core
