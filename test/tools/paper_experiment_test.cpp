#include "tools/paper_experiment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <sstream>

#include "brute_force.h"
#include "io/temporary_folder.h"
#include "organ_collision/core/box.h"
#include "organ_collision/core/nearest_triangle.h"
#include "paper_hierarchy.h"
#include "tools/paper_command.h"
#include "tools/paper_report.h"
#include "tools/statistics.h"

namespace organ_collision::tools {
namespace {

using core::Corners;
using core::Triangle;
using core::VertexId;
using testing::HasSubstr;

constexpr double kTolerance = 1e-15;     // [m] a few roundings of two decimetres
constexpr double kMeanTolerance = 1e-9;  // [cells] sums of some hundred errors, in another order
constexpr std::uint64_t kSeed = 7;

const PaperGrid kSmall = {5, 4, 0};

PaperRow measured(const PaperGrid& grid, std::size_t steps, std::uint64_t seed) {
  return measure({grid}, steps, seed, [] {}).front();
}

Corners corners(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  return {static_cast<VertexId>(a), static_cast<VertexId>(b), static_cast<VertexId>(c)};
}

std::size_t linesIn(const std::string& text) {
  return static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
}

TEST(PaperGrids, AreThe23OfTable1) {
  const std::vector<PaperGrid> grids = paperGrids();
  ASSERT_EQ(grids.size(), 23U);
  const core::TriangleMesh first = meshOf(grids.front());
  EXPECT_EQ(first.triangleCount(), 128U);
  EXPECT_EQ(first.positions().size(), 81U);
  const core::TriangleMesh last = meshOf(grids.back());
  EXPECT_EQ(last.triangleCount(), 2964U);
  EXPECT_EQ(last.positions().size(), 1560U);
}

TEST(PaperGrids, HaveOneEdgeMoreThanPrintedButForTheMisprint) {
  std::vector<PaperGrid> grids = paperGrids();
  EXPECT_EQ(grids.back().edges_in_table, 6164U);
  EXPECT_EQ(edgeCount(meshOf(grids.back())), 4523U);
  grids.pop_back();
  for (const PaperGrid& grid : grids)
    EXPECT_EQ(edgeCount(meshOf(grid)), grid.edges_in_table + 1) << grid.columns;
}

TEST(PaperGrids, AreFlatSheetsWithoutGapsOrOverlaps) {
  for (const PaperGrid& grid : paperGrids()) {
    const core::TriangleMesh mesh = meshOf(grid);
    // Euler: a disc, not several, and none of its edges doubled.
    EXPECT_EQ(mesh.positions().size() + mesh.triangleCount(), edgeCount(mesh) + 1);
    double area = 0.0;  // [cells]
    for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
      const Triangle t = mesh.triangle(static_cast<core::TriangleId>(i));
      const Eigen::Vector3d normal = (t.b - t.a).cross(t.c - t.a) / (kCell * kCell);
      EXPECT_GT(normal.z(), 0.0);
      area += 0.5 * normal.z();
    }
    EXPECT_EQ(area, static_cast<double>(grid.columns * grid.rows));  // powers of two: no rounding
  }
}

TEST(EdgeCount, CountsASharedEdgeOnce) {
  const core::Points square = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  EXPECT_EQ(edgeCount({square, {corners(0, 1, 2)}}), 3U);
  EXPECT_EQ(edgeCount({square, {corners(0, 1, 2), corners(0, 2, 3)}}), 5U);
  EXPECT_EQ(edgeCount({square, {corners(0, 1, 2), corners(3, 0, 2)}}), 5U);
}

TEST(TipPath, StaysOverTheGridAndReachesAllOfIt) {
  core::Box reached;
  for (const Triangle& tip : tipPath(kSmall, 2000, kSeed)) reached.add(core::centroid(tip));
  const Eigen::Vector3d space = kCell * Eigen::Vector3d(5, 4, 4);
  for (const int axis : {0, 1, 2}) {
    EXPECT_GE(reached.low[axis], -kTolerance);
    EXPECT_LE(reached.low[axis], 0.1 * space[axis]);
    EXPECT_GE(reached.high[axis], 0.9 * space[axis]);
    EXPECT_LE(reached.high[axis], space[axis] + kTolerance);
  }
}

TEST(TipPath, IsATranslationInEqualStepsButForTheWalls) {
  const std::vector<Triangle> path = tipPath(kSmall, 1000, kSeed);
  std::size_t full_steps = 0;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const Eigen::Vector3d moved = path[i].a - path[i - 1].a;
    EXPECT_LE((path[i].b - path[i - 1].b - moved).norm(), kTolerance);
    EXPECT_LE((path[i].c - path[i - 1].c - moved).norm(), kTolerance);
    EXPECT_LE(moved.norm(), kStep * kCell + kTolerance);
    if (std::abs(moved.norm() - kStep * kCell) <= kTolerance) ++full_steps;
  }
  EXPECT_GE(full_steps, path.size() / 2);
}

TEST(PaperExperiment, AgreesWithThePapersPseudoCodeAndWithBruteForce) {
  constexpr std::size_t kSteps = 500;
  const core::TriangleMesh mesh = meshOf(kSmall);
  const test::PaperHierarchy hierarchy(mesh);
  std::size_t right = 0;
  const core::CollisionMesh organ(mesh);
  std::vector<double> errors;
  double boxes = 0.0;
  double triangles = 0.0;
  for (const Triangle& tip : tipPath(kSmall, kSteps, kSeed)) {
    const core::TriangleId greedy = hierarchy.search(core::centroid(tip));
    const double found = core::closestPoints(tip, mesh.triangle(greedy)).on_second.squared_distance;
    const double error = std::sqrt(found) - std::sqrt(test::squaredDistanceByBruteForce(mesh, tip));
    if (error <= kTolerance) ++right;
    errors.push_back(error / kCell);
    const core::SearchWork work = core::nearestTriangle(organ, tip).work;
    boxes += work.bounds;
    triangles += work.triangles;
  }
  const PaperRow row = measured(kSmall, kSteps, kSeed);
  EXPECT_EQ(row.greedy_is_right, right);
  EXPECT_NEAR(row.exact_boxes, boxes / kSteps, kMeanTolerance);
  EXPECT_NEAR(row.exact_triangles, triangles / kSteps, kMeanTolerance);
  std::sort(errors.begin(), errors.end());
  EXPECT_NEAR(row.mean_error, mean(errors), kMeanTolerance);
  EXPECT_NEAR(row.p99_error, errors[kSteps * 99 / 100 - 1], kMeanTolerance);
  EXPECT_NEAR(row.worst_error, errors.back(), kMeanTolerance);
  EXPECT_GT(row.greedy_is_right, kSteps / 10);  // else nothing was compared
  EXPECT_LT(row.greedy_is_right, kSteps);
}

TEST(PaperExperiment, MeasuresTheMeshAsItIs) {
  const PaperRow row = measured(kSmall, 100, kSeed);
  EXPECT_EQ(row.triangles, 40U);
  EXPECT_EQ(row.vertices, 30U);
  EXPECT_EQ(row.edges, 69U);
  EXPECT_EQ(row.steps, 100U);
  EXPECT_GE(row.greedy_nodes, std::log2(40.0) - 2.0);
  EXPECT_LE(row.greedy_nodes, static_cast<double>(row.depth));
  EXPECT_GE(row.exact_boxes, row.greedy_nodes);
  EXPECT_GE(row.exact_triangles, 1.0);
  EXPECT_LE(row.p99_error, row.worst_error);
  EXPECT_GT(row.greedy_time, 0.0);
  EXPECT_GT(row.exact_time, 0.0);
}

TEST(PaperExperiment, GivesTheSameCountsAndErrorsForTheSameSeed) {
  const PaperRow one = measured(kSmall, 300, 1);
  const PaperRow again = measured(kSmall, 300, 1);
  const PaperRow other = measured(kSmall, 300, 2);
  EXPECT_EQ(one.greedy_is_right, again.greedy_is_right);
  EXPECT_EQ(one.mean_error, again.mean_error);
  EXPECT_EQ(one.p99_error, again.p99_error);
  EXPECT_EQ(one.exact_boxes, again.exact_boxes);
  EXPECT_NE(one.mean_error, other.mean_error);
}

TEST(PaperExperiment, TellsOfEachPassOverEachGrid) {
  std::size_t told = 0;
  EXPECT_EQ(measure({kSmall, kSmall}, 10, kSeed, [&] { ++told; }).size(), 2U);
  EXPECT_EQ(told, 2 * (kPasses + 1));
}

TEST(PaperReport, WritesPrintedAndTrueEdgesForEachMesh) {
  const PaperRow row = measured(paperGrids().back(), 50, kSeed);
  const std::string csv = paperCsv({row, row});
  EXPECT_EQ(linesIn(csv), 3U);
  EXPECT_NE(csv.find("columns,rows,triangles,vertices,edges_in_paper,edges"), std::string::npos);
  EXPECT_NE(csv.find("\n38,39,2964,1560,6164,4523,"), std::string::npos);
  const std::string table = paperTable({row, row});
  for (const char* number : {"2964", "1560", "6164", "4523", "of 100 queries"})
    EXPECT_NE(table.find(number), std::string::npos) << number;
}

TEST(PaperReport, GivesSharesInPerCentAndTimesInMicroseconds) {
  PaperRow row{};
  row.grid = kSmall;
  row.steps = 100;
  row.greedy_is_right = 50;
  row.greedy_time = 2e-6;
  // Wilson's interval for 50 of 100, as in textbooks: 0.4038 to 0.5962.
  EXPECT_NE(paperCsv({row}).find(",2,0,100,50,50,40.38"), std::string::npos);
  EXPECT_NE(paperTable({row}).find("50.0  40.4  59.6"), std::string::npos);
}

TEST(PaperReport, DrawsEveryMeshGreedyAndExact) {
  PaperRow small{};
  small.triangles = 128;
  small.steps = 1;
  small.greedy_time = 1e-6;
  small.exact_time = 4e-6;
  PaperRow large = small;
  large.triangles = 2964;
  const Plot time = paperFigure({small, large}).plots.front();
  ASSERT_EQ(time.series.size(), 2U);
  for (const PlotSeries& series : time.series) {
    ASSERT_EQ(series.points.size(), 2U);
    EXPECT_EQ(series.points[1].x, 2964.0);
  }
  EXPECT_DOUBLE_EQ(time.series[0].points[0].y, 1.0);
  EXPECT_DOUBLE_EQ(time.series[1].points[0].y, 4.0);
}

/// Runs the command on so few queries that it takes no time; its exit code and messages.
struct Command {
  explicit Command(const std::vector<std::string>& words)
      : code(reproducePaper(words, out, errors)) {}
  std::ostringstream out, errors;
  int code;
};

TEST(ReproducePaper, WritesTheTableAndTheFigureAndSaysWhere) {
  const io::TemporaryFolder temporary;
  const std::filesystem::path folder = temporary.path() / "new";
  const Command run({"--output", folder.string(), "--steps", "5", "--seed", "3"});
  EXPECT_EQ(run.code, 0) << run.errors.str();
  for (const char* name : {"paper_table1.csv", "paper_fig4.svg"}) {
    EXPECT_GT(std::filesystem::file_size(folder / name), 1000U);
    EXPECT_NE(run.out.str().find((folder / name).string()), std::string::npos);
  }
}

TEST(ReproducePaper, RefusesWrongArgumentsAndNamesThem) {
  const std::vector<std::vector<std::string>> wrong = {{"--ouput", "x"},       {"x"},
                                                       {"--output"},           {"--seed", "-1"},
                                                       {"--steps", "0"},       {"--steps", "1e3"},
                                                       {"--steps", "10000001"}};
  for (const std::vector<std::string>& words : wrong) {
    const Command run(words);
    EXPECT_EQ(run.code, 2) << words.front();
    EXPECT_NE(run.errors.str().find(words.front()), std::string::npos) << run.errors.str();
  }
}

TEST(ReproducePaper, SaysWhereItCannotWrite) {
  const Command run({"--output", "/dev/null/results", "--steps", "1"});
  EXPECT_EQ(run.code, 1);
  EXPECT_NE(run.errors.str().find("/dev/null/results"), std::string::npos) << run.errors.str();
}

TEST(ReproducePaper, HelpsWithoutMeasuring) {
  const Command run({"--help"});
  EXPECT_EQ(run.code, 0);
  EXPECT_NE(run.out.str().find("--steps"), std::string::npos);
}

/// Every number another.
PaperRow rowOfManyNumbers() {
  return {{5, 4, 67}, 40, 30, 69, 8, 100, 50, 0.125, 0.25, 0.5, 7.5, 6.5, 3.5, 1e-6, 2e-6};
}

TEST(PaperReport, HasEachNumberInItsColumn) {
  EXPECT_THAT(
      paperCsv({rowOfManyNumbers()}),
      HasSubstr(
          "\n5,4,40,30,67,69,8,1,2,100,50,50,40.383153,59.616847,0.125,0.25,0.5,7.5,6.5,3.5\n"));
  PaperRow other{};
  other.triangles = 9;
  other.steps = 100;
  EXPECT_THAT(paperTable({other, rowOfManyNumbers()}),
              HasSubstr("25.0 % of 200 queries; its worst answer was 0.50 cells too far.\nOn 40 "
                        "triangles it takes 1.00 us, the exact search 2.00 us."));
}

TEST(PaperReport, DrawsWorkAndHowOftenTheAnswerIsRight) {
  const std::vector<Plot> plots = paperFigure({rowOfManyNumbers()}).plots;
  EXPECT_EQ(plots.at(1).series.at(0).points.at(0).y, 8.5);   // and the triangle
  EXPECT_EQ(plots.at(1).series.at(1).points.at(0).y, 10.0);  // boxes and triangles
  EXPECT_EQ(plots.at(2).series.at(0).points.at(0).y, 50.0);
  EXPECT_LT(plots.at(2).series.at(1).points.at(0).y, 50.0);
  EXPECT_GT(plots.at(2).series.at(2).points.at(0).y, 50.0);
}

}  // namespace
}  // namespace organ_collision::tools
