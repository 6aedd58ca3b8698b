// What is asked in every cycle allocates nothing once the thread has seen its widest search. Where
// memory runs out, no answer is wrong afterwards. A mesh tells the memory that it takes.
#include <gtest/gtest.h>
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdlib>
#include <limits>
#include <new>
#include <random>
#include <thread>

#include "organ_collision/core/contact.h"
#include "organ_collision/core/nearest_pair.h"
#include "organ_collision/core/pair_tracking.h"
#include "organ_collision/core/tracking.h"
#include "test_meshes.h"

namespace {

thread_local std::size_t allocations = 0;
thread_local std::size_t allowed_allocations = std::numeric_limits<std::size_t>::max();
std::atomic<std::ptrdiff_t> bytes_in_use{0};  // by all threads

/// Calls `allocate`, unless the thread is to have no more.
template <class Allocate>
void* counted(const Allocate& allocate) {
  if (allocations >= allowed_allocations) return nullptr;
  ++allocations;
  void* const memory = allocate();
  bytes_in_use += static_cast<std::ptrdiff_t>(malloc_usable_size(memory));
  return memory;
}

void* orThrow(void* memory) {
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void release(void* memory) {
  bytes_in_use -= static_cast<std::ptrdiff_t>(malloc_usable_size(memory));
  std::free(memory);
}

}  // namespace

// Not inlined, or gcc finds free() where it expects delete.
[[gnu::noinline]] void* operator new(std::size_t size) {
  return orThrow(counted([size] { return std::malloc(size); }));
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  return counted([size] { return std::malloc(size); });
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto unit = static_cast<std::size_t>(alignment);
  return orThrow(
      counted([&] { return std::aligned_alloc(unit, (size + unit - 1) / unit * unit); }));
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { release(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/) noexcept {
  release(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t /*alignment*/) noexcept {
  release(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/,
                                       std::align_val_t /*alignment*/) noexcept {
  release(memory);
}

namespace organ_collision::core {
namespace {

using Eigen::Isometry3d;
using Eigen::Translation3d;
using Eigen::Vector3d;

Points someTips() {
  std::mt19937 generator(1);
  Points tips(500);
  for (Vector3d& tip : tips) tip = test::randomPoint(generator, 0.15);
  return tips;
}

Triangle triangleAt(const Vector3d& corner) {
  return {corner, corner + Vector3d(0.1, 0, 0), corner + Vector3d(0, 0.1, 0)};
}

/// Of `ask(tip)` for all tips, the second time.
template <class Ask>
std::size_t allocationsOf(const Ask& ask) {
  const Points tips = someTips();
  for (const Vector3d& tip : tips) ask(tip);
  const std::size_t before = allocations;
  for (const Vector3d& tip : tips) ask(tip);
  return allocations - before;
}

TEST(Allocations, AreCountedWhateverTheirAlignment) {
  const std::size_t before = allocations;
  struct alignas(64) Line {
    double numbers[8];
  };
  const std::vector<double> usual(1);
  const std::vector<Line> aligned(1);
  asm volatile("" : : "r"(usual.data()), "r"(aligned.data()) : "memory");  // they are wanted
  EXPECT_EQ(allocations - before, 2);
}

TEST(Allocations, AreNotMadeByContacts) {
  const CollisionMesh organ(test::blob(4));
  EXPECT_EQ(allocationsOf([&](const Vector3d& tip) {
              contact(organ, tip);
              contact(organ, tip, Accuracy::greedy());
              contact(organ, triangleAt(tip));
            }),
            0);
}

TEST(Allocations, AreNotMadeByTurnsOverADeepOrganAndAWideOne) {
  const CollisionMesh deep(test::halvings(40));
  const CollisionMesh wide(test::grid(20, 20));
  ASSERT_GT(deep.wideTree().depth(), wide.wideTree().depth());
  ASSERT_LT(deep.wideTree().packets().size(), wide.wideTree().packets().size());
  EXPECT_EQ(allocationsOf([&](const Vector3d& tip) {
              nearestTriangle(deep, tip);
              nearestTriangle(wide, tip);
            }),
            0);
}

TEST(Allocations, AreNotMadeByFollowingATip) {
  const CollisionMesh organ(test::blob(4));
  Tracker of_points;
  Tracker of_triangles;
  EXPECT_EQ(allocationsOf([&](const Vector3d& tip) {
              of_points.nearestTriangle(organ, 0.0, tip);
              of_triangles.nearestTriangle(organ, 0.0, triangleAt(tip));
            }),
            0);
}

TEST(Allocations, AreNotMadeByPairsOfSurfaces) {
  const CollisionMesh first(test::blob(3));
  const CollisionMesh second(test::blob(3));
  PairTracker tracker;
  EXPECT_EQ(allocationsOf([&](const Vector3d& tip) {
              const Isometry3d pose(Translation3d(tip + Vector3d(0, 0, 2.5)));
              nearestPair(first, pose, second);
              tracker.nearestPair(first, 0.0, pose, second, 0.0);
            }),
            0);
}

TEST(Memory, OfAMeshIsWhatItToldThatItTakes) {
  const TriangleMesh mesh = test::blob(5);  // of arrays in huge pages the end is never written
  const CollisionMesh before(mesh);         // what threads keep for themselves is taken
  const std::ptrdiff_t in_use = bytes_in_use;
  const CollisionMesh organ(mesh);
  const auto taken = static_cast<double>(bytes_in_use - in_use);
  EXPECT_NEAR(static_cast<double>(organ.memory()) / taken, 1.0, 0.05);
}

/// Calls `act` again and again, each time in a thread of its own that is refused memory from one
/// allocation later on, and each time `check`, in the same thread; until it succeeds. Returns how
/// often it failed.
template <class Prepare, class Act, class Check>
std::size_t failuresSurvived(const Prepare& prepare, const Act& act, const Check& check) {
  for (std::size_t granted = 0;; ++granted) {
    bool succeeds = false;
    std::thread([&] {
      auto state = prepare();
      allowed_allocations = allocations + granted;
      try {
        act(state);
        succeeds = true;
      } catch (const std::bad_alloc&) {
      }
      allowed_allocations = std::numeric_limits<std::size_t>::max();
      check(state);
    }).join();
    if (succeeds || testing::Test::HasFailure()) return granted;
  }
}

void expectSame(const NearestTriangle& found, const NearestTriangle& expected) {
  EXPECT_EQ(found.triangle, expected.triangle);
  EXPECT_EQ(found.distance, expected.distance);
  EXPECT_EQ(found.lower_bound, expected.lower_bound);
}

/// Of two parts: the sides of tips are counted.
TriangleMesh twoParts() {
  return test::joined(test::blob(4), test::placed(test::cube(), 0.02, {0.2, 0, 0}));
}

TEST(OutOfMemory, LeavesATrackerRight) {
  const CollisionMesh organ(twoParts());
  const Points tips = someTips();
  std::size_t failures = 0;
  for (std::size_t i = 1; i < tips.size(); ++i) {
    const Vector3d before = 0.3 * tips[i];
    const Vector3d after = before + 0.2 * tips[i - 1];
    failures += failuresSurvived(
        [&] {
          Tracker tracker;
          std::thread([&] { tracker.nearestTriangle(organ, 0.0, before); }).join();
          return tracker;
        },
        [&](Tracker& tracker) { tracker.nearestTriangle(organ, 0.0, after); },
        [&](Tracker& tracker) {
          for (int k = 0; k < 20; ++k) {
            const Vector3d tip = before + Vector3d(0.002 * k, 0, 0);
            expectSame(tracker.nearestTriangle(organ, 0.0, tip), nearestTriangle(organ, tip));
          }
        });
  }
  EXPECT_GT(failures, 0);
}

TEST(OutOfMemory, LeavesRoomForSearchesOfASmallerOrgan) {
  const CollisionMesh small(test::blob(2));
  const CollisionMesh large(test::blob(5));
  const Vector3d tip(0.3, 0.2, 0.4);
  const NearestTriangle expected = nearestTriangle(small, tip);
  const std::size_t failures =
      failuresSurvived([&] { return nearestTriangle(small, tip); },
                       [&](NearestTriangle& /*of_small*/) { nearestTriangle(large, tip); },
                       [&](NearestTriangle& of_small) {
                         of_small = nearestTriangle(small, tip);
                         expectSame(of_small, expected);
                       });
  EXPECT_GT(failures, 0);
}

TEST(OutOfMemory, LeavesAPairTrackerRight) {
  const CollisionMesh first(test::blob(3));
  const CollisionMesh second(test::blob(3));
  const Isometry3d before(Translation3d(2.5, 0, 0));
  const Isometry3d after(Translation3d(0, 2.5, 0.1));
  const std::size_t failures = failuresSurvived(
      [&] {
        PairTracker tracker;
        std::thread([&] { tracker.nearestPair(first, 0.0, before, second, 0.0); }).join();
        return tracker;
      },
      [&](PairTracker& tracker) { tracker.nearestPair(first, 0.0, after, second, 0.0); },
      [&](PairTracker& tracker) {
        expectSame(tracker.nearestPair(first, 0.0, after, second, 0.0).nearest,
                   nearestPair(first, after, second).nearest);
      });
  EXPECT_GT(failures, 0);
}

/// Other splits may name another of several triangles that are equally near.
void expectDistancesOf(const CollisionMesh& organ, const CollisionMesh& expected) {
  for (const Vector3d& tip : someTips())
    ASSERT_EQ(nearestTriangle(organ, tip).distance, nearestTriangle(expected, tip).distance);
}

TEST(OutOfMemory, LeavesAMeshThatIsToBeRebuiltAsItWas) {
  CollisionMesh organ(test::blob(3));
  Points positions = organ.mesh().positions();
  for (Vector3d& position : positions) position.z() *= 0.1;  // then it is split otherwise
  organ.refit(positions);
  EXPECT_GT(failuresSurvived([&] { return organ; }, [](CollisionMesh& mesh) { mesh.rebuild(); },
                             [&](const CollisionMesh& mesh) { expectDistancesOf(mesh, organ); }),
            0);
}

TEST(OutOfMemory, LeavesAMeshThatARefitPutsRightWhenItIsRepeated) {
  const CollisionMesh organ(test::blob(3));
  CollisionMesh expected = organ;
  const Points& before = organ.mesh().positions();
  const auto top = std::max_element(before.begin(), before.end(),
                                    [](const auto& a, const auto& b) { return a.z() < b.z(); });
  const std::vector<VertexId> moved = {static_cast<VertexId>(top - before.begin()), VertexId{7}};
  const Points positions = {0.9 * organ.mesh().position(moved[0]),
                            1.1 * organ.mesh().position(moved[1])};
  expected.refit(moved, positions);
  const auto refit = [&](CollisionMesh& mesh) { mesh.refit(moved, positions); };
  EXPECT_GT(failuresSurvived([&] { return organ; }, refit,
                             [&](CollisionMesh& mesh) {
                               refit(mesh);
                               expectDistancesOf(mesh, expected);
                               EXPECT_EQ(mesh.health().box.low, expected.health().box.low);
                               EXPECT_EQ(mesh.health().box.high, expected.health().box.high);
                             }),
            0);
}

}  // namespace
}  // namespace organ_collision::core
