#include "node/organ.h"

#include <gmock/gmock.h>

#include <atomic>
#include <limits>
#include <stdexcept>
#include <thread>

#include "test_meshes.h"

namespace organ_collision::node {
namespace {

using core::Points;
using testing::HasSubstr;
using testing::ThrowsMessage;

Organ cube() { return {"liver", "liver_frame", test::cube()}; }

Points lifted(double height) {
  Points points = test::cube().positions();
  for (Eigen::Vector3d& point : points) point.z() += height;
  return points;
}

double heightOfTop(const Organ& organ) {
  return 10.0 -
         core::nearestTriangle(organ.snapshot()->organ, Eigen::Vector3d(0.5, 0.5, 10.0)).distance;
}

auto Refuses(const char* reason) { return ThrowsMessage<std::invalid_argument>(HasSubstr(reason)); }

TEST(Organ, StartsAtVersionOne) {
  Organ organ = cube();
  EXPECT_EQ(organ.snapshot()->version, 1U);
  EXPECT_EQ(organ.snapshot()->last_action, Action::kLoad);
}

TEST(Organ, UpdateIsSeenByEveryLaterQueryAndByNoEarlierSnapshot) {
  Organ organ = cube();
  const auto before = organ.snapshot();
  const auto after = organ.update({{}, lifted(1.0)}, UpdateMode::kAuto, 0);
  EXPECT_EQ(after->version, 2U);
  EXPECT_EQ(after->last_action, Action::kRefit);
  EXPECT_EQ(heightOfTop(organ), 2.0);
  EXPECT_EQ(before->organ.mesh().positions(), test::cube().positions());
}

TEST(Organ, MovesSingleVertices) {
  Organ organ = cube();
  organ.update({{7, 4}, {{1, 1, 3}, {0, 0, 3}}}, UpdateMode::kRefit, 0);
  const Points& now = organ.snapshot()->organ.mesh().positions();
  EXPECT_EQ(now[7], Eigen::Vector3d(1, 1, 3));
  EXPECT_EQ(now[4], Eigen::Vector3d(0, 0, 3));
  EXPECT_EQ(now[5], test::cube().positions()[5]);
}

TEST(Organ, RebuildAloneDoesNotRaiseTheVersion) {
  Organ organ = cube();
  organ.update({{}, lifted(1.0)}, UpdateMode::kRefit, 0);
  const auto rebuilt = organ.update({}, UpdateMode::kRebuild, 0);
  EXPECT_EQ(rebuilt->version, 2U);
  EXPECT_EQ(rebuilt->last_action, Action::kRebuild);
  EXPECT_EQ(organ.snapshot()->last_action, Action::kRebuild);
}

TEST(Organ, NothingToDoIsNone) {
  Organ organ = cube();
  EXPECT_EQ(organ.update({}, UpdateMode::kAuto, 0)->last_action, Action::kNone);
  EXPECT_EQ(organ.snapshot()->last_action, Action::kLoad);
}

TEST(Organ, TakesANewTopology) {
  Organ organ = cube();
  const auto replaced = organ.replace(test::cube(2.0), 1);
  EXPECT_EQ(replaced->version, 2U);
  EXPECT_EQ(heightOfTop(organ), 2.0);
  organ.replace(test::blob(2), 0);
  EXPECT_EQ(organ.snapshot()->organ.mesh().triangleCount(), 128U);
}

TEST(Organ, RefusesWholeWhatDoesNotFitAndKeepsAnswering) {
  Organ organ = cube();
  const Eigen::Vector3d p(0, 0, 0);
  const Eigen::Vector3d nan(0, std::numeric_limits<double>::quiet_NaN(), 0);
  const auto update = [&](const VertexMoves& moves) {
    return [&organ, moves] { organ.update(moves, UpdateMode::kAuto, 0); };
  };
  EXPECT_THAT(update({{}, {p}}), Refuses("1 positions given for 8 vertices"));
  EXPECT_THAT(update({{1, 2}, {p}}), Refuses("1 positions given for 2 vertices"));
  EXPECT_THAT(update({{1, 8}, {p, p}}), Refuses("index 8 names no vertex: there are 8"));
  EXPECT_THAT(update({{1, 1}, {p, p}}), Refuses("index 1 is given twice"));
  EXPECT_THAT(update({{1, 5}, {p, nan}}), Refuses("vertex 5"));
  EXPECT_THAT(
      [&] {
        organ.update({{}, lifted(1)}, UpdateMode::kAuto, 7);
      },
      Refuses("expected_version is 7"));
  EXPECT_THAT([&] { organ.replace(test::cube(), 7); }, Refuses("expected_version is 7"));
  EXPECT_THAT([&] { organ.enqueue({{9}, {p}}); }, Refuses("index 9"));
  EXPECT_FALSE(organ.applyEnqueued());
  EXPECT_EQ(organ.snapshot()->version, 1U);
  EXPECT_EQ(heightOfTop(organ), 1.0);
}

TEST(Organ, MergesStreamedUpdatesPerVertex) {
  Organ organ = cube();
  organ.enqueue({{0}, {{0, 0, -1}}});
  organ.enqueue({{1}, {{1, 0, -2}}});
  organ.enqueue({{0}, {{0, 0, -3}}});
  EXPECT_EQ(organ.counters().updates_merged, 2U);
  EXPECT_TRUE(organ.applyEnqueued());
  EXPECT_FALSE(organ.applyEnqueued());
  const Points& now = organ.snapshot()->organ.mesh().positions();
  EXPECT_EQ(now[0].z(), -3.0);
  EXPECT_EQ(now[1].z(), -2.0);
  EXPECT_EQ(organ.snapshot()->version, 2U);
}

TEST(Organ, AnUpdateTakesWithItWhatWasStreamedBefore) {
  Organ organ = cube();
  organ.enqueue({{0}, {{0, 0, -1}}});
  organ.update({{1}, {{1, 0, -2}}}, UpdateMode::kAuto, 0);
  EXPECT_EQ(organ.snapshot()->organ.mesh().positions()[0].z(), -1.0);
  EXPECT_EQ(organ.snapshot()->organ.mesh().positions()[1].z(), -2.0);
}

TEST(Organ, CostRatioComparesWithTheFreshHierarchy) {
  Organ organ = cube();
  EXPECT_EQ(organ.costRatio(), 1.0);
  organ.account(*organ.snapshot(), {10, 10});
  EXPECT_EQ(organ.costRatio(), 1.0);
  organ.update({{}, lifted(1.0)}, UpdateMode::kRefit, 0);
  organ.account(*organ.snapshot(), {20, 40});
  EXPECT_EQ(organ.costRatio(), 3.0);
  organ.update({}, UpdateMode::kRebuild, 0);
  EXPECT_EQ(organ.costRatio(), 1.0);
}

TEST(Organ, QueriesSeeWholeMeshesWhileItIsUpdatedFromAllSides) {
  Organ organ("liver", "liver_frame", test::blob(3));
  const Points original = organ.snapshot()->organ.mesh().positions();
  const auto scaled = [&original](double factor) {
    Points points = original;
    for (Eigen::Vector3d& point : points) point *= factor;
    return points;
  };
  std::atomic<bool> stop{false};
  std::thread streamer([&] {
    for (int i = 1; i <= 200; ++i) organ.enqueue({{}, scaled(1.0 + i)});
    stop = true;
  });
  std::thread applier([&] {
    while (!stop) organ.applyEnqueued();
  });
  std::thread rebuilder([&] {
    while (!stop) organ.update({}, UpdateMode::kRebuild, 0);
  });
  std::uint32_t last_version = 0;
  while (!stop) {
    const auto snapshot = organ.snapshot();
    const Points& now = snapshot->organ.mesh().positions();
    const double factor = now[0].norm() / original[0].norm();
    EXPECT_NEAR(now.back().norm(), factor * original.back().norm(), 1e-12 * factor);
    EXPECT_GE(snapshot->version, last_version);
    last_version = snapshot->version;
  }
  streamer.join();
  applier.join();
  rebuilder.join();
  organ.applyEnqueued();
  EXPECT_EQ(organ.snapshot()->organ.mesh().positions(), scaled(201.0));
}

}  // namespace
}  // namespace organ_collision::node
