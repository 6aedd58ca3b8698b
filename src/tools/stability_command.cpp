#include "stability_command.h"

#include <cstdint>
#include <filesystem>
#include <stdexcept>

#include "arguments.h"
#include "output.h"
#include "program.h"
#include "progress.h"
#include "stability_report.h"

namespace organ_collision::tools {
namespace {

constexpr std::size_t kFewestSamples = 100;  // one tip in each class
constexpr std::size_t kMostSamples = 100'000'000;

constexpr const char* kUsage =
    "usage: measure_stability [--output DIR] [--seed N] [--samples N]\n"
    "\n"
    "Measures how far answers are from the truth, known by exact arithmetic, at the extremes:\n"
    "needles, caps, triangles without area, ties, far from the origin, at any scale. Prints a\n"
    "table; writes stability.csv. A promise that is broken ends it with exit code 1.\n"
    "\n"
    "  --output DIR    where stability.csv is written (default: here)\n"
    "  --seed N        of the random inputs (default 1): the same seed gives the same table\n"
    "  --samples N     points and triangles in each class (default 100000); of pairs of\n"
    "                  triangles there are a tenth, of tips around an organ a hundredth\n"
    "  --help          this\n";

struct Options {
  std::filesystem::path output;
  std::uint64_t seed;
  std::size_t samples;
};

/// Throws UsageError.
Options optionsFrom(const std::vector<std::string>& words) {
  const Arguments arguments(words, {"--output", "--seed", "--samples"});
  arguments.requireNoWords();
  return {arguments.option("--output").value_or("."), arguments.whole("--seed", 1),
          arguments.whole("--samples", 100'000, kFewestSamples, kMostSamples)};
}

Stability measureAll(const Library& library, const Options& options) {
  const std::vector<Extreme> classes = extremes();
  const Trials trials(options.samples);
  Progress progress("measuring", classes.size() * trials.tips);
  Stability stability{options.samples, options.seed, {}};
  for (std::size_t i = 0; i < classes.size(); ++i) {
    stability.rows.push_back(measureStability(
        classes[i], trials, options.seed + i, [&progress] { progress.advance(); }, library));
  }
  return stability;
}

/// Throws std::runtime_error where a promise is broken.
void run(const Library& library, const Options& options, std::ostream& out) {
  requireWritableFolder(options.output);
  const Stability stability = measureAll(library, options);
  out << report(stability) << std::flush;  // whatever becomes of the file
  const std::filesystem::path file = options.output / "stability.csv";
  writeFile(file, csv(stability));
  out << "\nWritten: " << file.string() << std::endl;
  if (!brokenPromises(stability).empty()) throw std::runtime_error("a promise is broken");
}

}  // namespace

int measureStability(const std::vector<std::string>& words, std::ostream& out, std::ostream& errors,
                     const Library& library) {
  const auto measure = [&](const auto& given) { run(library, optionsFrom(given), out); };
  return runProgram({"measure_stability", kUsage}, words, out, errors, measure);
}

}  // namespace organ_collision::tools
