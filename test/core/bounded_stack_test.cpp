// The deepest hierarchies there are take no more of the stack than shallow ones: nothing recurses
// on data.
#include <gtest/gtest.h>
#include <pthread.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "io/address_sanitizer.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/sign.h"
#include "test_meshes.h"

namespace organ_collision::core {
namespace {

constexpr std::size_t kStack = 0x1p23;  // [bytes] of a thread; what it needs is measured
// [bytes] that halving in another order may take: 20 levels
constexpr std::size_t kNoise = io::kAddressSanitizer ? 0x1p14 : 0x1p12;
constexpr std::size_t kTetrahedra = 1100;
// From 2^490 m to where squares underflow, 2^-537 m, every halving is a level; what is nearer to 0
// coincides, and is split in halves.
constexpr int kLargest = 490;
constexpr std::size_t kLeastDepth = 1000;

/// How much of its stack a thread needs for `action` [bytes].
std::size_t stackOf(std::function<void()> action) {
  constexpr std::uint64_t kUntouched = 0x5AFE5AFE5AFE5AFE;
  std::vector<std::uint64_t> stack(kStack / sizeof kUntouched, kUntouched);
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  if (pthread_attr_setstack(&attributes, stack.data(), kStack) != 0)
    throw std::runtime_error("no stack");
  const auto run = [](void* argument) -> void* {
    (*static_cast<std::function<void()>*>(argument))();
    return nullptr;
  };
  pthread_t thread{};
  if (pthread_create(&thread, &attributes, run, &action) != 0)
    throw std::runtime_error("no thread");
  pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
  const auto deepest = std::find_if(stack.begin(), stack.end(),
                                    [](std::uint64_t word) { return word != kUntouched; });
  return static_cast<std::size_t>(stack.end() - deepest) * sizeof kUntouched;
}

/// Builds, refits, asks, rebuilds.
void useAll(const TriangleMesh& mesh) {
  CollisionMesh organ(mesh);
  organ.refit(organ.mesh().positions());
  for (std::size_t i = 0; i < kTetrahedra; i += 100) {
    const Eigen::Vector3d tip = 1.01 * mesh.position(static_cast<VertexId>(4 * i));
    for (const Accuracy& accuracy :
         {Accuracy::exact(), Accuracy::greedy(), Accuracy{0.1, 0, 0}, Accuracy{0, 0, 64}})
      nearestTriangle(organ, tip, accuracy);
    nearestTriangle(organ, Triangle{tip, 1.1 * tip, 1.2 * tip});
    windingNumber(organ, tip);
  }
  organ.rebuild();
}

TEST(BoundedStack, IsNoLargerForTheDeepestHierarchies) {
  std::vector<double> places(kTetrahedra);
  std::iota(places.begin(), places.end(), 8.0 * kTetrahedra);
  const TriangleMesh shallow = test::tetrahedra(places);
  const TriangleMesh deep = test::halvings(kTetrahedra, kLargest);
  ASSERT_LT(CollisionMesh(shallow).tree().depth(), 50U);
  ASSERT_GT(CollisionMesh(deep).tree().depth(), kLeastDepth);
  ASSERT_LE(CollisionMesh(deep).tree().depth(), kTetrahedra);
  const std::size_t needed = stackOf([&shallow] { useAll(shallow); });
  EXPECT_LE(stackOf([&deep] { useAll(deep); }), needed + kNoise);
  RecordProperty("bytes", static_cast<int>(needed));
}

TEST(BoundedStack, AnswersAreRightInTheDeepestHierarchies) {
  const CollisionMesh organ(test::halvings(kTetrahedra, kLargest));
  for (const int exponent : {kLargest, 100, 0, -100, -490}) {
    const double x = std::ldexp(1.0, exponent);
    EXPECT_EQ(nearestTriangle(organ, Eigen::Vector3d(x, -x, 0)).distance, x);
    EXPECT_EQ(windingNumber(organ, x * Eigen::Vector3d(1.02, 0.02, 0.02)), 1);
  }
}

}  // namespace
}  // namespace organ_collision::core
