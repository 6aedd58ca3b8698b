// How long does the nearest triangle of an organ take: this library at each setting, and its peers?
// One program for one organ; the entrants take turns in random order. Usage: see kUsage.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cmath>
#include <iostream>

#include "contenders/contender.h"
#include "google_benchmark.h"
#include "organs.h"
#include "workloads.h"

namespace organ_collision::bench {
namespace {

constexpr const char* kUsage =
    "usage: query_benchmark ORGAN [--tips N] [--seed N] [--benchmark_...]\n"
    "ORGAN: liver, blob or a mesh file; @K behind it divides every triangle in four, K times\n"
    "--benchmark_...: options of Google Benchmark, such as --benchmark_filter=REGEX\n";
constexpr std::size_t kWarmUp = 8;  // this part of the tips is answered before the clock starts

/// What an entrant has to do in a benchmark, and how well it did it.
struct Race {
  Entrant entrant;
  core::Points tips;
  double max_error = 0.0, mean_error = 0.0;  // of the diagonal
  double found = 0.0;                        // share of answers as near as the exact one
};

/// Compares the entrant's answers with the exact ones.
/// REQUIRES: `truth` has the distances of the race's tips, and perhaps more.
void judge(Race& race, const std::vector<double>& truth) {
  const double tolerance = race.entrant.tolerance.value_or(race.entrant.rounding);
  std::vector<double> distances;
  race.entrant.contender->answer(race.tips, distances);
  race.entrant.contender->measure(race.tips, distances);
  for (std::size_t i = 0; i < race.tips.size(); ++i) {
    const double error = std::abs(distances.at(i) - truth[i]);
    race.max_error = worse(race.max_error, error);
    race.mean_error += error / static_cast<double>(race.tips.size());
    race.found += (error <= tolerance ? 1.0 : 0.0) / static_cast<double>(race.tips.size());
  }
}

void timeAnswers(benchmark::State& state, const Race& race) {
  const core::Points few(
      race.tips.begin(),
      race.tips.begin() + static_cast<std::ptrdiff_t>((race.tips.size() + kWarmUp - 1) / kWarmUp));
  std::vector<double> distances;
  distances.reserve(race.tips.size());
  Contender& contender = *race.entrant.contender;
  contender.answer(few, distances);
  for (auto _ : state) {
    contender.answer(race.tips, distances);
    benchmark::DoNotOptimize(distances.data());
  }
  const auto tips = static_cast<double>(race.tips.size());
  state.counters["tips"] = tips;
  state.counters["max_error"] = race.max_error;
  state.counters["mean_error"] = race.mean_error;
  state.counters["found"] = race.found;
  if (const std::optional<Work> work = contender.work()) {
    state.counters["bounds"] = static_cast<double>(work->bounds) / tips;
    state.counters["triangle_tests"] = static_cast<double>(work->triangles) / tips;
  }
}

std::vector<Entrant> entrantsFor(const core::TriangleMesh& mesh) {
  std::vector<Entrant> all = libraryEntrants(mesh);  // the exact one comes first
  for (const auto& more :
       {embreeEntrants, cgalEntrants, fclEntrants, nanoflannEntrants, paperEntrants}) {
    for (Entrant& entrant : more(mesh)) all.push_back(std::move(entrant));
  }
  return all;
}

/// Throws std::runtime_error if somebody answers wrongly.
void compare(const core::TriangleMesh& mesh, std::size_t tip_count, std::uint64_t seed) {
  const std::vector<Entrant> entrants = entrantsFor(mesh);
  for (const Workload& workload : workloads(core::CollisionMesh(mesh), tip_count, seed)) {
    std::vector<double> truth;
    entrants.front().contender->answer(workload.tips, truth);
    for (const Entrant& entrant : entrants) {
      const std::vector<Task>& tasks = entrant.tasks;
      if (std::find(tasks.begin(), tasks.end(), workload.task) == tasks.end()) continue;
      Race race{entrant, workload.tips};
      race.tips.resize(std::min(entrant.most_tips, race.tips.size()));
      judge(race, truth);
      requireRight(workload.name + ", " + entrant.name, race.max_error, entrant.tolerance);
      auto* const registered = benchmark::RegisterBenchmark(
          (workload.name + "/" + entrant.name).c_str(),
          [race](benchmark::State& state) { timeAnswers(state, race); });
      registered->Iterations(1);
      if (workload.task == Task::kBatch) registered->UseRealTime();
    }
  }
  benchmark::RunSpecifiedBenchmarks();
}

void run(const tools::Arguments& arguments) {
  if (arguments.words().size() != 1) throw tools::UsageError("one organ is wanted");
  const std::string& name = arguments.words().front();
  const core::TriangleMesh mesh = inUnitsOfItsDiagonal(organNamed(name));
  tellOrgan(name, mesh);
  compare(mesh, arguments.whole("--tips", 4096, 1), arguments.whole("--seed", 1));
}

}  // namespace
}  // namespace organ_collision::bench

int main(int count, char** words) {
  using namespace organ_collision;
  return bench::runGoogleBenchmark({"query_benchmark", bench::kUsage}, count, words,
                                   {"--tips", "--seed"}, bench::run);
}
