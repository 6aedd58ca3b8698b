#include "paper_experiment.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <random>
#include <set>
#include <utility>

#include "organ_collision/core/nearest_triangle.h"
#include "statistics.h"
#include "trade.h"

namespace organ_collision::tools {
namespace {

using core::Accuracy;
using core::Corners;
using core::NearestTriangle;
using core::Triangle;
using core::VertexId;
using Eigen::Vector3d;

constexpr double kHeight = 4.0;  // [cells] of the space over the grid
constexpr std::size_t kMisprint = 6164;

/// The tip's corners [cells], seen from its centroid; along no axis, so that it meets the grid as
/// an instrument meets an organ.
const Triangle kTip = {{-0.3, -0.2, 0.4}, {0.4, -0.1, 0.2}, {-0.1, 0.3, -0.6}};

PaperGrid gridOf(std::size_t columns, std::size_t rows) {
  const std::size_t vertices = (columns + 1) * (rows + 1);
  return {columns, rows, vertices + 2 * columns * rows - 2};
}

Vector3d spaceOver(const PaperGrid& grid) {
  return kCell *
         Vector3d(static_cast<double>(grid.columns), static_cast<double>(grid.rows), kHeight);
}

/// Where something that runs straight on from 0 is after `way`, between walls at 0 and `length`.
double thrownBack(double way, double length) {
  const double there_and_back = std::fmod(way, 2.0 * length);
  return there_and_back < length ? there_and_back : 2.0 * length - there_and_back;
}

/// [m] from any tip to any corner, or more: no tip reaches a cell beyond the space.
double extentOver(const PaperGrid& grid) { return spaceOver(grid).norm() + kCell; }

/// One grid and the tips over it.
struct Course {
  Course(const PaperGrid& grid, std::size_t steps, std::uint64_t seed)
      : organ(meshOf(grid)), tips(tipPath(grid, steps, seed)) {}
  core::CollisionMesh organ;
  std::vector<Triangle> tips;
};

/// [s] per query, without sign: the paper has none.
double timeOf(const Course& course, const Accuracy& accuracy) {
  const auto start = std::chrono::steady_clock::now();
  for (const Triangle& tip : course.tips)
    core::nearestTriangle(course.organ, tip, accuracy, core::Sign::kNone);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  return elapsed.count() / static_cast<double>(course.tips.size());
}

PaperRow describe(const PaperGrid& grid, const Course& course) {
  PaperRow row{};
  row.grid = grid;
  row.triangles = course.organ.mesh().triangleCount();
  row.vertices = course.organ.mesh().positions().size();
  row.edges = edgeCount(course.organ.mesh());
  row.depth = course.organ.tree().depth();
  row.steps = course.tips.size();
  return row;
}

void compareAnswers(const Course& course, PaperRow& row) {
  const double weight = 1.0 / static_cast<double>(course.tips.size());
  std::vector<double> errors;  // [cells]
  for (const Triangle& tip : course.tips) {
    const NearestTriangle greedy = core::nearestTriangle(course.organ, tip, Accuracy::greedy());
    const NearestTriangle exact = core::nearestTriangle(course.organ, tip, Accuracy::exact());
    const double error = greedy.distance - exact.distance;
    if (error <= tieTolerance(extentOver(row.grid))) ++row.greedy_is_right;
    errors.push_back(error / kCell);
    row.greedy_nodes += weight * greedy.work.bounds;
    row.exact_boxes += weight * exact.work.bounds;
    row.exact_triangles += weight * exact.work.triangles;
  }
  row.mean_error = mean(errors);
  row.p99_error = percentile(errors, 0.99);
  row.worst_error = percentile(errors, 1.0);
}

}  // namespace

std::vector<PaperGrid> paperGrids() {
  std::vector<PaperGrid> grids;
  for (const std::size_t side : {8, 11, 14, 16, 18, 19, 21, 23, 24, 25})
    grids.push_back(gridOf(side, side));
  for (std::size_t side = 27; side <= 38; ++side) grids.push_back(gridOf(side, side));
  grids.push_back({38, 39, kMisprint});
  return grids;
}

core::TriangleMesh meshOf(const PaperGrid& grid) {
  core::Points points;
  for (std::size_t y = 0; y <= grid.rows; ++y) {
    for (std::size_t x = 0; x <= grid.columns; ++x)
      points.emplace_back(kCell * static_cast<double>(x), kCell * static_cast<double>(y), 0.0);
  }
  std::vector<Corners> triangles;
  for (std::size_t y = 0; y < grid.rows; ++y) {
    for (std::size_t x = 0; x < grid.columns; ++x) {
      const auto corner = [&](std::size_t right, std::size_t up) {
        return static_cast<VertexId>((y + up) * (grid.columns + 1) + x + right);
      };
      triangles.push_back({corner(0, 0), corner(1, 0), corner(1, 1)});
      triangles.push_back({corner(0, 0), corner(1, 1), corner(0, 1)});
    }
  }
  return {points, triangles};
}

std::size_t edgeCount(const core::TriangleMesh& mesh) {
  std::set<std::pair<VertexId, VertexId>> edges;
  for (const auto& [a, b, c] : mesh.triangles()) {
    for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}})
      edges.insert(std::minmax(from, to));
  }
  return edges.size();
}

std::vector<Triangle> tipPath(const PaperGrid& grid, std::size_t steps, std::uint64_t seed) {
  const Vector3d space = spaceOver(grid);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const auto drawn = [&] {
    const double x = share(random);
    const double y = share(random);
    return Vector3d(x, y, share(random));
  };
  const Vector3d start = space.cwiseProduct(drawn());
  const Vector3d step = kStep * kCell * (Vector3d::Constant(0.1) + drawn()).normalized();
  std::vector<Triangle> path;
  path.reserve(steps);
  for (std::size_t i = 0; i < steps; ++i) {
    const Vector3d way = start + static_cast<double>(i) * step;
    const Vector3d centroid = way.binaryExpr(space, &thrownBack);
    path.push_back(
        {centroid + kCell * kTip.a, centroid + kCell * kTip.b, centroid + kCell * kTip.c});
  }
  return path;
}

std::vector<PaperRow> measure(const std::vector<PaperGrid>& grids, std::size_t steps,
                              std::uint64_t seed, const std::function<void()>& advance) {
  std::vector<PaperRow> rows;
  for (const PaperGrid& grid : grids) {
    const Course course(grid, steps, seed);
    rows.push_back(describe(grid, course));
    compareAnswers(course, rows.back());
    advance();
  }
  std::vector<std::vector<double>> greedy_times(grids.size()), exact_times(grids.size());
  for (std::size_t pass = 0; pass < kPasses; ++pass) {
    for (std::size_t i = 0; i < grids.size(); ++i) {
      const Course course(grids[i], steps, seed);
      greedy_times[i].push_back(timeOf(course, Accuracy::greedy()));
      exact_times[i].push_back(timeOf(course, Accuracy::exact()));
      advance();
    }
  }
  for (std::size_t i = 0; i < grids.size(); ++i) {
    rows[i].greedy_time = median(greedy_times[i]);
    rows[i].exact_time = median(exact_times[i]);
  }
  return rows;
}

}  // namespace organ_collision::tools
