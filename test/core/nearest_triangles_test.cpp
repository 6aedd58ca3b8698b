#include "organ_collision/core/nearest_triangles.h"

#include <gmock/gmock.h>

#include <limits>
#include <stdexcept>

#include "organs_and_tips.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(NearestTriangles, AreThoseOfThePointsInTheirOrder) {
  std::mt19937 generator(37);
  for (const CollisionMesh& organ : test::organs()) {
    Points points(test::queryCount(1000));
    for (Eigen::Vector3d& point : points) point = test::randomTip(generator, organ);
    for (const Accuracy& accuracy : {Accuracy::exact(), Accuracy::greedy()}) {
      const std::vector<NearestTriangle> all = nearestTriangles(organ, points, accuracy);
      ASSERT_EQ(all.size(), points.size());
      for (std::size_t i = 0; i < points.size(); ++i) {
        const NearestTriangle one = nearestTriangle(organ, points[i], accuracy);
        ASSERT_EQ(all[i].triangle, one.triangle);
        ASSERT_EQ(all[i].distance, one.distance);
        ASSERT_EQ(all[i].closest.point, one.closest.point);
      }
    }
  }
}

TEST(NearestTriangles, OfNoPointsAreNone) {
  EXPECT_TRUE(nearestTriangles(CollisionMesh(test::cube()), {}).empty());
}

TEST(NearestTriangles, NamesThePointThatIsNotUsable) {
  const CollisionMesh organ(test::cube());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(
      [&] {
        nearestTriangles(organ, {{0, 0, 0}, {0, nan, 0}});
      },
      ThrowsMessage<std::invalid_argument>(HasSubstr("point 1")));
}

TEST(NearestTriangles, RefusesAnAccuracyThatIsNotUsableOfNoPointsToo) {
  EXPECT_THROW(nearestTriangles(CollisionMesh(test::cube()), {}, {-1.0}), std::invalid_argument);
}

}  // namespace
}  // namespace organ_collision::core
