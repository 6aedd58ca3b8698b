// What does mode AUTO go by? The cost of each kind of update through the swap, and of the wear that
// a deformation leaves, on the shipped liver and two finer ones. Figures like these, once logged,
// are what test/node/update_policy_test.cpp decides from. With --output: draws them into that file.
// With --organ: only what updates of that one cost.
// All times are processor time of the thread that updates: others may use the machine too.
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstdio>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "deformations.h"
#include "node/organ.h"
#include "node/stopwatch.h"
#include "node/wear.h"
#include "organs.h"
#include "tools/arguments.h"
#include "tools/output.h"
#include "tools/program.h"
#include "tools/svg_plot.h"
#include "workloads.h"

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

struct Update {
  std::size_t moved;
  double duration;  // [s] through the swap
  int partial;      // of kRepeats
};

/// The last one is of all vertices.
std::vector<Update> updatesOf(const core::TriangleMesh& mesh) {
  node::Organ organ("liver", "liver", mesh);
  const core::Points& points = mesh.positions();
  const auto shifted = [](core::Points some, int i) {
    for (Eigen::Vector3d& point : some) point.z() += 1e-4 * (i + 1);
    return some;
  };
  const double full = median([&](int i) {
    organ.update({{}, shifted(points, i)}, node::UpdateMode::kRefit, 0);
  });
  std::vector<Update> updates;
  for (std::size_t count = 2; count <= points.size(); count *= 10) {
    node::VertexMoves moves = {bench::neighbours(points, count), {}};
    core::Points part;
    for (const core::VertexId vertex : moves.vertices) part.push_back(points[core::index(vertex)]);
    Update update = {count, 0.0, 0};
    update.duration = median([&](int i) {
      moves.positions = shifted(part, i);
      const auto applied = organ.update(moves, node::UpdateMode::kRefit, 0);
      if (applied.action == node::Action::kPartialRefit) ++update.partial;
    });
    updates.push_back(update);
  }
  updates.push_back({points.size(), full, 0});
  return updates;
}

/// Of queries near the surface, after `move` has moved all vertices of `built`.
template <class Move>
node::Wear wearAfter(const core::CollisionMesh& built, const core::Accuracy& accuracy, Move move) {
  std::mt19937 generator(7);
  core::CollisionMesh organ = built;
  core::Points points = built.mesh().positions();
  for (Eigen::Vector3d& point : points) point = move(point);
  organ.refit(points);
  std::vector<node::Question> questions;
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d vertex = points[generator() % points.size()];
    questions.push_back({vertex + test::randomPoint(generator, 0.005), accuracy});
  }
  return node::measureWear(questions, organ, built).value();
}

struct Figures {
  double triangles;
  double rebuild;  // [s]
  std::vector<Update> updates;
  node::Wear in_place, exact, greedy;
};

/// Queries until they have lost to the wear what a rebuild costs.
double queriesToARebuild(const Figures& figures, const node::Wear& wear) {
  node::RebuildPolicy policy(figures.rebuild);
  policy.recordQueries(1, wear);
  return policy.cost() / policy.lost();
}

Figures measure(std::size_t levels) {
  const core::TriangleMesh mesh = bench::liver(levels);
  core::CollisionMesh organ(mesh);
  const double rebuild =
      tbb::task_arena(1).execute([&] { return median([&](int /*turn*/) { organ.rebuild(); }); });
  core::CollisionMesh refitted = organ;  // its boxes are less close, which is no wear
  refitted.refit(mesh.positions());
  const auto stay = [](const Eigen::Vector3d& point) { return point; };
  const auto twist = [](const Eigen::Vector3d& point) { return test::twisted(point, 0, 1.0); };
  return {static_cast<double>(mesh.triangleCount()),
          rebuild,
          updatesOf(mesh),
          wearAfter(organ, core::Accuracy::exact(), stay),
          wearAfter(refitted, core::Accuracy::exact(), twist),
          wearAfter(refitted, core::Accuracy::greedy(), twist)};
}

void print(const std::vector<Update>& updates) {
  const double full = updates.back().duration;
  for (const Update& update : updates) {
    std::printf("  %zu vertices: %.1f us, a %.1fth of all, %d of %d refits were partial\n",
                update.moved, kMicroseconds * update.duration, full / update.duration,
                update.partial, kRepeats);
  }
}

void print(const Figures& figures) {
  std::printf("liver of %.0f triangles\n  rebuild: %.0f us\n", figures.triangles,
              kMicroseconds * figures.rebuild);
  print(figures.updates);
  const auto tell = [&](const char* name, const node::Wear& wear) {
    std::printf(
        "  %s: %.2f times the work, %.1f %% newly wrong, %.2f us a query, exact %.2f us; "
        "a rebuild pays after %.0f queries\n",
        name, wear.work_ratio, 100.0 * wear.newly_wrong, kMicroseconds * wear.query_duration,
        kMicroseconds * wear.exact_duration, queriesToARebuild(figures, wear));
  };
  tell("exact, refitted in place", figures.in_place);
  tell("exact, twisted", figures.exact);
  tell("greedy, twisted", figures.greedy);
}

tools::Figure drawn(const std::vector<Figures>& all) {
  constexpr double kMilliseconds = 1e3;
  const std::vector<const char*> colours = {tools::colours::kSkyBlue, tools::colours::kBlue,
                                            tools::colours::kBlack};
  tools::Plot updates = {
      "an update", {"vertices moved", true}, {"time through the swap [ms]", true}, {}};
  tools::PlotSeries exact = {"exact queries", tools::colours::kGreen, {}, true};
  tools::PlotSeries greedy = {"greedy queries", tools::colours::kVermilion, {}, true};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Figures& figures = all[i];
    const std::string name = std::to_string(static_cast<long>(figures.triangles)) + " triangles";
    tools::PlotSeries refits = {name, colours[i], {}, true};
    for (const Update& update : figures.updates) {
      refits.points.push_back({static_cast<double>(update.moved), kMilliseconds * update.duration,
                               "", update.partial > kRepeats / 2});
    }
    const double rebuild = kMilliseconds * figures.rebuild;
    updates.series.push_back(refits);
    updates.series.push_back(
        {"rebuild",
         colours[i],
         {{refits.points.front().x, rebuild}, {refits.points.back().x, rebuild}},
         true,
         false,
         true});
    exact.points.push_back({figures.triangles, queriesToARebuild(figures, figures.exact)});
    greedy.points.push_back({figures.triangles, queriesToARebuild(figures, figures.greedy)});
  }
  const tools::Plot wear = {"when a rebuild pays: the twisted liver",
                            {"triangles", true},
                            {"queries since the last build", true},
                            {exact, greedy}};
  return {"When refit, when rebuild",
          "filled: partial refits; rings: full ones; dashed: rebuilds",
          {updates, wear},
          2};
}

void run(const std::vector<std::string>& words) {
  const tools::Arguments arguments(words, {"--output", "--organ"});
  arguments.requireNoWords();
  if (const auto organ = arguments.option("--organ")) {
    if (arguments.option("--output")) throw tools::UsageError("--output draws all, not one organ");
    const core::TriangleMesh mesh = bench::organNamed(*organ);
    std::printf("%s of %zu triangles\n", organ->c_str(), mesh.triangleCount());
    print(updatesOf(mesh));
    return;
  }
  std::vector<Figures> all;
  for (const std::size_t levels : {std::size_t{0}, std::size_t{1}, std::size_t{2}}) {
    all.push_back(measure(levels));
    print(all.back());
  }
  if (const auto file = arguments.option("--output")) tools::writeFile(*file, svg(drawn(all)));
}

}  // namespace
}  // namespace organ_collision

int main(int count, char** words) {
  using namespace organ_collision;
  return tools::runProgram(
      {"update_figures", "usage: update_figures [--output FILE.svg] | --organ ORGAN\n"},
      {words + 1, words + count}, std::cout, std::cerr, run);
}
