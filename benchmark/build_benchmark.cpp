// How long does the hierarchy take, to build and to refit, by the number of triangles?
#include <benchmark/benchmark.h>

#include "liver.h"
#include "organ_collision/core/wide_tree.h"

namespace organ_collision {
namespace {

core::UnitFrame frameOf(const core::TriangleMesh& mesh) {
  core::Box box;
  for (const Eigen::Vector3d& position : mesh.positions()) box.add(position);
  return core::unitFrame(box);
}

void buildHierarchy(benchmark::State& state) {
  const core::TriangleMesh mesh = bench::roundOrgan(static_cast<std::size_t>(state.range(0)));
  const core::UnitFrame frame = frameOf(mesh);
  std::size_t depth = 0;
  std::size_t memory = 0;
  for (auto _ : state) {
    const core::FarthestPairTree tree(mesh, frame);
    const core::WideTree wide_tree(tree, mesh, frame);
    depth = tree.depth();
    memory = tree.memory() + wide_tree.memory();
  }
  state.counters["triangles"] = static_cast<double>(mesh.triangleCount());
  state.counters["depth"] = static_cast<double>(depth);
  state.counters["bytes/triangle"] =
      static_cast<double>(memory) / static_cast<double>(mesh.triangleCount());
}

void refitHierarchy(benchmark::State& state) {
  const core::TriangleMesh mesh = bench::roundOrgan(static_cast<std::size_t>(state.range(0)));
  const core::UnitFrame frame = frameOf(mesh);
  core::FarthestPairTree tree(mesh, frame);
  core::WideTree wide_tree(tree, mesh, frame);
  for (auto _ : state) {
    tree.refit(mesh, frame);
    wide_tree.refit(tree, mesh, frame);
  }
  state.counters["triangles"] = static_cast<double>(mesh.triangleCount());
}

// 1k, 10k, 100k and 1M triangles.
BENCHMARK(buildHierarchy)->Arg(23)->Arg(71)->Arg(224)->Arg(708)->Unit(benchmark::kMillisecond);
BENCHMARK(refitHierarchy)->Arg(23)->Arg(71)->Arg(224)->Arg(708)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace organ_collision
