#include "node/surface_check.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <limits>
#include <string>
#include <thread>

#include "node/moves.h"
#include "node/organ.h"
#include "node/stopwatch.h"
#include "organ_collision/core/self_intersections.h"
#include "test_meshes.h"

namespace organ_collision::node {
namespace {

using testing::HasSubstr;

const ros::SteadyTime kStart(100.0);

Organ ball() { return {"liver", "liver", test::blob(4)}; }

/// Drags a vertex through the organ to the other side, and back.
void cross(Organ& organ) {
  organ.update(test::movesOf({0}, {-2.0 * organ.snapshot()->organ.mesh().positions()[0]}),
               UpdateMode::kRefit, 0);
}
void uncross(Organ& organ) {
  organ.update(test::movesOf({0}, {-0.5 * organ.snapshot()->organ.mesh().positions()[0]}),
               UpdateMode::kRefit, 0);
}

/// Asks until the answer is as expected, or for `patience` [ms].
std::string askUntil(const std::function<bool(const std::string&)>& is_expected,
                     SurfaceCheck& check, const Organ& organ, const ros::SteadyTime& now,
                     int patience = 20000) {
  std::string told = check.complaint(organ.snapshot(), now);
  for (int i = 0; i < patience && !is_expected(told); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    told = check.complaint(organ.snapshot(), now);
  }
  return told;
}
bool isComplaint(const std::string& told) { return !told.empty(); }
bool isNone(const std::string& told) { return told.empty(); }

TEST(SurfaceCheck, TellsOfASurfaceThatCrossesItself) {
  Organ organ = ball();
  cross(organ);
  SurfaceCheck check;
  EXPECT_THAT(askUntil(isComplaint, check, organ, kStart), HasSubstr("cross or touch"));
}

TEST(SurfaceCheck, LooksAgainAsTheOrganDeformsButNotAllTheTime) {
  Organ organ = ball();
  cross(organ);
  SurfaceCheck check;
  askUntil(isComplaint, check, organ, kStart);
  uncross(organ);
  double duration = std::numeric_limits<double>::infinity();  // [s] of a look
  for (int i = 0; i < 5; ++i) {
    const Stopwatch watch;
    core::selfIntersections(organ.snapshot()->organ, 1000);
    duration = std::min(duration, watch.elapsed());
  }
  const ros::SteadyTime too_soon = kStart + ros::WallDuration(20.0 * duration);
  EXPECT_NE(askUntil(isNone, check, organ, too_soon, 50), "") << "a fifth of the time to wait";
  EXPECT_EQ(askUntil(isNone, check, organ, kStart + ros::WallDuration(3600.0)), "");
}

TEST(SurfaceCheck, LooksAtOnceAtWhatWasBuilt) {
  Organ organ = ball();
  cross(organ);
  SurfaceCheck check;
  askUntil(isComplaint, check, organ, kStart);
  organ.replace(test::blob(4), 0);
  EXPECT_EQ(askUntil(isNone, check, organ, kStart), "");
}

TEST(SurfaceCheck, SaysNothingOfASurfaceWithoutAnInside) {
  core::Points points = test::grid(4, 4).positions();
  points[0] += Eigen::Vector3d(3.1, 2.2, 0.0);
  Organ organ("sheet", "sheet", {points, test::grid(4, 4).triangles()});
  ASSERT_FALSE(core::selfIntersections(organ.snapshot()->organ, 1).pairs.empty());
  SurfaceCheck check;
  EXPECT_EQ(askUntil(isComplaint, check, organ, kStart, 200), "");
}

TEST(SurfaceCheck, KeepsNoSnapshotOnceItHasLooked) {
  Organ organ = ball();
  cross(organ);
  SurfaceCheck check;
  std::shared_ptr<const OrganSnapshot> snapshot = organ.snapshot();
  const auto others = snapshot.use_count();
  askUntil(isComplaint, check, organ, kStart);
  EXPECT_EQ(snapshot.use_count(), others);
}

}  // namespace
}  // namespace organ_collision::node
