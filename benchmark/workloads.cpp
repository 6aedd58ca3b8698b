#include "workloads.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/sign.h"

namespace organ_collision::bench {
namespace {

using Eigen::Vector3d;

constexpr double kNear = 0.05;
constexpr double kStep = 0.0006;
constexpr double kHighest = 0.02;
constexpr double kTurn = 0.1;               // of the direction, from step to step
constexpr double kStepsPerSwing = 2000.0;   // of the height above the surface
constexpr double kSwing = 0.95;             // of half the highest
constexpr double kSteepest = 0.5;           // slope, back to that height
constexpr std::size_t kTriesPerTip = 1000;  // to find a point inside

class Dice {
 public:
  explicit Dice(std::uint64_t seed) : generator_(seed) {}
  double between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator_);
  }
  Vector3d inBox(const Vector3d& low, const Vector3d& high) {
    const double x = between(low.x(), high.x());
    const double y = between(low.y(), high.y());
    return {x, y, between(low.z(), high.z())};
  }
  std::mt19937_64& generator() { return generator_; }

 private:
  std::mt19937_64 generator_;
};

std::vector<double> areas(const core::TriangleMesh& mesh) {
  std::vector<double> result;
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    const core::Triangle triangle = mesh.triangle(static_cast<core::TriangleId>(i));
    result.push_back((triangle.b - triangle.a).cross(triangle.c - triangle.a).norm());
  }
  return result;
}

core::Points near(const core::CollisionMesh& organ, std::size_t count, Dice dice) {
  const std::vector<double> weights = areas(organ.mesh());
  std::discrete_distribution<std::uint32_t> pick(weights.begin(), weights.end());
  core::Points tips(count);
  for (Vector3d& tip : tips) {
    const auto id = static_cast<core::TriangleId>(pick(dice.generator()));
    const core::Triangle triangle = organ.mesh().triangle(id);
    const double root = std::sqrt(dice.between(0.0, 1.0));
    const double share = dice.between(0.0, 1.0);
    tip = (1.0 - root) * triangle.a + root * (1.0 - share) * triangle.b + root * share * triangle.c;
    tip += dice.between(-kNear, kNear) * core::pseudonormal(organ, id, core::Feature::kFace);
  }
  return tips;
}

core::Points far(const core::CollisionMesh& organ, std::size_t count, Dice dice) {
  const core::Box& box = organ.health().box;
  const Vector3d half = 0.5 * (box.high - box.low);
  core::Points tips(count);
  for (Vector3d& tip : tips) tip = dice.inBox(box.low - half, box.high + half);
  return tips;
}

core::Points inside(const core::CollisionMesh& organ, std::size_t count, Dice dice) {
  core::Points tips;
  if (!organ.health().isSolid()) return tips;
  const core::Box& box = organ.health().box;
  for (std::size_t i = 0; i < kTriesPerTip * count && tips.size() < count; ++i) {
    const Vector3d tip = dice.inBox(box.low, box.high);
    if (core::nearestTriangle(organ, tip).distance < 0.0) tips.push_back(tip);
  }
  return tips;
}

/// Away from the surface, on the outside; where that is not known, on the tip's side.
Vector3d outwardAt(const core::NearestTriangle& nearest) {
  const Vector3d away = -nearest.closest.offset;
  if (away.isZero(0.0)) return nearest.normal;
  return (nearest.distance < 0.0 ? -away : away).stableNormalized();
}

}  // namespace

core::Points trajectory(const core::CollisionMesh& organ, std::size_t count, std::uint64_t seed) {
  Dice dice(seed);
  const Vector3d one = Vector3d::Ones();
  const Vector3d start = organ.mesh().positions().front();
  Vector3d tip = start + 0.5 * kHighest * outwardAt(core::nearestTriangle(organ, start));
  Vector3d direction = dice.inBox(-one, one);
  core::Points tips;
  while (tips.size() < count) {
    const core::NearestTriangle nearest = core::nearestTriangle(organ, tip);
    const Vector3d outward = outwardAt(nearest);
    const double phase = 2.0 * M_PI * static_cast<double>(tips.size()) / kStepsPerSwing;
    const double height = 0.5 * kHighest * (1.0 + kSwing * std::sin(phase));
    const double rise = (height - nearest.distance) / kStep;
    // Along the surface, whatever its shape: who only kept above the nearest point would stay where
    // that is a corner.
    direction = (direction - direction.dot(outward) * outward).normalized();
    tip += kStep * (direction + std::clamp(rise, -kSteepest, kSteepest) * outward).normalized();
    tips.push_back(tip);
    direction += kTurn * dice.inBox(-one, one);
  }
  return tips;
}

std::vector<core::VertexId> neighbours(const core::Points& positions, std::size_t count) {
  std::vector<core::VertexId> vertices;
  for (std::size_t i = 0; i < positions.size(); ++i)
    vertices.push_back(static_cast<core::VertexId>(i));
  const auto distance = [&](core::VertexId vertex) {
    return (positions[index(vertex)] - positions.front()).squaredNorm();
  };
  const auto end = vertices.begin() + static_cast<std::ptrdiff_t>(count);
  std::nth_element(vertices.begin(), end - 1, vertices.end(),
                   [&](auto a, auto b) { return distance(a) < distance(b); });
  vertices.erase(end, vertices.end());
  return vertices;
}

std::vector<Workload> workloads(const core::CollisionMesh& organ, std::size_t count,
                                std::uint64_t seed) {
  const core::Points near_tips = near(organ, count, Dice(seed));
  std::vector<Workload> all = {
      {"near", Task::kPoints, near_tips},
      {"far", Task::kPoints, far(organ, count, Dice(seed + 1))},
      {"inside", Task::kPoints, inside(organ, count, Dice(seed + 2))},
      {"trajectory", Task::kPath, trajectory(organ, count, seed + 3)},
      {"batch", Task::kBatch, near_tips},
  };
  if (all[2].tips.empty()) all.erase(all.begin() + 2);
  return all;
}

}  // namespace organ_collision::bench
