#include "convex/tool_proximity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "convex_shapes.h"
#include "core/organs_and_tips.h"
#include "io/primitive_mesh.h"
#include "test_meshes.h"

namespace organ_collision::convex {
namespace {

using core::Capsule;
using core::CollisionMesh;
using core::Points;
using core::Proximity;
using core::RigidMesh;
using core::Shape;
using core::Sphere;
using Eigen::Isometry3d;
using Eigen::Vector3d;
using test::queryCount;

TEST(ToolProximity, IsThatOfTheNearestPiecesInTheSecondsFrameWhereverTheyAreListed) {
  core::Shapes first = {Sphere{{0, 0, 9}, 1}, box({1, 1, 1})};
  core::Shapes second = {Sphere{{0, 0, -4}, 0.5}, Vector3d(0, 0, -1)};
  for (core::Shapes* const turned : {&first, &second, &first, &second}) {
    const Proximity nearest = toolProximity(first, at(0, 0, 2), second, {});
    EXPECT_NEAR(nearest.distance, 2.5, kGjk);
    EXPECT_NEAR(nearest.point_on_first.z(), 1.5, kGjk);
    EXPECT_EQ(nearest.point_on_second, Vector3d(0, 0, -1));
    std::reverse(turned->begin(), turned->end());
  }
}

TEST(ToolProximity, KeepsToTheAccuracyAskedFor) {
  const core::Shapes blob = {RigidMesh{std::make_shared<const CollisionMesh>(test::blob(4)),
                                       Isometry3d::Identity(), false}};
  const auto ask = [&](const core::Accuracy& accuracy) {
    return toolProximity(blob, Isometry3d::Identity(), {Vector3d(0.3, 0.2, 0.1)}, accuracy);
  };
  EXPECT_LT(ask(core::Accuracy::greedy()).lower_bound, ask(core::Accuracy::greedy()).upper_bound);
  EXPECT_EQ(ask({}).lower_bound, ask({}).upper_bound);
}

TEST(ToolProximity, LeavesAMeshThatIsNotCalledConvexAsItIs) {
  RigidMesh blob{std::make_shared<const CollisionMesh>(test::blob(2)), Isometry3d::Identity(),
                 false};
  const auto ask = [&] {
    return toolProximity({blob}, Isometry3d::Identity(), {Vector3d(1, 1, 1)}, {});
  };
  EXPECT_TRUE(ask().triangle_of_first.has_value());
  blob.convex = true;
  EXPECT_FALSE(ask().triangle_of_first.has_value());
}

/// A jaw with two prongs, and what comes into its opening.
TEST(ToolProximity, FillsTheHollowOfAMeshThatIsCalledConvexWhereItTouchesToo) {
  Points points;
  std::vector<core::Corners> triangles;
  for (const auto& [size, middle] : {std::pair(Vector3d(3, 1, 1), Vector3d(0, 0, 0)),
                                     std::pair(Vector3d(1, 1, 3), Vector3d(1, 0, 1)),
                                     std::pair(Vector3d(1, 1, 3), Vector3d(-1, 0, 1))}) {
    const core::TriangleMesh part = io::boxMesh(size);
    for (const core::Corners& corners : part.triangles()) {
      const std::size_t first = points.size();
      for (const core::VertexId corner : corners) points.push_back(part.position(corner) + middle);
      triangles.push_back(test::corners(first, first + 1, first + 2));
    }
  }
  const core::Shapes jaw = {
      RigidMesh{std::make_shared<const CollisionMesh>(core::TriangleMesh(points, triangles)),
                Isometry3d::Identity(), true}};
  for (const double aside : {1e-3, 1e-7, 0.0, -1e-7, -1e-3}) {
    const core::Shapes ball = {Sphere{{0, 0, 2.5 + aside}, 0.125}};
    const Proximity found = toolProximity(jaw, Isometry3d::Identity(), ball, {});
    EXPECT_NEAR(found.distance, aside - 0.125, kTight);
    EXPECT_TRUE(found.colliding);
  }
}

TEST(ToolProximity, AsksTheTrianglesIfOneIsNotConvex) {
  const RigidMesh open{std::make_shared<const CollisionMesh>(test::grid(2, 2)),
                       Isometry3d::Identity(), false};
  const RigidMesh above = box({1, 1, 1}, at(1, 1, 2));
  EXPECT_TRUE(toolProximity({open}, Isometry3d::Identity(), {above}, {}).triangle_of_first);
  EXPECT_TRUE(toolProximity({above}, Isometry3d::Identity(), {open}, {}).triangle_of_first);
}

TEST(ToolProximity, OfRoundShapesIsThatOfTheirCores) {
  std::mt19937 generator(94);
  for (std::size_t i = 0; i < queryCount(100); ++i) {
    const auto capsule = [&] {
      return Capsule{test::randomPoint(generator, 1.0), test::randomPoint(generator, 1.0), 0.125};
    };
    const Shape first = capsule();
    const Shape second = capsule();
    ASSERT_EQ(toolProximity({first}, Isometry3d::Identity(), {second}, {}).distance,
              core::proximity(first, second).distance);
  }
}

TEST(ToolProximity, OfAHullLeavesOutVerticesWithoutATriangle) {
  const core::TriangleMesh cube = test::cube();
  Points points = cube.positions();
  points.emplace_back(0, 0, 50);
  const RigidMesh mesh{
      std::make_shared<const CollisionMesh>(core::TriangleMesh(points, cube.triangles())),
      Isometry3d::Identity(), true};
  EXPECT_NEAR(
      toolProximity({mesh}, Isometry3d::Identity(), {Sphere{{0.5, 0.5, 10}, 1}}, {}).distance, 8.0,
      1e-9);
}

}  // namespace
}  // namespace organ_collision::convex
