// How long does a query take, near and far, greedy and exact, by the number of triangles?
#include <benchmark/benchmark.h>

#include <random>

#include "liver.h"
#include "organ_collision/core/nearest_triangle.h"

namespace organ_collision {
namespace {

using core::Accuracy;

core::Points tipsNear(const core::CollisionMesh& organ, double reach) {
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> offset(-reach, reach);
  core::Points tips(1000);
  for (Eigen::Vector3d& tip : tips) {
    const auto triangle = static_cast<core::TriangleId>(generator() % organ.mesh().triangleCount());
    tip = core::centroid(organ.mesh().triangle(triangle)) +
          Eigen::Vector3d(offset(generator), offset(generator), offset(generator));
  }
  return tips;
}

void query(benchmark::State& state, double reach, const Accuracy& accuracy) {
  const core::CollisionMesh organ(bench::liver(static_cast<std::size_t>(state.range(0))));
  const core::Points tips = tipsNear(organ, reach);
  core::SearchWork work;
  std::size_t i = 0;
  for (auto _ : state) {
    const core::NearestTriangle nearest =
        core::nearestTriangle(organ, tips[i++ % tips.size()], accuracy);
    benchmark::DoNotOptimize(nearest);
    work.bounds += nearest.work.bounds;
    work.triangles += nearest.work.triangles;
  }
  using benchmark::Counter;
  state.counters["triangles"] = static_cast<double>(organ.mesh().triangleCount());
  state.counters["bounds"] = Counter(work.bounds, Counter::kAvgIterations);
  state.counters["triangle tests"] = Counter(work.triangles, Counter::kAvgIterations);
}

constexpr double kNear = 0.005;  // [m]
constexpr double kFar = 0.2;     // [m]

BENCHMARK_CAPTURE(query, near_exact, kNear, Accuracy::exact())->DenseRange(0, 2);
BENCHMARK_CAPTURE(query, near_greedy, kNear, Accuracy::greedy())->DenseRange(0, 2);
BENCHMARK_CAPTURE(query, far_exact, kFar, Accuracy::exact())->DenseRange(0, 2);
BENCHMARK_CAPTURE(query, far_within_5_percent, kFar, Accuracy{0.05, 0.0, 0})->DenseRange(0, 2);

}  // namespace
}  // namespace organ_collision
