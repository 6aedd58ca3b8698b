// What is asked in every cycle allocates nothing once the thread has seen its widest search.
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <new>
#include <random>

#include "organ_collision/core/contact.h"
#include "organ_collision/core/nearest_pair.h"
#include "organ_collision/core/pair_tracking.h"
#include "organ_collision/core/tracking.h"
#include "test_meshes.h"

namespace {
thread_local std::size_t allocations = 0;
}  // namespace

// Not inlined, or gcc finds free() where it expects delete.
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  void* const memory = std::malloc(size);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t& /*tag*/) noexcept {
  ++allocations;
  return std::malloc(size);
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  const auto unit = static_cast<std::size_t>(alignment);
  void* const memory = std::aligned_alloc(unit, (size + unit - 1) / unit * unit);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t /*alignment*/) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t /*size*/,
                                       std::align_val_t /*alignment*/) noexcept {
  std::free(memory);
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

TEST(Allocations, AreNotMadeByFollowingATip) {
  const CollisionMesh organ(test::blob(4));
  Tracker of_points;
  Tracker of_triangles;
  EXPECT_EQ(allocationsOf([&](const Vector3d& tip) {
              of_points.nearestTriangle(organ, {}, tip);
              of_triangles.nearestTriangle(organ, {}, triangleAt(tip));
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
              tracker.nearestPair(first, {}, pose, second, {});
            }),
            0);
}

}  // namespace
}  // namespace organ_collision::core
