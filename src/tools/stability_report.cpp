#include "stability_report.h"

#include "output.h"

namespace organ_collision::tools {
namespace {

constexpr std::size_t kNameWidth = 26;
constexpr std::size_t kWidth = 7;       // of a number's column
constexpr std::size_t kWideColumn = 2;  // "triangles"

std::vector<std::size_t> widths(std::size_t columns) {
  std::vector<std::size_t> result(columns, kWidth);
  result[0] = kNameWidth;
  result[kWideColumn] = kWidth + 4;
  return result;
}

std::string lineOf(const std::vector<std::string>& cells) {
  return aligned(cells, widths(cells.size()));
}

std::string cell(const SubjectName& subject, const Tally& tally) {
  if (tally.trials == 0) return "-";
  return subject.is_distance ? fixed(tally.worst, 2) : std::to_string(tally.wrong);
}

std::size_t notFinite(const StabilityRow& row) {
  std::size_t sum = 0;
  for (const Tally& tally : row.tallies) sum += tally.not_finite;
  return sum;
}

std::string tableLine(const StabilityRow& row) {
  std::vector<std::string> cells = {row.name};
  for (const SubjectName& subject : kSubjects) cells.push_back(cell(subject, row[subject.subject]));
  cells.push_back(std::to_string(notFinite(row)));
  cells.push_back(std::to_string(row.depth));
  return lineOf(cells);
}

std::string table(const Stability& stability) {
  std::vector<std::string> headings = {""};
  for (const SubjectName& subject : kSubjects) headings.emplace_back(subject.name);
  headings.insert(headings.end(), {"NaN", "depth"});
  // over the four columns of errors and the five of wrong answers
  std::string lines = aligned({"", "worst error, u*extent", "wrong answers"}, {kNameWidth, 32, 24});
  lines += lineOf(headings);
  for (const StabilityRow& row : stability.rows) lines += tableLine(row);
  return lines;
}

}  // namespace

std::vector<std::string> brokenPromises(const Stability& stability) {
  std::vector<std::string> broken;
  for (const StabilityRow& row : stability.rows) {
    for (const SubjectName& subject : kSubjects) {
      const Tally& tally = row[subject.subject];
      if (tally.isKept()) continue;
      broken.push_back(row.name + ", " + subject.name + ": " + significant(tally.worst) +
                       " u*extent, " + std::to_string(tally.not_finite) + " not finite, " +
                       std::to_string(tally.wrong) + " wrong of " + std::to_string(tally.trials));
    }
  }
  return broken;
}

std::string report(const Stability& stability) {
  const Trials trials(stability.samples);
  std::string text =
      "In each class " + std::to_string(trials.points) + " points and triangles, " +
      std::to_string(trials.pairs) + " pairs of triangles, " + std::to_string(trials.tips) +
      " tips around an organ; seed " + std::to_string(stability.seed) + ".\n" +
      "u = 2^-53; extent: the longest vector from the query to a corner. The truth is known by\n"
      "exact rational arithmetic.\n\n" +
      table(stability) + "\nPromised: no error above " + significant(kPromisedError) +
      " u*extent, nothing wrong, no number that is not finite.\n";
  const std::vector<std::string> broken = brokenPromises(stability);
  for (const std::string& promise : broken) text += "BROKEN: " + promise + "\n";
  return text + (broken.empty() ? "All promises are kept.\n" : "");
}

std::string csv(const Stability& stability) {
  std::string text = csvLine({"class", "subject", "trials", "worst error [u*extent]", "not finite",
                              "wrong", "depth", "samples", "seed"});
  for (const StabilityRow& row : stability.rows) {
    for (const SubjectName& subject : kSubjects) {
      const Tally& tally = row[subject.subject];
      if (tally.trials == 0) continue;
      text += csvLine({row.name, subject.name, std::to_string(tally.trials),
                       subject.is_distance ? significant(tally.worst, 17) : "",
                       std::to_string(tally.not_finite), std::to_string(tally.wrong),
                       std::to_string(row.depth), std::to_string(stability.samples),
                       std::to_string(stability.seed)});
    }
  }
  return text;
}

}  // namespace organ_collision::tools
