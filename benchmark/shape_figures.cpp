// What do shafts and jaws cost against an organ, how does a shaft compare with a point, and how
// long does the worst case take? Organs are scaled to a diagonal of 0.3 m. All times are processor
// time of the thread that asks, the least of some repetitions: others may use the machine too.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "node/stopwatch.h"
#include "organ_collision/core/contact.h"
#include "organ_collision/io/mesh_io.h"
#include "organs.h"
#include "test_meshes.h"
#include "tools/arguments.h"
#include "tools/program.h"
#include "tools/statistics.h"

namespace organ_collision {
namespace {

using core::CollisionMesh;
using core::Shape;
using core::Shapes;
using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double kDiagonal = 0.3;      // [m] of an organ
constexpr double kMicroseconds = 1e6;  // in a second
constexpr int kRepeats = 5;
constexpr int kStepsOfAPose = 4;  // in motion

using Random = std::mt19937;

double uniform(Random& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Of the organ's surface, with the normal there as z axis.
Isometry3d onSurface(Random& random, const CollisionMesh& organ) {
  const auto triangle = static_cast<core::TriangleId>(random() % organ.mesh().triangleCount());
  const auto [a, b, c] = organ.mesh().triangle(triangle);
  const Vector3d normal = (b - a).cross(c - a).normalized();
  return Eigen::Translation3d(core::centroid({a, b, c})) *
         Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), normal);
}

Isometry3d lifted(Random& random, double low, double high) {
  return Eigen::Translation3d(0, 0, uniform(random, low, high)) *
         Isometry3d(Eigen::AngleAxisd(uniform(random, 0.0, 6.28), Vector3d::UnitZ()));
}

/// How instruments, which reach from their origin along z, stand to an organ.
struct Workload {
  const char* name;
  std::function<Isometry3d(Random&, const CollisionMesh&)> pose;
};

const Workload kPointing = {"pointing at it, up to 5 mm away",
                            [](Random& random, const CollisionMesh& organ) -> Isometry3d {
                              return onSurface(random, organ) * lifted(random, 0.0, 0.005);
                            }};
const Workload kLying = {"lying along it, 0 to 5 mm above",
                         [](Random& random, const CollisionMesh& organ) -> Isometry3d {
                           return onSurface(random, organ) * lifted(random, 0.0, 0.005) *
                                  Eigen::AngleAxisd(1.5707963, Vector3d::UnitX()) *
                                  Eigen::Translation3d(0, 0, -0.1);
                         }};
const Workload kFar = {
    "turned anyhow, 1 to 20 cm away", [](Random& random, const CollisionMesh& organ) -> Isometry3d {
      return onSurface(random, organ) * lifted(random, 0.01, 0.2) * test::randomPose(random, 0.0);
    }};
const Workload kEntering = {"pointing at it, up to 1 cm inside",
                            [](Random& random, const CollisionMesh& organ) -> Isometry3d {
                              return onSurface(random, organ) * lifted(random, -0.01, 0.0);
                            }};
const Workload kCrossing = {"turned anyhow, through it",
                            [](Random& random, const CollisionMesh& organ) -> Isometry3d {
                              return onSurface(random, organ) * test::randomPose(random, 0.0) *
                                     Eigen::Translation3d(0, 0, -uniform(random, 0.0, 0.2));
                            }};

/// A part of a turn around the organ, near and far, as an instrument in a hand.
struct Motion {
  const char* name;
  double nearest, farthest;  ///< [m] from the surface
  double step;               ///< [m] a pose, about
};

std::vector<Isometry3d> posesOf(const Motion& motion, const CollisionMesh& organ, int steps) {
  constexpr double kReach = 0.3;  // [m] of a turn's radius, waves included
  const core::Box& box = organ.health().box;
  const Vector3d centre = 0.5 * (box.low + box.high);
  std::vector<Isometry3d> poses;
  for (int i = 0; i < steps; ++i) {
    const double turn = 1.0 + i * motion.step / kReach;
    const Vector3d from =
        Vector3d(std::cos(turn), std::sin(turn), 0.8 * std::sin(2 * turn)).normalized();
    const auto surface = core::nearestTriangle(organ, centre + kDiagonal * from).closest.point;
    const double height =
        motion.nearest + (motion.farthest - motion.nearest) * 0.5 * (1.0 - std::cos(7 * turn));
    const Vector3d place = centre + ((surface - centre).norm() + height) * from;
    poses.push_back(Eigen::Translation3d(place) *
                    Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), from) *
                    Isometry3d(Eigen::AngleAxisd(3 * turn, Vector3d(1, 2, 3).normalized())));
  }
  return poses;
}

std::vector<Isometry3d> posesOf(const Workload& workload, const CollisionMesh& organ, int count) {
  Random random(1);
  std::vector<Isometry3d> poses;
  poses.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) poses.push_back(workload.pose(random, organ));
  return poses;
}

/// [s] of each call of `ask(pose)`, the least of some runs through all poses, each after `start()`.
template <class Start, class Ask>
std::vector<double> timesOf(const std::vector<Isometry3d>& poses, const Start& start,
                            const Ask& ask) {
  std::vector<double> least(poses.size(), 1.0);
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    start();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      const node::Stopwatch watch;  // to look at the thread's own clock takes as long as an answer
      ask(poses[i]);
      least[i] = std::min(least[i], watch.elapsed());
    }
  }
  return least;
}

/// [s] a call on average; the least of some runs.
template <class Ask>
double meanOf(const std::vector<Isometry3d>& poses, const Ask& ask) {
  double least = 1.0;
  for (int repeat = 0; repeat < kRepeats; ++repeat) {
    const node::CostStopwatch watch;
    for (const Isometry3d& pose : poses) ask(pose);
    least = std::min(least, watch.elapsed());
  }
  return least / static_cast<double>(poses.size());
}

void print(const char* name, const std::vector<double>& times) {
  std::printf("  %-48s %8.2f %8.2f %8.2f\n", name, kMicroseconds * tools::mean(times),
              kMicroseconds * tools::percentile(times, 0.99),
              kMicroseconds * tools::percentile(times, 1.0));
}

void compareShaftWithPoint(const CollisionMesh& organ, int count) {
  const core::Capsule shaft{{0, 0, 0}, {0, 0, 0.2}, 0.0025};
  const Vector3d tip(0, 0, 0);
  std::printf("  shaft of 20 cm, us:                               a point  a shaft  ratio\n");
  for (const Workload& workload : {kPointing, kLying, kFar, kEntering, kCrossing}) {
    const std::vector<Isometry3d> poses = posesOf(workload, organ, count);
    const double point =
        meanOf(poses, [&](const Isometry3d& pose) { core::contact(organ, {tip}, pose); });
    const double capsule =
        meanOf(poses, [&](const Isometry3d& pose) { core::contact(organ, {shaft}, pose); });
    std::printf("  %-48s %8.2f %8.2f %6.2f\n", workload.name, kMicroseconds * point,
                kMicroseconds * capsule, capsule / point);
  }
}

void measureJaw(const CollisionMesh& organ, int count) {
  const Shapes jaw = {core::RigidMesh{std::make_shared<const CollisionMesh>(
                                          io::loadMesh(std::filesystem::path(MESHES) / "jaw.obj")),
                                      Isometry3d::Identity()}};
  std::printf("  jaw of 980 triangles, us:                              mean   99 %%   worst\n");
  const auto ask = [&](const Isometry3d& pose) { core::contact(organ, jaw, pose); };
  for (const Workload& workload : {kPointing, kFar, kEntering})
    print(workload.name, timesOf(
                             posesOf(workload, organ, count), [] {}, ask));
  for (const Motion& motion :
       {Motion{"2 mm to 3 cm above, 0.02 mm a step", 0.002, 0.03, 0.00002},
        Motion{"2 mm to 3 cm above, 0.2 mm a step", 0.002, 0.03, 0.0002},
        Motion{"5 to 20 cm above, 0.02 mm a step", 0.05, 0.2, 0.00002},
        Motion{"5 to 20 cm above, 0.2 mm a step", 0.05, 0.2, 0.0002},
        Motion{"1 cm inside to 1 cm above, 0.2 mm a step", -0.01, 0.01, 0.0002}}) {
    const std::vector<Isometry3d> poses = posesOf(motion, organ, kStepsOfAPose * count);
    print((std::string(motion.name) + ", anew").c_str(), timesOf(
                                                             poses, [] {}, ask));
    core::ContactTracker tracker;
    const auto times = timesOf(
        poses, [&] { tracker = core::ContactTracker(); },
        [&](const Isometry3d& pose) { tracker.contact(organ, 0.0, jaw, pose); });
    print("  followed", {times.begin() + 1, times.end()});  // the first is anew
  }
}

core::TriangleMesh scaled(const core::TriangleMesh& mesh) {
  const core::TriangleMesh unit = bench::inUnitsOfItsDiagonal(mesh);
  core::Points positions = unit.positions();
  for (Vector3d& position : positions) position *= kDiagonal;
  return {positions, unit.triangles()};
}

void measure(const std::string& name, int count) {
  const CollisionMesh organ(scaled(bench::organNamed(name)));
  std::printf("%s: %zu triangles\n", name.c_str(), organ.mesh().triangleCount());
  compareShaftWithPoint(organ, count);
  measureJaw(organ, count);
}

void run(const std::vector<std::string>& words) {
  const tools::Arguments arguments(words, {"--poses"});
  if (arguments.words().empty()) throw tools::UsageError("no organ, but one or more are wanted");
  for (const std::string& organ : arguments.words())
    measure(organ, static_cast<int>(arguments.whole("--poses", 1000, 1, 1'000'000)));
}

}  // namespace
}  // namespace organ_collision

int main(int count, char** words) {
  using namespace organ_collision;
  return tools::runProgram({"shape_figures", "usage: shape_figures [--poses N] ORGAN...\n"},
                           {words + 1, words + count}, std::cout, std::cerr, run);
}
