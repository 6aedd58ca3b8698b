#include "node/organ.h"

#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <future>
#include <limits>
#include <map>
#include <mutex>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "deformations.h"
#include "node/moves.h"
#include "test_meshes.h"

namespace organ_collision::node {
namespace {

using core::Accuracy;
using core::Points;
using test::movesOf;
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
    const core::NearestTriangle tracked = tracker.nearestTriangle(now->organ, now->motion(), tip);
    const core::NearestTriangle searched = core::nearestTriangle(now->organ, tip);
    ASSERT_EQ(tracked.distance, searched.distance);
    ASSERT_EQ(tracked.triangle, searched.triangle);
  }
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
  EXPECT_EQ(heightOfTop(organ), 2.0);
  organ.replace(test::blob(2), 0);
  EXPECT_EQ(organ.snapshot()->organ.mesh().triangleCount(), 128U);
  for (const double z : {1.0, 2.0, 3.0}) {
    organ.update({{}, test::blob(2).positions()}, UpdateMode::kRefit, 0);
    organ.update(movesOf({65}, {{0, 0, z}}), UpdateMode::kRefit, 0);
    EXPECT_EQ(organ.snapshot()->organ.mesh().positions()[65].z(), z);
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

// ---- rebuilds

/// Asks a thousand questions around the organ's present surface.
void ask(Organ& organ, const Accuracy& accuracy) {
  std::mt19937 generator(61);
  const auto snapshot = organ.snapshot();
  const core::TriangleMesh& mesh = snapshot->organ.mesh();
  for (int i = 0; i < 1024; ++i) {
    const auto triangle = static_cast<core::TriangleId>(generator() % mesh.triangleCount());
    const Eigen::Vector3d tip =
        core::centroid(mesh.triangle(triangle)) + test::randomPoint(generator, 0.005);
    organ.account(core::nearestTriangle(snapshot->organ, tip, accuracy), accuracy);
  }
}

/// Crushed along x: splits across it part nothing any more.
Points crushed(Points points) {
  for (Eigen::Vector3d& point : points) point.x() *= 0.01;
  return points;
}

TEST(Organ, RebuildsInTheBackgroundWhenQueriesHaveLostEnough) {
  Organ organ("liver", "liver_frame", test::blob(4));
  const auto signal = std::make_shared<Signal>();
  organ.setSignal(signal);
  organ.enqueue({{}, crushed(test::blob(4).positions())});
  organ.work();
  EXPECT_EQ(organ.builds().count, 1U);
  int rounds = 0;
  while (organ.builds().count == 1) {
    ASSERT_LT(++rounds, 1000000);
    ask(organ, Accuracy::exact());
    signal->wait();  // raised by the queries, and by the rebuild that is ready
    organ.work();
    EXPECT_TRUE(rounds > 1 || organ.costRatio() > 1.0);
  }
  EXPECT_EQ(organ.snapshot()->last_action, Action::kRebuild);
  EXPECT_EQ(organ.snapshot()->version, 2U);
  EXPECT_THAT(organ.snapshot()->reason, HasSubstr("queries lost"));
  EXPECT_THAT(organ.builds().reason, HasSubstr("queries lost"));
  EXPECT_THAT(organ.builds().figures, HasSubstr("lost 0.0 ms"));
  EXPECT_EQ(organ.costRatio(), 1.0);
}

/// Keeps rebuilds waiting until it is let go.
class BusyBackground {
 public:
  BusyBackground() {
    thread_->run([released = let_go_.get_future().share()] { released.wait(); });
  }
  void letGo() { let_go_.set_value(); }

 private:
  const std::shared_ptr<BackgroundThread> thread_ = BackgroundThread::shared();
  std::promise<void> let_go_;
};

/// Flattens the organ and asks until it is to be rebuilt; returns what the last update answered.
std::string wearOut(Organ& organ) {
  organ.update({{}, crushed(organ.snapshot()->organ.mesh().positions())}, UpdateMode::kAuto, 0);
  std::string reason;
  for (int round = 0; round < 100000 && reason.find("rebuilding") == std::string::npos; ++round) {
    ask(organ, Accuracy::greedy());
    reason = organ.update({}, UpdateMode::kAuto, 0).reason;
  }
  return reason;
}

TEST(Organ, SaysInItsAnswerThatItRebuildsAndWhy) {
  Organ organ("liver", "liver_frame", test::blob(4));
  EXPECT_THAT(wearOut(organ), HasSubstr("rebuilding in the background: queries lost"));
}

TEST(Organ, CatchesUpWithWhatMovedDuringARebuildBeforeItIsSwappedIn) {
  BusyBackground busy;
  Organ organ("liver", "liver_frame", test::blob(4));
  const auto signal = std::make_shared<Signal>();
  organ.setSignal(signal);
  wearOut(organ);
  signal->wait();  // the queries raised it
  Points expected = organ.snapshot()->organ.mesh().positions();
  for (const std::size_t vertex : {3, 700, 3}) {
    expected[vertex].z() += 0.01;
    organ.update(movesOf({vertex}, {expected[vertex]}), UpdateMode::kRefit, 0);
  }
  EXPECT_EQ(organ.snapshot()->version, 5U);
  EXPECT_EQ(organ.builds().count, 1U);
  busy.letGo();
  signal->wait();  // the rebuild is ready
  EXPECT_TRUE(organ.work());
  EXPECT_EQ(organ.builds().count, 2U);
  EXPECT_EQ(organ.snapshot()->version, 5U);
  EXPECT_EQ(organ.snapshot()->organ.mesh().positions(), expected);
}

TEST(Organ, ANewTopologyIsNotOverwrittenByARebuildOfTheFormer) {
  BusyBackground busy;
  Organ organ("liver", "liver_frame", test::blob(4));
  wearOut(organ);
  organ.replace(test::cube(), 0);
  busy.letGo();
  organ.update({}, UpdateMode::kRebuild, 0);  // after the former one has ended
  EXPECT_EQ(organ.snapshot()->organ.mesh().triangleCount(), 12U);
  EXPECT_EQ(organ.builds().count, 3U);
  EXPECT_EQ(heightOfTop(organ), 1.0);
}

TEST(Organ, IsNotRebuiltForQueriesWhereNothingHasMoved) {
  Organ organ("liver", "liver_frame", test::blob(3));
  for (int round = 0; round < 50; ++round) {
    ask(organ, Accuracy::greedy());
    organ.work();
  }
  EXPECT_EQ(organ.costRatio(), 1.0);
  EXPECT_THAT(organ.builds().figures, HasSubstr("lost 0.0 ms"));
}

TEST(Organ, NeitherStreamsNorUpdatesWaitForARebuildThatSomebodyWaitsFor) {
  BusyBackground busy;
  Organ organ = cube();
  auto rebuilder =
      std::async(std::launch::async, [&] { organ.update({}, UpdateMode::kRebuild, 0); });
  ASSERT_EQ(rebuilder.wait_for(std::chrono::milliseconds(20)), std::future_status::timeout);
  auto updates = std::async(std::launch::async, [&] {
    organ.enqueue(movesOf({0}, {{0, 0, -1}}));
    organ.work();
    organ.update(movesOf({1}, {{1, 0, -1}}), UpdateMode::kAuto, 0);
    organ.replace(test::cube(), 3);
  });
  EXPECT_EQ(updates.wait_for(std::chrono::seconds(10)), std::future_status::ready);
  EXPECT_EQ(rebuilder.wait_for(std::chrono::seconds(0)), std::future_status::timeout);
  busy.letGo();
}

TEST(Organ, ARebuildThatIsAskedForBeginsAfterTheMovesThatItWasAskedWith) {
  Organ organ("liver", "liver_frame", test::blob(5));
  std::thread other([&] { organ.update({}, UpdateMode::kRebuild, 0); });
  const Points flat = crushed(test::blob(5).positions());
  const auto applied = organ.update({{}, flat}, UpdateMode::kRebuild, 0);
  EXPECT_EQ(applied.version, 2U);
  const core::CollisionMesh fresh(core::TriangleMesh(flat, test::blob(5).triangles()));
  const auto now = organ.snapshot();
  for (core::FarthestPairTree::Leaf leaf = 0; leaf < fresh.tree().root().size(); ++leaf)
    ASSERT_EQ(now->organ.tree().triangle(leaf), fresh.tree().triangle(leaf));
  other.join();
}

// ---- all at once

/// Any kind of update in any order, with readers that linger: always the same positions.
TEST(Organ, LeadsToTheSameAnswersByWhateverKindOfUpdate) {
  std::mt19937 generator(62);
  const core::TriangleMesh mesh = test::blob(3);
  Organ organ("liver", "liver_frame", mesh);
  Points expected = mesh.positions();
  std::vector<std::shared_ptr<const OrganSnapshot>> lingering(3);
  std::set<Action> actions;
  for (int i = 0; i < 300; ++i) {
    const test::Deformation deformation =
        test::randomDeformation(generator, mesh.positions(), expected);
    const VertexMoves moves = {deformation.vertices, deformation.positions};
    deformation.apply(expected);
    lingering[generator() % lingering.size()] = organ.snapshot();
    switch (generator() % 5) {
      case 0:
        organ.enqueue(moves);
        organ.work();
        break;
      case 1:
        organ.update(moves, UpdateMode::kRebuild, 0);
        break;
      case 2:
        organ.replace({expected, mesh.triangles()}, 0);
        break;
      default:
        organ.update(moves, UpdateMode::kAuto, 0);
    }
    const auto now = organ.snapshot();
    ASSERT_EQ(now->version, i + 2U);
    ASSERT_EQ(now->organ.mesh().positions(), expected);
    ASSERT_NO_FATAL_FAILURE(
        test::expectBruteForce(now->organ, test::tipAround(generator, now->organ)));
    actions.insert(now->last_action);
  }
  EXPECT_EQ(actions, (std::set<Action>{Action::kRefit, Action::kPartialRefit, Action::kRebuild}));
}

/// TEST_SECONDS in the environment (scripts/soak asks for a minute), else half a second.
std::chrono::duration<double> timeForAllAtOnce() {
  const char* wanted = std::getenv("TEST_SECONDS");
  return std::chrono::duration<double>(wanted == nullptr ? 0.5 : std::stod(wanted));
}

/// Whether a version always has the same geometry.
class Versions {
 public:
  void check(const OrganSnapshot& snapshot) {
    std::size_t sum = 0;
    for (const Eigen::Vector3d& point : snapshot.organ.mesh().positions()) {
      for (const double coordinate : point) sum = 31 * sum + std::hash<double>()(coordinate);
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    EXPECT_EQ(sums_.try_emplace(snapshot.version, sum).first->second, sum) << snapshot.version;
  }
  std::size_t seen() const { return sums_.size(); }

 private:
  std::mutex mutex_;
  std::map<std::uint32_t, std::size_t> sums_;
};

/// Queries, streams, services, new topologies and rebuilds.
TEST(Organ, AnswersRightlyForTheVersionThatItNamesWhateverHappensAtOnce) {
  constexpr std::uint64_t kBuilds = 2;  // and more must be seen
  const std::vector<core::TriangleMesh> meshes = {test::blob(3), test::blob(2)};
  Organ organ("liver", "liver_frame", meshes[0]);
  const auto signal = std::make_shared<Signal>();
  organ.setSignal(signal);
  std::atomic<bool> stop{false};
  Versions versions;
  std::vector<std::thread> threads;
  std::uint32_t seed = 0;
  const auto repeat = [&](auto&& work) {
    threads.emplace_back([&stop, work, generator = std::mt19937(++seed)]() mutable {
      while (!stop) work(generator);
    });
  };
  const auto anyMoves = [&organ, &meshes](std::mt19937& generator) -> VertexMoves {
    const auto now = organ.snapshot();
    const core::TriangleMesh& mesh = now->organ.mesh();
    const bool is_first = mesh.triangleCount() == meshes[0].triangleCount();
    auto [kind, vertices, positions] =
        test::randomDeformation(generator, meshes[is_first ? 0 : 1].positions(), mesh.positions());
    return {vertices, positions};
  };
  for (int i = 0; i < 2; ++i) {
    repeat([&, last_version = 0U](std::mt19937& generator) mutable {
      const auto now = organ.snapshot();
      EXPECT_GE(now->version, last_version);
      last_version = now->version;
      const Eigen::Vector3d tip = test::tipAround(generator, now->organ);
      test::expectBruteForce(now->organ, tip);
      versions.check(*now);
      organ.account(core::nearestTriangle(now->organ, tip, Accuracy::greedy()), Accuracy::greedy());
    });
  }
  const auto unlessRefused = [](auto&& update) {
    try {
      update();
    } catch (const std::invalid_argument&) {  // another was faster: the version or topology is gone
    }
  };
  repeat([&](std::mt19937& generator) {
    unlessRefused([&] { organ.enqueue(anyMoves(generator)); });
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  });
  repeat([&](std::mt19937& generator) {
    const auto mode = static_cast<UpdateMode>(generator() % 3);
    const std::uint32_t expected = generator() % 2 == 0 ? organ.snapshot()->version : 0;
    unlessRefused([&] {
      if (generator() % 20 == 0) {
        organ.replace(meshes[generator() % 2], expected);
      } else {
        organ.update(anyMoves(generator), mode, expected);
      }
    });
    organ.builds();
    organ.counters();
  });
  std::thread worker([&] {
    while (!stop) {
      signal->wait();
      organ.work();
    }
  });
  std::this_thread::sleep_for(timeForAllAtOnce());
  // The background thread has to wait for all others, long on a single processor.
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::minutes(1);
  while (organ.builds().count <= kBuilds && std::chrono::steady_clock::now() < deadline)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  stop = true;
  signal->raise();
  for (std::thread& thread : threads) thread.join();
  worker.join();
  EXPECT_GT(versions.seen(), 10U);
  EXPECT_GT(organ.builds().count, kBuilds);
}

}  // namespace
}  // namespace organ_collision::node
