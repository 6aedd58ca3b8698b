// How long does it take to follow an organ that moves: building, following all vertices, following
// some neighbouring ones? This library and its peers, in one run. Usage: see kUsage.
#include <benchmark/benchmark.h>
#include <malloc.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>

#include "contenders/contender.h"
#include "google_benchmark.h"
#include "organ_collision/core/closest_point.h"
#include "organs.h"
#include "workloads.h"

namespace organ_collision::bench {
namespace {

using Clock = std::chrono::steady_clock;
using Vertices = std::vector<core::VertexId>;

constexpr const char* kUsage =
    "usage: update_benchmark ORGAN [--benchmark_...]\n"
    "ORGAN: liver, blob or a mesh file; @K behind it divides every triangle in four, K times\n"
    "--benchmark_...: options of Google Benchmark, such as --benchmark_filter=REGEX\n";
constexpr std::size_t kMostChecked = 2'000'000;  // triangles measured to check the answers
constexpr std::size_t kChecks = 32;              // tips
constexpr double kDent = 0.02;                   // [diagonal] that vertices move

double secondsOf(const std::function<void()>& action) {
  const auto start = Clock::now();
  action();
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// [bytes] that this process has taken from malloc.
std::size_t heapInUse() {
  const auto heap = mallinfo2();
  return heap.uordblks + heap.hblkhd;
}

/// The organ's positions with `moved` (empty: all) dented; another `phase` is another dent.
core::Points dented(const core::TriangleMesh& mesh, const Vertices& moved, double phase) {
  core::Points positions = mesh.positions();
  const auto dent = [&](Eigen::Vector3d& position) {
    position.z() += kDent * std::sin(20.0 * position.x() + phase);
  };
  if (moved.empty()) std::for_each(positions.begin(), positions.end(), dent);
  for (const core::VertexId vertex : moved) dent(positions[index(vertex)]);
  return positions;
}

/// The largest difference from brute force [diagonal] with the organ at `positions`, as many tips
/// beside the vertices of `moved` (empty: all) as beside all.
double largestError(Contender& contender, const core::TriangleMesh& mesh, const Vertices& moved,
                    const core::Points& positions) {
  const std::size_t checks =
      std::clamp<std::size_t>(kMostChecked / mesh.triangleCount(), 1, kChecks);
  core::Points tips;
  for (std::size_t i = 0; i < checks; ++i)
    tips.push_back(
        1.01 * positions[moved.empty() || i % 2 == 1 ? i * positions.size() / checks
                                                     : index(moved[i * moved.size() / checks])]);
  std::vector<double> distances;
  contender.answer(tips, distances);
  double largest = 0.0;
  for (std::size_t i = 0; i < checks; ++i) {
    double least = std::numeric_limits<double>::infinity();
    for (const core::Corners& corner : mesh.triangles()) {
      const core::Triangle triangle = {positions[index(corner[0])], positions[index(corner[1])],
                                       positions[index(corner[2])]};
      least = std::min(least, core::closestPointOnTriangle(tips[i], triangle).squared_distance);
    }
    largest = worse(largest, std::abs(distances.at(i) - std::sqrt(least)));
  }
  return largest;
}

/// Tells the error of `follower`'s answers for the organ at `positions`; throws std::runtime_error
/// if it is larger than the method allows.
void check(benchmark::State& state, const Method& method, Follower& follower,
           const core::TriangleMesh& mesh, const Vertices& moved, const core::Points& positions) {
  const double error = largestError(follower.contender(), mesh, moved, positions);
  state.counters["max_error"] = error;
  requireRight(method.name, error, method.tolerance);
}

void build(benchmark::State& state, const Method& method, const core::TriangleMesh& mesh) {
  std::unique_ptr<Follower> follower;
  for (auto _ : state) {
    follower.reset();
    const std::size_t heap_before = heapInUse(), embree_before = embreeMemory();
    state.SetIterationTime(secondsOf([&] { follower = method.build(mesh, {}); }));
    const auto triangles = static_cast<double>(mesh.triangleCount());
    // What Embree takes from malloc is in both.
    const std::size_t bytes = std::max(heapInUse() - heap_before, embreeMemory() - embree_before);
    state.counters["bytes"] = static_cast<double>(bytes) / triangles;
    if (const auto hierarchy = follower->hierarchyMemory())
      state.counters["hierarchy_bytes"] = static_cast<double>(*hierarchy) / triangles;
  }
  check(state, method, *follower, mesh, {}, mesh.positions());
}

void follow(benchmark::State& state, const Method& method, Follower& follower,
            const core::TriangleMesh& mesh, const Vertices& moved) {
  const std::array<core::Points, 2> goals = {dented(mesh, moved, 0.0), dented(mesh, moved, 1.5)};
  std::size_t turn = 0;
  for (auto _ : state) {
    follower.prepare(goals[turn++ % 2]);
    state.SetIterationTime(secondsOf([&] { follower.follow(); }));
  }
  state.counters["moved"] =
      static_cast<double>(moved.empty() ? mesh.positions().size() : moved.size());
  check(state, method, follower, mesh, moved, goals[(turn - 1) % 2]);
}

std::vector<Method> allMethods() {
  std::vector<Method> all;
  for (const auto& more : {libraryMethods, embreeMethods, cgalMethods, fclMethods, bulletMethods}) {
    for (Method& method : more()) all.push_back(std::move(method));
  }
  return all;
}

void add(const std::string& name, const std::function<void(benchmark::State&)>& body) {
  benchmark::RegisterBenchmark(name.c_str(), body)->UseManualTime()->Unit(benchmark::kMicrosecond);
}

/// Moves of `moved` (empty: all) with all who can follow them.
void addMoves(const std::string& name, const core::TriangleMesh& mesh, const Vertices& moved) {
  const Follows wanted = moved.empty() ? Follows::kAllVertices : Follows::kSomeVertices;
  for (const Method& method : allMethods()) {
    if (method.follows != wanted || mesh.triangleCount() > method.most_triangles) continue;
    const auto body = [&mesh, method, moved,
                       follower = std::shared_ptr<Follower>()](benchmark::State& state) mutable {
      if (!follower) follower = method.build(mesh, moved);  // once for all repetitions
      follow(state, method, *follower, mesh, moved);
    };
    add(name + "/" + method.name, body);
  }
}

void run(const tools::Arguments& arguments) {
  if (arguments.words().size() != 1) throw tools::UsageError("one organ is wanted");
  const std::string& name = arguments.words().front();
  const core::TriangleMesh mesh = inUnitsOfItsDiagonal(organNamed(name));
  tellOrgan(name, mesh);
  for (const Method& method : allMethods()) {
    const bool is_built_like_another = method.follows == Follows::kSomeVertices;
    if (is_built_like_another || mesh.triangleCount() > method.most_triangles) continue;
    add("build/" + method.name,
        [&mesh, method](benchmark::State& state) { build(state, method, mesh); });
  }
  addMoves("all vertices", mesh, {});
  const std::size_t vertices = mesh.positions().size();
  for (const std::size_t moved : {std::size_t{200}, vertices / 100, vertices / 20, vertices / 4}) {
    if (moved > 0 && moved < vertices)
      addMoves(std::to_string(moved) + " vertices", mesh, neighbours(mesh.positions(), moved));
  }
  benchmark::RunSpecifiedBenchmarks();
}

}  // namespace
}  // namespace organ_collision::bench

int main(int count, char** words) {
  using namespace organ_collision;
  return bench::runGoogleBenchmark({"update_benchmark", bench::kUsage}, count, words, {},
                                   bench::run);
}
