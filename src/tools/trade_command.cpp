#include "trade_command.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>

#include "arguments.h"
#include "organ_collision/io/mesh_io.h"
#include "output.h"
#include "program.h"
#include "progress.h"
#include "tip_samples.h"
#include "trade.h"
#include "trade_report.h"

namespace organ_collision::tools {
namespace {

constexpr std::size_t kMostQueries = 10'000'000;  // a quarter of a gigabyte of tips in each band

constexpr const char* kUsage =
    "usage: measure_trade MESH [--output DIR] [--scale S] [--tips FILE.csv] [--queries N] [--seed "
    "N]\n"
    "\n"
    "Measures what accuracy costs on your own mesh, from the paper's greedy search to exact.\n"
    "Prints a table for each distance from the surface and recommends settings; writes trade.csv\n"
    "and trade.svg. Of each tip's times the least of several rounds counts: p99 tells how tips\n"
    "differ, not what else the machine did.\n"
    "\n"
    "  MESH            a file, or package://PACKAGE/PATH\n"
    "  --output DIR    where trade.csv and trade.svg are written (default: here)\n"
    "  --scale S       metres per unit of the mesh (default 1; 0.001 for millimetres)\n"
    "  --tips FILE     a path of your own: x,y,z in metres in each line, in the mesh's frame;\n"
    "                  errors are told of these tips, without confidence for others\n"
    "  --queries N     tips in each distance band (default 10000)\n"
    "  --seed N        of the random tips (default 1): the same seed gives the same counts and "
    "errors\n"
    "  --help          this\n";

struct Options {
  std::string mesh;
  std::filesystem::path output;
  double scale;
  std::optional<std::string> tips;
  std::size_t queries;
  std::uint64_t seed;
};

/// Throws UsageError.
Options optionsFrom(const std::vector<std::string>& words) {
  const Arguments arguments(words, {"--output", "--scale", "--tips", "--queries", "--seed"});
  if (arguments.words().size() != 1) {
    throw UsageError(std::to_string(arguments.words().size()) + " meshes, but one is wanted");
  }
  return {arguments.words().front(),
          arguments.option("--output").value_or("."),
          arguments.aboveZero("--scale", 1.0),
          arguments.option("--tips"),
          arguments.whole("--queries", 10'000, 1, kMostQueries),
          arguments.whole("--seed", 1)};
}

/// What is to be measured: a name and tips.
struct Job {
  std::string name;
  core::Points tips;
  std::optional<std::uint64_t> seed;  ///< see measureBand()
};

std::vector<Job> sampledJobs(const core::CollisionMesh& organ, const Options& options) {
  const std::vector<Band> wanted = bands();
  Progress progress("choosing tips", wanted.size());
  std::vector<Job> jobs;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    jobs.push_back({wanted[i].name, sampleTips(organ, wanted[i], options.queries, options.seed + i),
                    options.seed});
    progress.advance();
  }
  return jobs;
}

/// Measures all jobs under one progress bar.
std::vector<BandTrade> measureAll(const core::CollisionMesh& organ, const std::vector<Job>& jobs) {
  std::size_t tips = 0;
  for (const Job& job : jobs) tips += job.tips.size();
  Progress progress("measuring", tips);
  std::vector<BandTrade> result;
  result.reserve(jobs.size());
  for (const Job& job : jobs) {
    result.push_back(measureBand(organ, job.name, job.tips, job.seed,
                                 [&](std::size_t done) { progress.advance(done); }));
  }
  return result;
}

void run(const Options& options, std::ostream& out, std::ostream& errors) {
  core::Points path;
  if (options.tips) path = readTips(*options.tips);
  const std::filesystem::path file = io::resolveMesh(options.mesh, findPackage, std::nullopt);
  core::TriangleMesh mesh = io::loadMesh(file, options.scale);
  requireWritableFolder(options.output);
  std::optional<core::CollisionMesh> organ;
  const double build = secondsOf([&] { organ.emplace(std::move(mesh)); });
  for (const std::string& warning : core::warnings(organ->health())) {
    errors << "warning: " << warning << "\n";
  }

  std::vector<Job> jobs = sampledJobs(*organ, options);
  if (options.tips) jobs.push_back({"tips of " + *options.tips, path, std::nullopt});
  Trade trade{file.filename().string(),    organ->mesh().triangleCount(), options.seed,
              measureCosts(*organ, build), measureAll(*organ, jobs),      std::nullopt};
  if (options.tips) {
    trade.path = std::move(trade.bands.back());
    trade.bands.pop_back();
  }

  out << report(trade) << std::flush;  // whatever becomes of the files
  writeFile(options.output / "trade.csv", csv(trade));
  writeFile(options.output / "trade.svg", svg(figure(trade)));
  out << "\nWritten: " << (options.output / "trade.csv").string() << ", "
      << (options.output / "trade.svg").string() << std::endl;
}

}  // namespace

int measureTrade(const std::vector<std::string>& words, std::ostream& out, std::ostream& errors) {
  return runProgram({"measure_trade", kUsage}, words, out, errors,
                    [&](const auto& given) { run(optionsFrom(given), out, errors); });
}

}  // namespace organ_collision::tools
