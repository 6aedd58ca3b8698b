#include "node/organ.h"

#include <gmock/gmock.h>
#include <tbb/task_arena.h>
#include <tbb/task_scheduler_observer.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <fstream>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

#include "allocated_memory.h"
#include "node/cube_organ.h"
#include "node/moves.h"
#include "organ_collision/core/tracking.h"
#include "test_meshes.h"

namespace organ_collision::node {
namespace {

using core::Points;
using test::movesOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

Points lifted(double height) {
  Points points = test::cube().positions();
  for (Eigen::Vector3d& point : points) point.z() += height;
  return points;
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
  EXPECT_EQ(after.version, 2U);
  EXPECT_EQ(after.action, Action::kRefit);
  EXPECT_EQ(heightOfTop(organ), 2.0);
  EXPECT_EQ(before->organ.mesh().positions(), test::cube().positions());
}

TEST(Organ, MovesSingleVertices) {
  Organ organ = cube();
  const auto applied = organ.update(movesOf({7, 4}, {{1, 1, 3}, {0, 0, 3}}), UpdateMode::kRefit, 0);
  EXPECT_EQ(applied.action, Action::kPartialRefit);
  EXPECT_THAT(applied.reason, HasSubstr("2 of 8 vertices moved"));
  const Points& now = organ.snapshot()->organ.mesh().positions();
  EXPECT_EQ(now[7], Eigen::Vector3d(1, 1, 3));
  EXPECT_EQ(now[4], Eigen::Vector3d(0, 0, 3));
  EXPECT_EQ(now[5], test::cube().positions()[5]);
}

/// Counts the threads that come to share what this one does.
class Helpers : public tbb::task_scheduler_observer {
 public:
  Helpers() { observe(true); }
  ~Helpers() override { observe(false); }
  void on_scheduler_entry(bool is_helper) override { entries += is_helper ? 1 : 0; }

  std::atomic<int> entries{0};
};

TEST(Organ, RefitsOnOneProcessor) {
  if (tbb::this_task_arena::max_concurrency() == 1) GTEST_SKIP() << "there is no other";
  const core::TriangleMesh mesh = test::blob(6);
  const VertexMoves out_of_the_box = movesOf({0}, {3.0 * mesh.positions()[0]});
  core::CollisionMesh alike(mesh);
  Helpers helpers;
  for (int i = 0; i < 20; ++i) {
    Organ organ("liver", "liver", mesh);
    helpers.entries = 0;
    const auto some = organ.update(out_of_the_box, UpdateMode::kRefit, 0);
    const auto all = organ.update({{}, mesh.positions()}, UpdateMode::kRefit, 0);
    ASSERT_EQ(helpers.entries, 0);
    ASSERT_EQ(some.action, Action::kPartialRefit);
    ASSERT_EQ(all.action, Action::kRefit);
  }
  for (int i = 0; i < 1000 && helpers.entries == 0; ++i) alike.refit(mesh.positions());
  EXPECT_GT(helpers.entries, 0) << "nor are refits shared that may be";
}

TEST(Organ, TellsATrackerHowFarItsVerticesMovedAndWhenItsSplitsAreOthers) {
  Organ organ("liver", "liver", test::blob(4));
  core::Tracker tracker;
  std::mt19937 generator(36);
  const Eigen::Vector3d tip(0.06, 0.06, 0.06);
  for (int i = 0; i < 100; ++i) {
    core::Points positions = organ.snapshot()->organ.mesh().positions();
    const auto moves = generator() % 3;
    if (moves == 0) {
      for (Eigen::Vector3d& position : positions) position += test::randomPoint(generator, 0.002);
      organ.update({{}, positions}, UpdateMode::kRefit, 0);
    } else {
      const auto vertex = static_cast<core::VertexId>(generator() % positions.size());
      const Eigen::Vector3d to = organ.snapshot()->organ.mesh().position(vertex) * 1.2;
      organ.update({{vertex}, {to}}, i % 10 == 9 ? UpdateMode::kRebuild : UpdateMode::kRefit, 0);
    }
    const std::shared_ptr<const OrganSnapshot> now = organ.snapshot();
    const core::NearestTriangle tracked = tracker.nearestTriangle(now->organ, now->travel, tip);
    const core::NearestTriangle searched = core::nearestTriangle(now->organ, tip);
    ASSERT_EQ(tracked.distance, searched.distance);
    ASSERT_EQ(tracked.triangle, searched.triangle);
  }
}

TEST(Organ, TriesAPartialRefitAndKeepsToWhatHasCostLess) {
  Organ organ("liver", "liver_frame", test::blob(5));
  // All but one: one by one they cost far more.
  VertexMoves moves = {{}, organ.snapshot()->organ.mesh().positions()};
  moves.positions.pop_back();
  for (std::size_t i = 0; i < moves.positions.size(); ++i)
    moves.vertices.push_back(static_cast<core::VertexId>(i));
  const Organ::Applied first = organ.update(moves, UpdateMode::kAuto, 0);
  EXPECT_EQ(first.action, Action::kPartialRefit);
  EXPECT_THAT(first.reason, HasSubstr("is to be tried"));
  const Organ::Applied second = organ.update(moves, UpdateMode::kAuto, 0);
  EXPECT_EQ(second.action, Action::kRefit) << second.reason;
  EXPECT_THAT(second.reason, HasSubstr("a full one"));
  organ.replace(test::blob(5), 0);  // what the former mesh cost says nothing of this one
  EXPECT_THAT(organ.update(moves, UpdateMode::kAuto, 0).reason, HasSubstr("is to be tried"));
}

TEST(Organ, RebuildAloneDoesNotRaiseTheVersion) {
  Organ organ = cube();
  organ.update({{}, lifted(1.0)}, UpdateMode::kRefit, 0);
  const auto rebuilt = organ.update({}, UpdateMode::kRebuild, 0);
  EXPECT_EQ(rebuilt.version, 2U);
  EXPECT_EQ(rebuilt.action, Action::kRebuild);
  EXPECT_EQ(organ.snapshot()->last_action, Action::kRebuild);
}

TEST(Organ, NothingToDoIsNone) {
  Organ organ = cube();
  EXPECT_EQ(organ.update({}, UpdateMode::kAuto, 0).action, Action::kNone);
  EXPECT_EQ(organ.snapshot()->last_action, Action::kLoad);
}

TEST(Organ, TakesANewTopology) {
  Organ organ = cube();
  const auto replaced = organ.replace(test::cube(2.0), 1);
  EXPECT_EQ(replaced.version, 2U);
  EXPECT_EQ(replaced.action, Action::kRebuild);
  EXPECT_EQ(replaced.reason, "new topology");
  EXPECT_EQ(organ.snapshot()->version, 2U);
  EXPECT_EQ(heightOfTop(organ), 2.0);
  organ.replace(test::blob(2), 0);
  EXPECT_EQ(organ.snapshot()->organ.mesh().triangleCount(), 128U);
  for (const double z : {1.0, 2.0, 3.0}) {
    organ.update({{}, test::blob(2).positions()}, UpdateMode::kRefit, 0);
    organ.update(movesOf({65}, {{0, 0, z}}), UpdateMode::kRefit, 0);
    EXPECT_EQ(organ.snapshot()->organ.mesh().positions()[65].z(), z);
  }
}

TEST(Organ, KeepsNoMemoryOfAMeshThatWasReplaced) {
  const core::TriangleMesh large = test::blob(6);
  const std::size_t before = test::allocatedMemory();
  Organ organ("liver", "liver_frame", large);
  const std::size_t of_one = organ.snapshot()->organ.memory();
  for (int i = 0; i < 3; ++i) organ.update({{}, crushed(large.positions())}, UpdateMode::kRefit, 0);
  auto reader = organ.snapshot();
  organ.replace(test::cube(), 0);
  EXPECT_LT(test::allocatedMemory(), before + of_one + of_one / 2) << "but for what is read";
  reader.reset();
  organ.work();
  EXPECT_LT(test::allocatedMemory(), before + of_one / 2);
}

TEST(Organ, HasTravelledNoLessThanItsVerticesMovedTogether) {
  Organ organ = cube();
  long double travel = 0.0L;
  for (int i = 1; i <= 1000; ++i) {
    const Points before = organ.snapshot()->organ.mesh().positions();
    organ.update(movesOf({0}, {{0.1 / i, 0, 0}}), UpdateMode::kRefit, 0);
    const long double from = before[0].x();
    travel += std::abs(organ.snapshot()->organ.mesh().positions()[0].x() - from);
    ASSERT_GE(organ.snapshot()->travel, travel) << i;
  }
}

TEST(Organ, RemembersMovesOfMoreVerticesThanTheFormerMeshHad) {
  Organ organ = cube();
  organ.replace(test::blob(2), 0);
  const VertexMoves moves = movesOf({0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, Points(10, {0, 0, 0.1}));
  for (const std::uint32_t version : {3, 4, 5}) {
    const auto applied = organ.update(moves, UpdateMode::kRefit, 0);
    EXPECT_EQ(applied.version, version);
    EXPECT_THAT(applied.reason, HasSubstr("a partial refit")) << "what was missed is known";
  }
}

TEST(Organ, RefusesWholeWhatDoesNotFitAndKeepsAnswering) {
  Organ organ = cube();
  const Eigen::Vector3d p(0, 0, 0);
  const Eigen::Vector3d nan(0, std::numeric_limits<double>::quiet_NaN(), 0);
  const auto update = [&](const VertexMoves& moves) {
    return [&organ, moves] { organ.update(moves, UpdateMode::kAuto, 0); };
  };
  EXPECT_THAT(update({{}, {p}}), Refuses("1 positions given for 8 vertices"));
  EXPECT_THAT(update(movesOf({1, 2}, {p})), Refuses("1 positions given for 2 vertices"));
  EXPECT_THAT(update(movesOf({1, 8}, {p, p})), Refuses("index 8 names no vertex: there are 8"));
  EXPECT_THAT(update(movesOf({1, 1}, {p, p})), Refuses("index 1 is given twice"));
  EXPECT_THAT(update(movesOf({1, 5}, {p, nan})), Refuses("vertex 5"));
  EXPECT_THAT(
      [&] {
        organ.update({{}, lifted(1)}, UpdateMode::kAuto, 7);
      },
      Refuses("expected_version is 7"));
  EXPECT_THAT([&] { organ.replace(test::cube(), 7); }, Refuses("expected_version is 7"));
  EXPECT_THAT([&] { organ.enqueue(movesOf({9}, {p})); }, Refuses("index 9"));
  EXPECT_FALSE(organ.work());
  EXPECT_EQ(organ.snapshot()->version, 1U);
  EXPECT_EQ(heightOfTop(organ), 1.0);
}

/// [bytes] Of this process.
std::size_t residentMemory() {
  std::ifstream pages("/proc/self/statm");
  std::size_t all = 0;
  std::size_t resident = 0;
  pages >> all >> resident;
  return resident * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
}

TEST(Organ, GivesTheMemoryOfFormerTopologiesBack) {
  if (test::allocatedMemory() == 0) GTEST_SKIP() << "a sanitizer allocates";
  Organ organ = cube();
  const std::size_t before = residentMemory();
  for (int i = 0; i < 5; ++i) {
    organ.replace(test::blob(7), 0);
    organ.replace(test::cube(), 0);
  }
  EXPECT_LT(residentMemory(), before + 20'000'000);
}

// ---- streams

TEST(Organ, MergesStreamedUpdatesPerVertex) {
  Organ organ = cube();
  organ.enqueue(movesOf({0}, {{0, 0, -1}}));
  organ.enqueue(movesOf({1}, {{1, 0, -2}}));
  organ.enqueue(movesOf({0}, {{0, 0, -3}}));
  EXPECT_EQ(organ.counters().updates_merged, 2U);
  EXPECT_TRUE(organ.work());
  EXPECT_FALSE(organ.work());
  const Points& now = organ.snapshot()->organ.mesh().positions();
  EXPECT_EQ(now[0].z(), -3.0);
  EXPECT_EQ(now[1].z(), -2.0);
  EXPECT_EQ(organ.snapshot()->version, 2U);
}

TEST(Organ, AnUpdateTakesWithItWhatWasStreamedBefore) {
  Organ organ = cube();
  organ.enqueue(movesOf({0}, {{0, 0, -1}}));
  organ.update(movesOf({1}, {{1, 0, -2}}), UpdateMode::kAuto, 0);
  EXPECT_EQ(organ.snapshot()->organ.mesh().positions()[0].z(), -1.0);
  EXPECT_EQ(organ.snapshot()->organ.mesh().positions()[1].z(), -2.0);
}

TEST(Organ, WhatWasStreamedBeforeCountsForTheExpectedVersion) {
  Organ organ = cube();
  const auto update = [&organ] { organ.update({{}, lifted(1)}, UpdateMode::kAuto, 1); };
  organ.enqueue(movesOf({0}, {{0, 0, -1}}));
  EXPECT_THAT(update, Refuses("is at version 2"));
  organ.enqueue(movesOf({0}, {{0, 0, -1}}));
  EXPECT_THAT([&] { organ.replace(test::cube(), 2); }, Refuses("is at version 3"));
}

}  // namespace
}  // namespace organ_collision::node
