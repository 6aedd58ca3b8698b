// What does each element of a scene cost: per cycle, and in memory?
#include <benchmark/benchmark.h>

#include <filesystem>
#include <memory>
#include <random>
#include <string>

#include "convex/tool_proximity.h"
#include "io/primitive_mesh.h"
#include "organ_collision/core/contact.h"
#include "organ_collision/core/proximity.h"
#include "organ_collision/core/triangles_within.h"
#include "organ_collision/io/mesh_io.h"
#include "organs.h"
#include "test_meshes.h"

namespace organ_collision {
namespace {

using core::CollisionMesh;
using core::Shape;
using core::Shapes;
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kHighest = 0.005;  // [m] of instruments above the surface
constexpr int kPoses = 20'000;      // fewer would be learned by heart

std::shared_ptr<const CollisionMesh> shipped(const std::string& name) {
  return std::make_shared<const CollisionMesh>(
      io::loadMesh(std::filesystem::path(MESHES) / (name + ".obj")));
}

/// Of an instrument that points at the surface, as from a trocar.
Isometry3d randomPose(std::mt19937& generator, const CollisionMesh& organ) {
  const auto triangle = static_cast<core::TriangleId>(generator() % organ.mesh().triangleCount());
  const auto [a, b, c] = organ.mesh().triangle(triangle);
  const double height = kHighest * static_cast<double>(generator() % 1000) / 1000.0;
  const Vector3d normal = (b - a).cross(c - a).normalized();
  const Eigen::Translation3d place(core::centroid({a, b, c}) + height * normal);
  // The shapes below reach along -z: their z axis is the way in.
  return place * Eigen::Quaterniond::FromTwoVectors(Vector3d(0, 0, -1), normal);
}

void report(benchmark::State& state, std::size_t bytes, const core::SearchWork& work) {
  using benchmark::Counter;
  state.counters["bytes"] = static_cast<double>(bytes);
  state.counters["bounds"] = Counter(work.bounds, Counter::kAvgIterations);
  state.counters["triangle tests"] = Counter(work.triangles, Counter::kAvgIterations);
}

std::size_t bytesOf(const Shape& shape) {
  const auto* mesh = std::get_if<core::RigidMesh>(&shape);
  return sizeof(Shape) + (mesh != nullptr ? mesh->surface->memory() : 0);
}

void instrument(benchmark::State& state, const Shape& shape) {
  const CollisionMesh organ(bench::liver(0));
  const Shapes shapes = {shape};
  std::mt19937 generator(1);
  std::vector<Isometry3d> poses;
  for (int i = 0; i < kPoses; ++i) poses.push_back(randomPose(generator, organ));
  core::SearchWork work;
  std::size_t i = 0;
  for (auto _ : state) {
    const core::Contact found = core::contact(organ, shapes, poses[i++ % poses.size()]);
    benchmark::DoNotOptimize(found);
    work.bounds += found.nearest.work.bounds;
    work.triangles += found.nearest.work.triangles;
  }
  report(state, bytesOf(shape), work);
}

Shape jaw() { return core::RigidMesh{shipped("jaw"), Isometry3d::Identity()}; }

core::RigidMesh cylinder() {
  return {std::make_shared<const CollisionMesh>(io::prismMesh(0.0025, 0.2, 32)),
          Isometry3d(Eigen::Translation3d(0, 0, -0.1)), true};
}

const core::Capsule kShaft{{0, 0, 0}, {0, 0, -0.2}, 0.0025};

void two_instruments(benchmark::State& state, const Shape& first, const Shape& second) {
  std::mt19937 generator(2);
  std::vector<Isometry3d> poses;
  for (int i = 0; i < kPoses; ++i) poses.push_back(test::randomPose(generator, 0.1));
  core::SearchWork work;
  std::size_t i = 0;
  for (auto _ : state) {
    const auto found = convex::toolProximity({first}, poses[i++ % poses.size()], {second}, {});
    benchmark::DoNotOptimize(found);
    work.bounds += found.work.bounds;
    work.triangles += found.work.triangles;
  }
  report(state, 0, work);
}

void two_organs(benchmark::State& state, double apart) {
  const core::RigidMesh liver{shipped("liver"), Isometry3d::Identity()};
  const auto gallbladder = shipped("gallbladder");
  core::SearchWork work;
  for (auto _ : state) {
    const auto found = core::proximity(
        core::RigidMesh{gallbladder, Isometry3d(Eigen::Translation3d(0, -0.02, -0.08 - apart))},
        liver);
    benchmark::DoNotOptimize(found);
    work.bounds += found.work.bounds;
    work.triangles += found.work.triangles;
  }
  report(state, 0, work);
}

void organ(benchmark::State& state, const std::string& name) {
  const core::TriangleMesh mesh = io::loadMesh(std::filesystem::path(MESHES) / (name + ".obj"));
  std::size_t bytes = 0;
  for (auto _ : state) bytes = CollisionMesh(mesh).memory();
  report(state, bytes, {});
}

void triangles_within(benchmark::State& state, double radius) {
  const CollisionMesh organ(bench::liver(0));
  std::mt19937 generator(1);
  std::size_t found = 0;
  for (auto _ : state) {
    const Vector3d point = randomPose(generator, organ).translation();
    found += core::trianglesWithin(organ, point, radius).triangles.size();
  }
  state.counters["found"] =
      benchmark::Counter(static_cast<double>(found), benchmark::Counter::kAvgIterations);
}

// The time of `organ` is that of loading: the hierarchy's build, once.
BENCHMARK_CAPTURE(organ, liver, std::string("liver"))->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(organ, gallbladder, std::string("gallbladder"))->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(instrument, point, Vector3d(0, 0, 0))->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(instrument, triangle,
                  (core::Triangle{{0, 0, 0}, {0.002, 0, -0.005}, {-0.002, 0, -0.005}}))
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(instrument, sphere, (core::Sphere{{0, 0, 0}, 0.003}))
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(instrument, capsule, kShaft)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(instrument, cylinder_of_a_link, cylinder())->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(instrument, jaw_of_980_triangles, jaw())->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(two_instruments, capsule_capsule, kShaft, kShaft)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(two_instruments, convex_capsule, cylinder(), kShaft)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(two_instruments, convex_convex, cylinder(), cylinder())
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(two_instruments, jaw_capsule, jaw(), kShaft)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(two_organs, apart_5_cm, 0.05)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(two_organs, touching, 0.0)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(triangles_within, 1_cm, 0.01)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace organ_collision
