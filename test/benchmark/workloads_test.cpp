#include "workloads.h"

#include <gtest/gtest.h>

#include "organ_collision/core/nearest_triangle.h"
#include "organs.h"

namespace organ_collision::bench {
namespace {

constexpr std::size_t kCount = 2048;

TEST(Trajectory, WalksAlongTheSurfaceAndNeverStandsStill) {
  for (const char* name : {"blob@2", "blob@4", "liver"}) {
    SCOPED_TRACE(name);
    const core::CollisionMesh organ(inUnitsOfItsDiagonal(organNamed(name)));
    const core::Points tips = trajectory(organ, kCount, 5);
    ASSERT_EQ(tips.size(), kCount);
    double along = 0.0;  // of the nearest points
    core::NearestTriangle before = core::nearestTriangle(organ, tips.front());
    for (std::size_t i = 1; i < kCount; ++i) {
      EXPECT_NEAR((tips[i] - tips[i - 1]).norm(), 0.0006, 1e-12);
      const core::NearestTriangle now = core::nearestTriangle(organ, tips[i]);
      EXPECT_GE(now.distance, 0.0);
      EXPECT_LE(now.distance, 0.02);
      along += (now.closest.point - before.closest.point).norm();
      before = now;
    }
    EXPECT_GT(along, 0.8 * 0.0006 * kCount);
  }
}

TEST(Workloads, AreTheSameForTheSameSeed) {
  const core::CollisionMesh organ(inUnitsOfItsDiagonal(organNamed("blob@2")));
  const std::vector<Workload> one = workloads(organ, 100, 7);
  const std::vector<Workload> other = workloads(organ, 100, 7);
  ASSERT_EQ(one.size(), other.size());
  for (std::size_t i = 0; i < one.size(); ++i) EXPECT_EQ(one[i].tips, other[i].tips);
}

}  // namespace
}  // namespace organ_collision::bench
