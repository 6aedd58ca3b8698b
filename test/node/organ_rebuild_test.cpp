#include <gmock/gmock.h>

#include <chrono>
#include <future>
#include <memory>
#include <random>
#include <string>
#include <thread>

#include "node/cube_organ.h"
#include "node/moves.h"
#include "node/organ.h"
#include "test_meshes.h"

namespace organ_collision::node {
namespace {

using core::Accuracy;
using core::Points;
using test::movesOf;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

TEST(Organ, RebuildsInTheBackgroundWhenQueriesHaveLostEnough) {
  Organ organ("liver", "liver_frame", test::blob(4));
  const auto signal = std::make_shared<Signal>();
  organ.setSignal(signal);
  organ.enqueue({{}, crushed(test::blob(4).positions())});
  organ.work();
  EXPECT_EQ(organ.builds().count, 1U);
  int rounds = 0;
  while (organ.builds().count == 1) {
    ASSERT_LT(++rounds, 10000);
    ask(organ, Accuracy::exact());
    signal->wait();  // raised by the queries, and by the rebuild that is ready
    organ.work();
    EXPECT_TRUE(rounds > 1 || organ.costRatio() > 1.0);
  }
  EXPECT_EQ(organ.snapshot()->last_action, Action::kRebuild);
  EXPECT_EQ(organ.snapshot()->version, 2U);
  EXPECT_THAT(organ.snapshot()->reason, HasSubstr("queries lost"));
  EXPECT_THAT(organ.builds().reason, HasSubstr("queries lost"));
  EXPECT_THAT(organ.builds().figures,
              AllOf(HasSubstr("lost 0.0 ms"), Not(HasSubstr("a rebuild costs 0.0 ms"))));
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

/// [ms] That queries lost to wear, as told.
double lossToldBy(const Organ& organ) {
  const std::string figures = organ.builds().figures;
  return std::stod(figures.substr(figures.find_first_of("0123456789")));
}

/// How many times as much is told once there were eleven times as many queries; 0 where what was
/// told at first is not measurable.
double growthOfLossTold() {
  Organ organ("liver", "liver_frame", test::blob(4));
  organ.update({{}, crushed(organ.snapshot()->organ.mesh().positions())}, UpdateMode::kAuto, 0);
  const auto ask_and_work = [&](int rounds) {
    for (int i = 0; i < rounds; ++i) ask(organ, Accuracy::exact());
    organ.work();
  };
  ask_and_work(8);
  const double of_few = lossToldBy(organ);
  ask_and_work(80);
  EXPECT_LT(of_few, 8 * 1024 * 1.0) << "less than a millisecond each";
  return of_few > 0.0 ? lossToldBy(organ) / of_few : 0.0;
}

TEST(Organ, CountsWhatEachQueryLoses) {
  BusyBackground busy;
  double growth = 0.0;
  // What a query costs is measured, at times while others want the processor.
  for (int attempt = 0; attempt < 10 && growth < 4.0; ++attempt) growth = growthOfLossTold();
  busy.letGo();
  EXPECT_GE(growth, 4.0);
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
  EXPECT_EQ(organ.builds().count, 1U);
  EXPECT_EQ(organ.costRatio(), 1.0);
  EXPECT_THAT(organ.builds().figures, HasSubstr("lost 0.0 ms"));
}

TEST(Organ, IsSearchedWithAsLittleWorkAsAMeshThatIsOnlyBuilt) {
  const core::CollisionMesh built(test::blob(4));
  const Organ organ("liver", "liver_frame", test::blob(4));
  std::mt19937 generator(62);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector3d tip = test::randomPoint(generator, 2.0);
    ASSERT_EQ(core::nearestTriangle(organ.snapshot()->organ, tip).work.bounds,
              core::nearestTriangle(built, tip).work.bounds);
  }
}

TEST(Organ, IsNotWornByMovingAsAWhole) {
  for (const bool is_rebuilt : {false, true}) {
    Organ organ("liver", "liver_frame", test::blob(4));
    if (is_rebuilt) organ.update({}, UpdateMode::kRebuild, 0);
    Points moved = test::blob(4).positions();
    for (Eigen::Vector3d& point : moved) point.z() += 0.001;
    organ.update({{}, moved}, UpdateMode::kAuto, 0);
    ask(organ, Accuracy::exact());
    organ.work();
    EXPECT_NEAR(organ.costRatio(), 1.0, 0.05);
  }
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

}  // namespace
}  // namespace organ_collision::node
