// Which pairs are nearer than max_distance? Plain tests of every pair of boxes against FCL's sweep
// and prune, for as many objects as a scene has (12), and many more. All objects move a little in
// every cycle, as instruments do.
#include <benchmark/benchmark.h>
#include <fcl/broadphase/broadphase_SaP.h>
#include <fcl/geometry/shape/box.h>
#include <fcl/narrowphase/collision_object.h>

#include <cmath>
#include <memory>
#include <random>
#include <vector>

#include "organ_collision/core/box.h"
#include "test_meshes.h"

namespace organ_collision {
namespace {

using Eigen::Vector3d;

constexpr double kSide = 0.1;         // [m] of each object
constexpr double kMaxDistance = 0.1;  // [m]
constexpr double kStep = 0.001;       // [m] that each moves at most in a cycle

/// As crowded for every count: about one object in a cube of 0.3 m.
struct Crowd {
  explicit Crowd(std::size_t count) {
    const double reach = 0.15 * std::cbrt(static_cast<double>(count));
    for (std::size_t i = 0; i < count; ++i) centres.push_back(test::randomPoint(generator, reach));
  }
  void move() {
    for (Vector3d& centre : centres) centre += test::randomPoint(generator, kStep);
  }

  std::mt19937 generator{1};
  core::Points centres;
};

void report(benchmark::State& state, std::size_t pairs) {
  state.counters["near pairs"] =
      benchmark::Counter(static_cast<double>(pairs), benchmark::Counter::kAvgIterations);
}

void plain_boxes(benchmark::State& state) {
  Crowd crowd(static_cast<std::size_t>(state.range(0)));
  std::vector<core::Box> boxes(crowd.centres.size());
  std::size_t pairs = 0;
  for (auto _ : state) {
    crowd.move();
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const Vector3d half = Vector3d::Constant(0.5 * kSide);
      boxes[i] = {crowd.centres[i] - half, crowd.centres[i] + half};
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t k = 0; k < i; ++k)
        pairs += squaredDistance(boxes[i], boxes[k]) <= kMaxDistance * kMaxDistance ? 1 : 0;
    }
    benchmark::DoNotOptimize(pairs);
  }
  report(state, pairs);
}

bool count(fcl::CollisionObjectd* /*one*/, fcl::CollisionObjectd* /*other*/, void* pairs) {
  ++*static_cast<std::size_t*>(pairs);
  return false;  // go on
}

/// Its boxes are wider by max_distance, so that near ones overlap; by a cube's corner more than the
/// distance, so it may tell of a few pairs too many.
void sweep_and_prune(benchmark::State& state) {
  Crowd crowd(static_cast<std::size_t>(state.range(0)));
  const double wide = kSide + kMaxDistance;
  const auto box = std::make_shared<fcl::Boxd>(wide, wide, wide);
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects;
  fcl::SaPCollisionManagerd manager;
  for (const Vector3d& centre : crowd.centres) {
    objects.push_back(std::make_unique<fcl::CollisionObjectd>(box));
    objects.back()->setTranslation(centre);
    objects.back()->computeAABB();
    manager.registerObject(objects.back().get());
  }
  manager.setup();
  std::size_t pairs = 0;
  for (auto _ : state) {
    crowd.move();
    for (std::size_t i = 0; i < objects.size(); ++i) {
      objects[i]->setTranslation(crowd.centres[i]);
      objects[i]->computeAABB();
    }
    manager.update();
    manager.collide(&pairs, count);
  }
  report(state, pairs);
}

void moving_alone(benchmark::State& state) {
  Crowd crowd(static_cast<std::size_t>(state.range(0)));
  for (auto _ : state) crowd.move();
}

BENCHMARK(plain_boxes)->Arg(12)->Arg(100)->Arg(1000);
BENCHMARK(sweep_and_prune)->Arg(12)->Arg(100)->Arg(1000);
BENCHMARK(moving_alone)->Arg(12)->Arg(100)->Arg(1000);  // to be taken off both

}  // namespace
}  // namespace organ_collision
