// Which bounding volume lets the exact search look at the least, and is it worth its price? All on
// the farthest-pair hierarchy of the shipped liver, and of the liver divided.
#include <cmath>
#include <cstdio>
#include <ctime>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include "bounding_volumes/volumes.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organs.h"
#include "tools/arguments.h"
#include "tools/output.h"
#include "tools/program.h"
#include "tools/statistics.h"
#include "tools/tip_samples.h"

namespace organ_collision::bench {
namespace {

/// Tips of one distance band, and how far from the organ they are.
struct Queries {
  std::string band;
  std::vector<Tip> tips;
  std::vector<double> distances;  ///< [m] as the library answers
};

std::vector<Queries> queriesAt(const core::CollisionMesh& organ, std::size_t count,
                               std::uint64_t seed) {
  std::vector<Queries> all;
  for (const tools::Band& band :
       {tools::Band{"0-5 mm", 0.0, 0.005, false}, tools::Band{"5-50 mm", 0.005, 0.05, false},
        tools::Band{"50-200 mm", 0.05, 0.2, false}, tools::Band{"inside", 0.0, 0.05, true}}) {
    all.push_back({band.name, {}, {}});
    for (const Vector3d& point : tools::sampleTips(organ, band, count, seed)) {
      all.back().tips.push_back(tipAt(point, organ.health().box));
      all.back().distances.push_back(std::abs(core::nearestTriangle(organ, point).distance));
    }
  }
  return all;
}

/// [us] of the processor per query, the median of some passes: what else runs matters less.
template <class Search>
double timeOf(Search& search, const std::vector<Tip>& tips) {
  std::vector<double> passes(5);
  for (double& pass : passes) {
    const std::clock_t start = std::clock();
    for (const Tip& tip : tips) search.nearest(tip);
    pass = 1e6 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  }
  return tools::median(passes) / static_cast<double>(tips.size());
}

struct Report {
  std::string csv = "mesh_triangles,volume,band,bounds,triangles,opened,us,mismatches\n";
  std::size_t mismatches = 0;

  /// Measures one kind of volumes in all bands, and prints a line of the table.
  template <class Volumes>
  void add(const char* volume, const Hierarchy& hierarchy, const std::vector<Queries>& bands) {
    BestFirst<Volumes, Tip> search(hierarchy);
    std::printf("%-20s", volume);
    for (const Queries& queries : bands) {
      const double share = 1.0 / static_cast<double>(queries.tips.size());
      double bounds = 0.0, triangles = 0.0, opened = 0.0;
      std::size_t wrong = 0;
      for (std::size_t i = 0; i < queries.tips.size(); ++i) {
        const Answer answer = search.nearest(queries.tips[i]);
        bounds += share * static_cast<double>(answer.bounds);
        triangles += share * static_cast<double>(answer.triangles);
        opened += share * static_cast<double>(answer.opened);
        if (std::sqrt(answer.squared_distance) != queries.distances[i]) ++wrong;
      }
      const double time = timeOf(search, queries.tips);
      std::printf("  %7.1f %7.1f %7.2f", bounds, triangles, time);
      csv += tools::csvLine({std::to_string(hierarchy.sets().front().count), volume, queries.band,
                             tools::significant(bounds, 6), tools::significant(triangles, 6),
                             tools::significant(opened, 6), tools::significant(time),
                             std::to_string(wrong)});
      mismatches += wrong;
    }
    std::printf("\n");
    std::fflush(stdout);
  }
};

void compareOn(const core::CollisionMesh& organ, const std::vector<Queries>& bands,
               Report& report) {
  const Hierarchy binary(organ, 2);
  const Hierarchy wide(organ, 8);
  std::printf("\nLiver of %zu triangles, means per exact query\n%-20s",
              organ.mesh().triangleCount(), "");
  for (const Queries& queries : bands) std::printf("%25s", queries.band.c_str());
  std::printf("\n%-20s", "");
  for (std::size_t i = 0; i < bands.size(); ++i)
    std::printf("%9s %7s %7s", "bounds", "tri.s", "us");
  std::printf("\n");
  report.add<OneEach<PoleBall>>("pole ball", binary, bands);
  report.add<OneEach<SmallBall>>("small ball", binary, bands);
  report.add<OneEach<HalfSpace>>("bisector plane", binary, bands);
  report.add<OneEach<AlignedBox>>("AABB", binary, bands);
  report.add<OneEach<OrientedBox>>("OBB", binary, bands);
  report.add<OneEach<SweptRectangle>>("RSS", binary, bands);
  report.add<OneEach<AlignedBox>>("8-wide AABB", wide, bands);
  report.add<BoxesInParentsFrame>("8-wide in one frame", wide, bands);
}

void run(const std::vector<std::string>& words) {
  const tools::Arguments arguments(words, {"--output", "--queries", "--seed"});
  arguments.requireNoWords();
  const std::size_t count = arguments.whole("--queries", 2000);
  if (count == 0) throw tools::UsageError("--queries 0: one or more are wanted");
  const std::filesystem::path folder = arguments.option("--output").value_or(".");
  tools::requireWritableFolder(folder);
  Report report;
  for (const std::size_t levels : {0, 1}) {
    const core::CollisionMesh organ(liver(levels));
    compareOn(organ, queriesAt(organ, count, arguments.whole("--seed", 1)), report);
  }
  tools::writeFile(folder / "bounding_volumes.csv", report.csv);
  std::printf("\nAnswers that differ from the library's: %zu\n", report.mismatches);
  if (report.mismatches > 0) throw std::runtime_error("answers differ");
}

}  // namespace
}  // namespace organ_collision::bench

int main(int count, char** words) {
  using namespace organ_collision;
  return tools::runProgram(
      {"bounding_volumes", "usage: bounding_volumes [--output DIR] [--queries N] [--seed N]\n"},
      {words + 1, words + count}, std::cout, std::cerr, bench::run);
}
