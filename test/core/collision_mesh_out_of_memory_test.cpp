#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>

#include "brute_force.h"
#include "failing_memory.h"
#include "organ_collision/core/collision_mesh.h"
#include "organ_collision/core/nearest_triangle.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

/// Whatever part of a refit was done: also where the moved vertex leaves the unit frame.
TEST(CollisionMeshOutOfMemory, AnswersRightWhenARefitIsRepeated) {
  const TriangleMesh mesh = test::blob(4);
  for (const double distance : {1.1, 100.0}) {
    const Points place = {{distance, 0.0, 0.0}};
    std::unique_ptr<CollisionMesh> organ;
    const auto refit = [&] { organ->refit({VertexId{0}}, place); };
    test::failEachAllocation(
        [&] { organ = std::make_unique<CollisionMesh>(mesh); }, refit,
        [&](bool failed) {
          if (failed) refit();
          std::mt19937 generator(5);
          for (int i = 0; i < 20; ++i) {
            const Eigen::Vector3d tip = test::randomPoint(generator, 2.0);
            ASSERT_EQ(std::abs(nearestTriangle(*organ, tip).distance),
                      std::sqrt(test::squaredDistanceByBruteForce(organ->mesh(), tip)));
          }
        });
  }
}

}  // namespace
}  // namespace organ_collision::core
