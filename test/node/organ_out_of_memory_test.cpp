// What happens to an organ where no memory is found.
#include <gmock/gmock.h>

#include <atomic>
#include <future>
#include <memory>
#include <new>
#include <utility>
#include <vector>

#include "failing_memory.h"
#include "node/background_thread.h"
#include "node/cube_organ.h"
#include "node/moves.h"
#include "node/organ.h"
#include "test_meshes.h"

namespace organ_collision::node {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// While it lives, the background thread has no memory.
class NoMemory {
 public:
  NoMemory() {
    std::promise<void> known;
    thread_->run([&] {
      test::Memory::ofThisThread().failWhile(&is_out_);
      known.set_value();
    });
    known.get_future().wait();
    is_out_ = true;
  }
  ~NoMemory() { is_out_ = false; }
  NoMemory(const NoMemory&) = delete;
  NoMemory& operator=(const NoMemory&) = delete;

 private:
  static inline std::atomic<bool> is_out_{false};
  const std::shared_ptr<BackgroundThread> thread_ = BackgroundThread::shared();
};

TEST(OrganOutOfMemory, TellsWhoAskedForARebuildAndNobodyElse) {
  Organ organ("liver", "liver_frame", test::blob(4));
  {
    const NoMemory no_memory;
    EXPECT_THROW(organ.update({}, UpdateMode::kRebuild, 0), std::bad_alloc);
  }
  EXPECT_EQ(organ.builds().count, 1U);
  EXPECT_THAT(organ.builds().failure, HasSubstr("bad_alloc"));
  EXPECT_EQ(organ.update({}, UpdateMode::kRebuild, 0).action, Action::kRebuild);
  EXPECT_EQ(organ.builds().count, 2U);
  EXPECT_THAT(organ.builds().failure, IsEmpty());
}

TEST(OrganOutOfMemory, MovesOnWhereARebuildFailedThatNobodyAskedFor) {
  Organ organ("liver", "liver_frame", test::blob(4));
  const auto signal = std::make_shared<Signal>();
  organ.setSignal(signal);
  const NoMemory no_memory;
  wearOut(organ);
  for (int turn = 0; turn < 100 && organ.builds().failure.empty(); ++turn) {
    signal->wait();  // raised by the queries, and by the rebuild that is over
    EXPECT_FALSE(organ.work());
  }
  EXPECT_THAT(organ.builds().failure, HasSubstr("bad_alloc"));
  const core::Points positions = test::blob(4).positions();
  organ.enqueue(test::movesOf({3}, {positions[3]}));
  EXPECT_TRUE(organ.work());
  EXPECT_EQ(organ.snapshot()->organ.mesh().positions()[3], positions[3]);
  EXPECT_EQ(organ.counters().updates_lost, 0U);
}

/// An organ that has former states to write the next one into.
std::unique_ptr<Organ> updatedOrgan() {
  auto organ = std::make_unique<Organ>("liver", "liver_frame", test::blob(3));
  for (std::size_t i = 0; i < 4; ++i)
    organ->update(test::movesOf({i}, {Eigen::Vector3d(2.0, 0.1, 0.0)}), UpdateMode::kRefit, 0);
  return organ;
}

TEST(OrganOutOfMemory, StaysAsItWasWhereAnUpdateFails) {
  const core::Points other_positions = test::placed(test::blob(3), 1.5, {0, 0, 0}).positions();
  for (const VertexMoves& moves :
       {test::movesOf({7, 9}, {other_positions[7], other_positions[9]}), {{}, other_positions}}) {
    std::unique_ptr<Organ> organ;
    std::shared_ptr<const OrganSnapshot> before;
    const auto prepare = [&] {
      organ = updatedOrgan();
      before = organ->snapshot();
    };
    const auto update = [&] { organ->update(moves, UpdateMode::kRefit, 0); };
    test::failEachAllocation(prepare, update, [&](bool failed) {
      core::Points expected = before->organ.mesh().positions();
      if (failed) {
        ASSERT_EQ(organ->snapshot(), before);
      } else {
        expected = moved(std::move(expected), moves);
      }
      expected[20] *= 1.25;
      organ->update(test::movesOf({20}, {expected[20]}), UpdateMode::kRefit, 0);
      ASSERT_EQ(organ->snapshot()->organ.mesh().positions(), expected);
    });
  }
}

/// Also where it is the search for what queries have lost, and the copy for that, that fail.
TEST(OrganOutOfMemory, IsUpdatedOrTellsThatItIsNot) {
  std::unique_ptr<Organ> organ;
  const auto prepare = [&] {
    organ = updatedOrgan();
    ask(*organ, core::Accuracy::greedy());
  };
  const auto update = [&] {
    organ->update(test::movesOf({7}, {Eigen::Vector3d(0.0, 1.5, 0.0)}), UpdateMode::kAuto, 0);
  };
  test::failEachAllocation(prepare, update, [&](bool failed) {
    ASSERT_EQ(organ->snapshot()->version, failed ? 5U : 6U);
  });
}

TEST(OrganOutOfMemory, MakesARebuildThatIsAskedForAgain) {
  std::unique_ptr<Organ> organ;
  test::failEachAllocation([&] { organ = updatedOrgan(); },
                           [&] { organ->update({}, UpdateMode::kRebuild, 0); },
                           [&](bool /*failed*/) {
                             organ->update({}, UpdateMode::kRebuild, 0);
                             ASSERT_GE(organ->builds().count, 2U);
                             ASSERT_EQ(organ->builds().failure, "");
                           });
}

TEST(OrganOutOfMemory, CountsWhatWasStreamedAndCannotBeApplied) {
  std::unique_ptr<Organ> organ;
  const auto prepare = [&] {
    organ = updatedOrgan();
    organ->enqueue(test::movesOf({7}, {Eigen::Vector3d(0.0, 1.5, 0.0)}));
  };
  test::failEachAllocation(
      prepare, [&] { organ->work(); },
      [&](bool failed) { ASSERT_EQ(organ->counters().updates_lost, failed ? 1U : 0U); });
}

TEST(OrganOutOfMemory, LetsReadersGo) {
  Organ organ("liver", "liver_frame", test::blob(3));
  std::vector<std::shared_ptr<const OrganSnapshot>> read;
  for (std::size_t i = 0; i < 9; ++i) {
    read.push_back(organ.snapshot());
    organ.update(test::movesOf({i}, {Eigen::Vector3d(2.0, 0.1, 0.0)}), UpdateMode::kRefit, 0);
  }
  for (std::shared_ptr<const OrganSnapshot>& snapshot : read) {
    test::Memory::ofThisThread().failAfter(0);
    snapshot.reset();
    test::Memory::ofThisThread().recover();
  }
  EXPECT_EQ(organ.snapshot()->version, 10U);
}

TEST(PendingMovesOutOfMemory, KeepWhatWaitedAndTakeTheSameMovesAgain) {
  constexpr std::size_t kVertices = 40;
  for (std::size_t waiting = 0; waiting < 20; ++waiting) {
    std::unique_ptr<PendingMoves> pending;
    core::Points expected;
    const auto prepare = [&] {
      pending = std::make_unique<PendingMoves>(kVertices);
      expected.clear();
      for (std::size_t i = 0; i < waiting; ++i) {
        expected.emplace_back(static_cast<double>(i), 0.0, 0.0);
        pending->add(test::movesOf({i}, {expected[i]}));
      }
    };
    const VertexMoves moves =
        test::movesOf({30, 31}, {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(2, 0, 0)});
    const auto add = [&] { pending->add(moves); };
    test::failEachAllocation(prepare, add, [&](bool failed) {
      if (failed) pending->add(moves);
      expected.insert(expected.end(), moves.positions.begin(), moves.positions.end());
      ASSERT_EQ(pending->take().positions, expected);
    });
  }
}

}  // namespace
}  // namespace organ_collision::node
