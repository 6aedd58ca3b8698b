// Which bounding volume lets the exact search look at the least, and is that worth its price? All
// on the same farthest-pair hierarchy of the shipped liver, and of the liver divided.
// Usage: bounding_volumes [--output DIR] [--queries N] [--seed N]
#include <chrono>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <string>
#include <vector>

#include "bounding_volumes/best_first.h"
#include "liver.h"
#include "organ_collision/core/nearest_triangle.h"
#include "tools/arguments.h"
#include "tools/output.h"
#include "tools/progress.h"
#include "tools/statistics.h"
#include "tools/tip_samples.h"

namespace organ_collision::bench {
namespace {

constexpr std::size_t kWidth = 8;
constexpr std::size_t kPasses = 3;

const std::vector<tools::Band> kBands = {{"near, 0-5 mm", 0.0, 0.005, false},
                                         {"5-50 mm", 0.005, 0.05, false},
                                         {"far, 50-200 mm", 0.05, 0.2, false},
                                         {"inside", 0.0, 0.05, true}};

/// Tips of one band, and how far from the organ they are.
struct Queries {
  std::string band;
  std::vector<Tip> tips;
  std::vector<double> distances;  ///< [m] as the library answers
};

/// Means per query.
struct Cost {
  double bounds = 0.0, triangles = 0.0, opened = 0.0;
  double time = 0.0;  ///< [s]
  std::size_t mismatches = 0;
};

struct Row {
  std::string volume;
  std::size_t bytes;        ///< per set of triangles
  std::vector<Cost> costs;  ///< in each band
};

template <class Query>
double secondsPerQuery(const Queries& queries, const Query& query) {
  std::vector<double> passes;
  for (std::size_t pass = 0; pass < kPasses; ++pass) {
    const auto start = std::chrono::steady_clock::now();
    for (const Tip& tip : queries.tips) query(tip);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    passes.push_back(elapsed.count() / static_cast<double>(queries.tips.size()));
  }
  return tools::median(passes);
}

/// `query` answers a tip.
template <class Query>
Cost costOf(const Queries& queries, const Query& query) {
  Cost cost;
  const double weight = 1.0 / static_cast<double>(queries.tips.size());
  for (std::size_t i = 0; i < queries.tips.size(); ++i) {
    const Answer answer = query(queries.tips[i]);
    cost.bounds += weight * static_cast<double>(answer.bounds);
    cost.triangles += weight * static_cast<double>(answer.triangles);
    cost.opened += weight * static_cast<double>(answer.opened);
    if (std::sqrt(answer.squared_distance) != queries.distances[i]) ++cost.mismatches;
  }
  cost.time = secondsPerQuery(queries, query);
  return cost;
}

class Comparison {
 public:
  Comparison(const core::CollisionMesh& organ, std::size_t count, std::uint64_t seed)
      : organ_(organ), binary_(organ, 2), wide_(organ, kWidth) {
    for (const tools::Band& band : kBands) {
      Queries queries{band.name, {}, {}};
      for (const Vector3d& point : tools::sampleTips(organ, band, count, seed)) {
        queries.tips.push_back(tipAt(point, organ.health().box));
        queries.distances.push_back(std::abs(core::nearestTriangle(organ, point).distance));
      }
      queries_.push_back(queries);
    }
  }

  std::vector<Row> rows() const {
    tools::Progress progress("measuring", 9);
    std::vector<Row> rows;
    const auto add = [&](const Row& row) {
      rows.push_back(row);
      progress.advance();
    };
    add(row<OneEach<PoleBall>>("pole ball", binary_));
    add(row<OneEach<SmallBall>>("smallest ball", binary_));
    add(row<OneEach<BisectorHalfSpace>>("bisector plane", binary_));
    add(row<OneEach<AxisAlignedBox>>("AABB", binary_));
    add(row<OneEach<OrientedBox>>("OBB", binary_));
    add(row<OneEach<SweptRectangle>>("RSS", binary_));
    add(row<OneEach<AxisAlignedBox>>("AABB, 8-wide", wide_));
    add(row<BoxesInParentsFrame>("one frame, 8-wide", wide_));
    add(libraryRow());
    return rows;
  }

 private:
  template <class Volumes>
  Row row(const std::string& name, const Hierarchy& hierarchy) const {
    BestFirst<Volumes> search(hierarchy);
    Row row{name, Volumes::kBytesPerSet, {}};
    for (const Queries& queries : queries_)
      row.costs.push_back(costOf(queries, [&](const Tip& tip) { return search.nearest(tip); }));
    return row;
  }

  /// The library as it is, signs and normals included.
  Row libraryRow() const {
    Row row{"the library", sizeof(core::Box), {}};
    for (const Queries& queries : queries_) {
      row.costs.push_back(costOf(queries, [&](const Tip& tip) {
        const core::NearestTriangle nearest = core::nearestTriangle(organ_, tip.point);
        return Answer{nearest.closest.squared_distance, nearest.work.bounds, nearest.work.triangles,
                      0};
      }));
    }
    return row;
  }

  const core::CollisionMesh& organ_;
  Hierarchy binary_, wide_;
  std::vector<Queries> queries_;
};

std::string fixed(double value, int decimals) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(decimals) << value;
  return text.str();
}

std::string table(const std::vector<Row>& rows) {
  std::ostringstream text;
  text << std::left << std::setw(20) << "bounds/triangles/us";
  for (const tools::Band& band : kBands) text << std::right << std::setw(22) << band.name;
  text << '\n';
  for (const Row& row : rows) {
    text << std::left << std::setw(20) << row.volume << std::right;
    for (const Cost& cost : row.costs) {
      text << std::setw(22)
           << fixed(cost.bounds, 0) + " /" + fixed(cost.triangles, 1) + " / " +
                  fixed(1e6 * cost.time, 1);
    }
    text << '\n';
  }
  return text.str();
}

std::string csv(const std::vector<Row>& rows, std::size_t triangles) {
  std::string text;
  for (const Row& row : rows) {
    for (std::size_t i = 0; i < row.costs.size(); ++i) {
      const Cost& cost = row.costs[i];
      text +=
          tools::csvLine({std::to_string(triangles), row.volume, std::to_string(row.bytes),
                          kBands[i].name, tools::significant(cost.bounds, 6),
                          tools::significant(cost.triangles, 6), tools::significant(cost.opened, 6),
                          tools::significant(1e6 * cost.time, 6), std::to_string(cost.mismatches)});
    }
  }
  return text;
}

std::size_t mismatches(const std::vector<Row>& rows) {
  std::size_t sum = 0;
  for (const Row& row : rows) {
    for (const Cost& cost : row.costs) sum += cost.mismatches;
  }
  return sum;
}

int run(const tools::Arguments& arguments) {
  const std::filesystem::path folder = arguments.option("--output").value_or(".");
  tools::requireWritableFolder(folder);
  std::string text = tools::csvLine({"mesh_triangles", "volume", "bytes_per_set", "band", "bounds",
                                     "triangles", "opened", "us", "mismatches"});
  std::size_t wrong = 0;
  for (const std::size_t levels : {0, 1}) {
    const core::CollisionMesh organ(liver(levels));
    const Comparison comparison(organ, arguments.whole("--queries", 2000),
                                arguments.whole("--seed", 1));
    const std::vector<Row> rows = comparison.rows();
    const std::size_t triangles = organ.mesh().triangleCount();
    text += csv(rows, triangles);
    wrong += mismatches(rows);
    std::cout << "\nLiver of " << triangles << " triangles, means per exact query\n" << table(rows);
  }
  tools::writeFile(folder / "bounding_volumes.csv", text);
  std::cout << "\nAnswers that differ from the library's: " << wrong
            << "\nWritten: " << (folder / "bounding_volumes.csv").string() << std::endl;
  return wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace organ_collision::bench

int main(int count, char** words) {
  using organ_collision::tools::Arguments;
  try {
    return organ_collision::bench::run(
        Arguments({words + 1, words + count}, {"--output", "--queries", "--seed"}));
  } catch (const std::exception& error) {
    std::cerr << "bounding_volumes: " << error.what() << std::endl;
    return 2;
  }
}
