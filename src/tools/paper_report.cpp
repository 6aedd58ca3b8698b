#include "paper_report.h"

#include <algorithm>
#include <functional>
#include <sstream>

#include "output.h"
#include "statistics.h"

namespace organ_collision::tools {
namespace {

constexpr double kMicrosecondsPerSecond = 1e6;
constexpr double kPerCent = 100.0;

using Quantity = std::function<double(const PaperRow&)>;

struct Column {
  std::string name;     ///< in the CSV file, with the unit
  std::string over;     ///< in the table: what this and the next columns share
  std::string heading;  ///< in the table; empty: only in the CSV file
  int decimals;         ///< in the table
  Quantity value;
};

double greedyTime(const PaperRow& row) { return kMicrosecondsPerSecond * row.greedy_time; }
double exactTime(const PaperRow& row) { return kMicrosecondsPerSecond * row.exact_time; }
double share(const PaperRow& row) {
  return kPerCent * static_cast<double>(row.greedy_is_right) / static_cast<double>(row.steps);
}
double lowShare(const PaperRow& row) {
  return kPerCent * wilsonInterval(row.greedy_is_right, row.steps).low;
}
double highShare(const PaperRow& row) {
  return kPerCent * wilsonInterval(row.greedy_is_right, row.steps).high;
}

/// What stands in `member`.
template <class T>
Quantity its(T PaperRow::*member) {
  return [member](const PaperRow& row) { return static_cast<double>(row.*member); };
}
template <class T>
Quantity its(T PaperGrid::*member) {
  return [member](const PaperRow& row) { return static_cast<double>(row.grid.*member); };
}

std::vector<Column> columns() {
  return {{"columns", "", "grid", 0, its(&PaperGrid::columns)},
          {"rows", "", "by", 0, its(&PaperGrid::rows)},
          {"triangles", "", "triangles", 0, its(&PaperRow::triangles)},
          {"vertices", "", "vertices", 0, its(&PaperRow::vertices)},
          {"edges_in_paper", "edges", "paper", 0, its(&PaperGrid::edges_in_table)},
          {"edges", "", "true", 0, its(&PaperRow::edges)},
          {"depth", "", "", 0, its(&PaperRow::depth)},
          {"greedy_us", "time, us", "greedy", 2, greedyTime},
          {"exact_us", "", "exact", 2, exactTime},
          {"queries", "", "", 0, its(&PaperRow::steps)},
          {"greedy_is_right", "", "", 0, its(&PaperRow::greedy_is_right)},
          {"greedy_is_right_percent", "greedy is right", "%", 1, share},
          {"greedy_is_right_low_percent", "", "from", 1, lowShare},
          {"greedy_is_right_high_percent", "", "to", 1, highShare},
          {"greedy_error_mean_cells", "its error, cells", "mean", 3, its(&PaperRow::mean_error)},
          {"greedy_error_p99_cells", "", "p99", 2, its(&PaperRow::p99_error)},
          {"greedy_error_worst_cells", "", "worst", 2, its(&PaperRow::worst_error)},
          {"greedy_nodes", "greedy", "nodes", 1, its(&PaperRow::greedy_nodes)},
          {"exact_boxes", "exact", "boxes", 1, its(&PaperRow::exact_boxes)},
          {"exact_triangles", "", "triangles", 1, its(&PaperRow::exact_triangles)}};
}

/// One column's lines, padded to one width; a heading that several share may run over to the right.
std::vector<std::string> lines(const Column& column, const std::vector<PaperRow>& rows) {
  std::vector<std::string> cells = {column.heading};
  for (const PaperRow& row : rows) cells.push_back(fixed(column.value(row), column.decimals));
  std::size_t width = 0;
  for (const std::string& cell : cells) width = std::max(width, cell.size());
  for (std::string& cell : cells) cell.insert(0, width - cell.size() + 2, ' ');
  return cells;
}

/// The sum over all meshes' queries.
double total(const std::vector<PaperRow>& rows, const Quantity& quantity) {
  double sum = 0.0;
  for (const PaperRow& row : rows) sum += quantity(row);
  return sum;
}

std::string summary(const std::vector<PaperRow>& rows) {
  const auto worst = std::max_element(rows.begin(), rows.end(), [](auto& left, auto& right) {
    return left.worst_error < right.worst_error;
  });
  const PaperRow& last = rows.back();
  const double queries = total(rows, its(&PaperRow::steps));
  const double right = total(rows, its(&PaperRow::greedy_is_right));
  std::ostringstream text;
  text << "The greedy search named a nearest triangle in " << fixed(kPerCent * right / queries, 1)
       << " % of " << fixed(queries, 0) << " queries; its worst answer was "
       << fixed(worst->worst_error, 2) << " cells too far.\nOn " << last.triangles
       << " triangles it takes " << fixed(greedyTime(last), 2) << " us, the exact search "
       << fixed(exactTime(last), 2) << " us.\n";
  return text.str();
}

PlotSeries series(const std::string& name, const char* colour, const std::vector<PaperRow>& rows,
                  const Quantity& value) {
  PlotSeries result{name, colour, {}};
  for (const PaperRow& row : rows)
    result.points.push_back({static_cast<double>(row.triangles), value(row)});
  result.line = true;
  return result;
}

PlotSeries limit(const std::vector<PaperRow>& rows, const Quantity& value) {
  PlotSeries result = series("95 % confidence", colours::kOrange, rows, value);
  result.markers = false;
  result.dashed = true;
  return result;
}

}  // namespace

std::string paperTable(const std::vector<PaperRow>& rows) {
  std::string over;
  std::vector<std::string> table(rows.size() + 1);
  for (const Column& column : columns()) {
    if (column.heading.empty()) continue;
    const std::vector<std::string> column_lines = lines(column, rows);
    if (!column.over.empty()) {
      over.resize(table.front().size() + 2, ' ');
      over += column.over;
    }
    for (std::size_t i = 0; i < table.size(); ++i) table[i] += column_lines[i];
  }
  std::string text = over + '\n';
  for (const std::string& line : table) text += line + '\n';
  return text + '\n' + summary(rows);
}

std::string paperCsv(const std::vector<PaperRow>& rows) {
  constexpr int kDigits = 9;
  std::vector<std::string> names;
  for (const Column& column : columns()) names.push_back(column.name);
  std::string text = csvLine(names);
  for (const PaperRow& row : rows) {
    std::vector<std::string> fields;
    for (const Column& column : columns())
      fields.push_back(significant(column.value(row), kDigits));
    text += csvLine(fields);
  }
  return text;
}

Figure paperFigure(const std::vector<PaperRow>& rows) {
  const PlotAxis size = {"triangles", true};
  const auto boxes = [](const PaperRow& row) { return row.exact_boxes + row.exact_triangles; };
  const auto nodes = [](const PaperRow& row) { return row.greedy_nodes + 1.0; };
  Figure figure;
  figure.title = "Fig. 4 of Muñoz et al. (2012), measured again";
  figure.note = "A triangle is translated over the open grids of Table 1, " +
                std::to_string(rows.front().steps) + " queries on each";
  figure.columns = 3;
  figure.plots = {
      {"Time of a query",
       size,
       {"time [µs]"},
       {series("greedy (the paper)", colours::kOrange, rows, greedyTime),
        series("exact", colours::kBlue, rows, exactTime)}},
      {"Work of a query",
       size,
       {"boxes and triangles measured"},
       {series("greedy (the paper)", colours::kOrange, rows, nodes),
        series("exact", colours::kBlue, rows, boxes)}},
      {"How often the answer is a nearest triangle",
       size,
       {"queries [%]"},
       {series("greedy (the paper)", colours::kOrange, rows, share), limit(rows, lowShare),
        limit(rows, highShare),
        series("exact", colours::kBlue, rows, [](const PaperRow&) { return kPerCent; })}}};
  return figure;
}

}  // namespace organ_collision::tools
