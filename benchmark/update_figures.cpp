// What does mode AUTO go by? The cost of each kind of update through the swap, and of the wear that
// a deformation leaves, on the shipped liver and two finer ones. These figures, once logged, are
// what test/node/update_policy_test.cpp decides from.
#include <algorithm>
#include <cstdio>
#include <random>

#include "deformations.h"
#include "node/organ.h"
#include "node/stopwatch.h"
#include "node/wear.h"
#include "organs.h"

namespace organ_collision {
namespace {

constexpr double kMicroseconds = 1e6;  // in a second
constexpr int kRepeats = 21;           // the median is printed

/// [s] of `work`, the median.
template <class Work>
double median(Work work) {
  std::vector<double> durations;
  for (int i = 0; i < kRepeats; ++i) {
    const node::CostStopwatch watch;
    work(i);
    durations.push_back(watch.elapsed());
  }
  std::nth_element(durations.begin(), durations.begin() + kRepeats / 2, durations.end());
  return durations[kRepeats / 2];
}

/// The `count` vertices nearest to the first.
std::vector<core::VertexId> neighbours(const core::Points& points, std::size_t count) {
  std::vector<core::VertexId> vertices;
  for (std::size_t i = 0; i < points.size(); ++i)
    vertices.push_back(static_cast<core::VertexId>(i));
  const auto distance = [&points](core::VertexId vertex) {
    return (points[core::index(vertex)] - points[0]).squaredNorm();
  };
  std::sort(vertices.begin(), vertices.end(), [&](core::VertexId first, core::VertexId second) {
    return distance(first) < distance(second);
  });
  vertices.resize(std::min(count, vertices.size()));
  return vertices;
}

void printRefits(node::Organ& organ, const core::Points& points) {
  const auto shifted = [](core::Points some, int i) {
    for (Eigen::Vector3d& point : some) point.z() += 1e-4 * (i + 1);
    return some;
  };
  const double full = median([&](int i) {
    organ.update({{}, shifted(points, i)}, node::UpdateMode::kRefit, 0);
  });
  std::printf("  full refit: %.0f us\n", kMicroseconds * full);
  for (std::size_t count = 2; count <= points.size(); count *= 10) {
    node::VertexMoves moves = {neighbours(points, count), {}};
    core::Points part;
    for (const core::VertexId vertex : moves.vertices) part.push_back(points[core::index(vertex)]);
    int partial = 0;
    const double duration = median([&](int i) {
      moves.positions = shifted(part, i);
      partial +=
          organ.update(moves, node::UpdateMode::kRefit, 0).action == node::Action::kPartialRefit;
    });
    std::printf("  %zu neighbours: %.1f us, %d of %d refits were partial\n", count,
                kMicroseconds * duration, partial, kRepeats);
  }
}

void printWear(const core::CollisionMesh& built, const char* name, const core::Accuracy& accuracy) {
  std::mt19937 generator(7);
  core::CollisionMesh organ = built;
  core::Points points = built.mesh().positions();
  for (Eigen::Vector3d& point : points) point = test::twisted(point, 0, 1.0);
  organ.refit(points);
  std::vector<node::Question> questions;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d vertex = points[generator() % points.size()];
    questions.push_back({vertex + test::randomPoint(generator, 0.005), accuracy});
  }
  const auto wear = node::measureWear(questions, organ, built);
  std::printf("  %s: %.2f times the work, %.1f %% newly wrong, %.2f us a query, exact %.2f us\n",
              name, wear->work_ratio, 100.0 * wear->newly_wrong,
              kMicroseconds * wear->query_duration, kMicroseconds * wear->exact_duration);
}

void print(std::size_t levels) {
  const core::TriangleMesh mesh = bench::liver(levels);
  const node::CostStopwatch watch;
  const core::CollisionMesh built(mesh);
  std::printf("liver of %zu triangles\n  build: %.0f us\n", mesh.triangleCount(),
              kMicroseconds * watch.elapsed());
  node::Organ organ("liver", "liver", mesh);
  printRefits(organ, mesh.positions());
  printWear(built, "exact, twisted", core::Accuracy::exact());
  printWear(built, "greedy, twisted", core::Accuracy::greedy());
}

}  // namespace
}  // namespace organ_collision

int main() {
  for (const std::size_t levels : {std::size_t{0}, std::size_t{1}, std::size_t{2}})
    organ_collision::print(levels);
}
