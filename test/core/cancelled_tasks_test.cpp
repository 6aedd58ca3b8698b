#include <gtest/gtest.h>
#include <tbb/task_group.h>

#include <functional>
#include <optional>
#include <random>
#include <vector>

#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/nearest_triangles.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

/// As where another task of the caller's has thrown while this one runs: what belongs to the same
/// tasks is left out by oneTBB, without a word.
void inCancelledTask(const std::function<void()>& action) {
  tbb::task_group group;
  group.run([&] {
    group.cancel();
    action();
  });
  group.wait();
}

Points somePoints() {
  std::mt19937 generator(3);
  Points points(1000);
  for (Eigen::Vector3d& point : points) point = test::randomPoint(generator, 0.2);
  return points;
}

void expectSameAnswers(const CollisionMesh& organ, const CollisionMesh& expected) {
  for (const Eigen::Vector3d& point : somePoints())
    ASSERT_EQ(nearestTriangle(organ, point).distance, nearestTriangle(expected, point).distance);
}

/// Large enough to be worth several tasks.
TriangleMesh mesh() { return test::blob(6); }

TEST(CancelledTasks, DoNotKeepAMeshFromBeingBuilt) {
  std::optional<CollisionMesh> organ;
  inCancelledTask([&] { organ.emplace(mesh()); });
  const CollisionMesh expected(mesh());
  expectSameAnswers(*organ, expected);
  EXPECT_TRUE(organ->health().isSolid());
  EXPECT_EQ(organ->health().box.high, expected.health().box.high);
}

TEST(CancelledTasks, DoNotKeepAMeshFromBeingRefittedOrRebuilt) {
  CollisionMesh expected(mesh());
  Points moved = expected.mesh().positions();
  for (Eigen::Vector3d& position : moved) position = 1.5 * position + Eigen::Vector3d(0.01, 0, 0);
  CollisionMesh refitted = expected;
  inCancelledTask([&] { refitted.refit(moved); });
  CollisionMesh rebuilt = expected;
  inCancelledTask([&] {
    rebuilt.refit(moved);
    rebuilt.rebuild();
  });
  expected.refit(moved);
  expectSameAnswers(refitted, expected);
  expectSameAnswers(rebuilt, expected);
}

TEST(CancelledTasks, DoNotKeepManyPointsFromBeingAnswered) {
  const CollisionMesh organ(mesh());
  const Points points = somePoints();
  std::vector<NearestTriangle> answers;
  inCancelledTask([&] { answers = nearestTriangles(organ, points); });
  ASSERT_EQ(answers.size(), points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    ASSERT_EQ(answers[i].distance, nearestTriangle(organ, points[i]).distance);
}

}  // namespace
}  // namespace organ_collision::core
