#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <cstdlib>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "deformations.h"
#include "node/organ.h"
#include "test_meshes.h"

namespace organ_collision::node {
namespace {

using core::Accuracy;
using core::Points;

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
      organ.account(tip, Accuracy::greedy());
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
