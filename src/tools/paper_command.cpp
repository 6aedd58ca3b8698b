#include "paper_command.h"

#include <cstdint>
#include <filesystem>

#include "arguments.h"
#include "output.h"
#include "paper_experiment.h"
#include "paper_report.h"
#include "program.h"
#include "progress.h"

namespace organ_collision::tools {
namespace {

constexpr std::size_t kMostSteps = 10'000'000;  // a gigabyte of tips

constexpr const char* kUsage =
    "usage: reproduce_paper [--output DIR] [--seed N] [--steps N]\n"
    "\n"
    "Measures the paper's greedy search, with the exact one beside it, on the 23 meshes of its\n"
    "Table 1, and what the paper does not tell: how often the greedy answer is a nearest triangle\n"
    "and how far off it is. Prints a table; writes paper_table1.csv and paper_fig4.svg.\n"
    "\n"
    "  --output DIR    where the files are written (default: here)\n"
    "  --seed N        of the tip's path (default 1): the same seed gives the same counts and "
    "errors\n"
    "  --steps N       queries on each mesh (default 10000)\n"
    "  --help          this\n";

struct Options {
  std::filesystem::path output;
  std::uint64_t seed;
  std::size_t steps;
};

/// Throws UsageError.
Options optionsFrom(const std::vector<std::string>& words) {
  const Arguments arguments(words, {"--output", "--seed", "--steps"});
  arguments.requireNoWords();
  return {arguments.option("--output").value_or("."), arguments.whole("--seed", 1),
          arguments.whole("--steps", 10'000, 1, kMostSteps)};
}

std::vector<PaperRow> measureAll(const Options& options) {
  const std::vector<PaperGrid> grids = paperGrids();
  Progress progress("measuring", grids.size() * (kPasses + 1));
  return measure(grids, options.steps, options.seed, [&] { progress.advance(); });
}

void run(const Options& options, std::ostream& out) {
  requireWritableFolder(options.output);
  const std::vector<PaperRow> rows = measureAll(options);
  out << paperTable(rows) << std::flush;  // whatever becomes of the files
  const std::filesystem::path table = options.output / "paper_table1.csv";
  const std::filesystem::path figure = options.output / "paper_fig4.svg";
  writeFile(table, paperCsv(rows));
  writeFile(figure, svg(paperFigure(rows)));
  out << "\nWritten: " << table.string() << ", " << figure.string() << std::endl;
}

}  // namespace

int reproducePaper(const std::vector<std::string>& words, std::ostream& out, std::ostream& errors) {
  return runProgram({"reproduce_paper", kUsage}, words, out, errors,
                    [&](const auto& given) { run(optionsFrom(given), out); });
}

}  // namespace organ_collision::tools
