#include "trade_report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>

#include "output.h"

namespace organ_collision::tools {
namespace {

constexpr double kMicroseconds = 1e6;  // per second
constexpr double kMilliseconds = 1e3;  // per second
constexpr double kMillimetres = 1e3;   // per metre
constexpr double kPercent = 100.0;

constexpr std::size_t kNearBands = 2;  // 0-1 and 1-5 mm, the first of bands()
constexpr std::array<double, 3> kErrorsAskedFor = {1e-3, 1e-4, 1e-5};  // [m]

/// A length [m] in mm that fits a column: 0 only if there is none.
std::string millimetres(double length) {
  const double value = length * kMillimetres;
  if (value == 0.0) return "0";
  if (value < 5e-5) return "<.0001";
  return fixed(value, value < 10.0 ? 4 : value < 1000.0 ? 2 : 0);
}

std::string microseconds(double time) {
  const double value = time * kMicroseconds;
  return fixed(value, value < 100.0 ? 2 : 0);
}

std::string perQuery(double count) { return fixed(count, count < 1000.0 ? 1 : 0); }

std::string centred(const std::string& words, std::size_t width) {
  const std::size_t spare = width - std::min(width, words.size());
  return std::string(spare - spare / 2, ' ') + words + std::string(spare / 2, ' ');
}

/// What 99.9 % of the errors stay below [m] with 95 % confidence, or, where there is none, the
/// largest that was seen.
double measuredLimit(const Summary& summary) {
  return summary.confidence ? summary.confidence->error_p999_limit : summary.error_max;
}

/// An upper limit [m] of a setting's errors: the proven one or the measured one.
double errorLimit(const core::Accuracy& accuracy, const Summary& summary) {
  const bool is_proven = accuracy.max_leaves == 0 && accuracy.max_relative_error == 0.0;
  const double measured = measuredLimit(summary);
  return is_proven ? std::min(accuracy.max_absolute_error, measured) : measured;
}

/// How to set a mark of the dial.
std::string inWords(const Setting& setting) {
  switch (setting.family) {
    case Family::kGreedy:
      return "max_leaves 1 (greedy)";
    case Family::kLeaves:
      return "max_leaves " + std::to_string(setting.accuracy.max_leaves);
    case Family::kRelative:
      return "max_relative_error " + significant(setting.accuracy.max_relative_error);
    case Family::kAbsolute:
      return "max_absolute_error " + significant(setting.accuracy.max_absolute_error) + " m";
    case Family::kExact:
      break;
  }
  return "all zero (exact)";
}

using BandList = std::vector<const BandTrade*>;

/// The bands of `from` that have tips.
BandList withTips(const std::vector<BandTrade>& from) {
  BandList result;
  for (const BandTrade& band : from) {
    if (band.tipCount() > 0) result.push_back(&band);
  }
  return result;
}

/// The interval of the share of nearest triangles [%].
std::string recallIn(const std::optional<Confidence>& confidence) {
  if (!confidence) return "-";
  const Interval& recall = confidence->recall;
  return fixed(kPercent * recall.low, 1) + "-" + fixed(kPercent * recall.high, 1);
}

std::vector<double> pooledTimes(const BandList& bands, std::size_t s) {
  std::vector<double> times;
  for (const BandTrade* band : bands) {
    times.insert(times.end(), band->samples[s].times.begin(), band->samples[s].times.end());
  }
  return times;
}

/// The fastest setting whose errors stay within `error` [m] in all of `bands`; the exact one if it
/// costs hardly more. REQUIRES: bands are not empty.
std::size_t fastestWithin(double error, const BandList& bands) {
  constexpr double kWorthwhile = 0.9;  // of the exact setting's time: less is noise
  const std::vector<Setting> settings = dial();
  std::size_t best = settings.size() - 1;
  double best_time = kWorthwhile * median(pooledTimes(bands, best));
  for (std::size_t s = 0; s + 1 < settings.size(); ++s) {
    const bool is_within = std::all_of(bands.begin(), bands.end(), [&](const BandTrade* band) {
      return errorLimit(settings[s].accuracy, band->summaries[s]) <= error;
    });
    const double time = median(pooledTimes(bands, s));
    if (!is_within || time >= best_time) continue;
    best = s;
    best_time = time;
  }
  return best;
}

/// How to set it, and its times.
std::string inWords(std::size_t s, const BandList& bands) {
  const std::vector<double> times = pooledTimes(bands, s);
  return inWords(dial()[s]) + ", " + microseconds(median(times)) + " us (p99 " +
         microseconds(percentile(times, 0.99)) + " us)";
}

/// `on_what`: what the errors are told of.
std::string recommendationFor(const std::string& where, const BandList& bands,
                              const std::string& on_what = "on this mesh") {
  if (bands.empty()) return "";
  const bool is_told = std::all_of(bands.begin(), bands.end(), [](const BandTrade* band) {
    return std::isfinite(measuredLimit(band->summaries.front()));
  });
  std::string lines =
      where + (is_told ? ":\n" : " (too few tips to tell 99.9 %: proven errors only):\n");
  for (const double error : kErrorsAskedFor) {
    lines += "  for an error below " + significant(error * kMillimetres) + " mm " + on_what + ": " +
             inWords(fastestWithin(error, bands), bands) + "\n";
  }
  return lines + "  for the exact answer: " + inWords(dial().size() - 1, bands) + "\n";
}

/// One number of a row.
struct Cell {
  std::string column, value;
};

std::vector<Cell> csvRow(const Trade& trade, const BandTrade& band, std::size_t s) {
  const Setting setting = dial()[s];
  const Summary& summary = band.summaries[s];
  const auto full = [](double value) { return significant(value, 9); };
  const auto mm = [&](double length) { return full(length * kMillimetres); };
  const Confidence confidence = summary.confidence.value_or(Confidence{});
  const auto if_any = [&](const std::string& value) { return summary.confidence ? value : ""; };
  return {{"band", band.name},
          {"setting", setting.name},
          {"max_relative_error", full(setting.accuracy.max_relative_error)},
          {"max_absolute_error [m]", full(setting.accuracy.max_absolute_error)},
          {"max_leaves", std::to_string(setting.accuracy.max_leaves)},
          {"tips", std::to_string(band.tipCount())},
          {"time median [us]", full(summary.time_median * kMicroseconds)},
          {"time p99 [us]", full(summary.time_p99 * kMicroseconds)},
          {"bounds per query", full(summary.bounds)},
          {"triangle tests per query", full(summary.triangles)},
          {"recall", full(summary.recall)},
          {"recall low (95 %)", if_any(full(confidence.recall.low))},
          {"recall high (95 %)", if_any(full(confidence.recall.high))},
          {"error mean [mm]", mm(summary.error_mean)},
          {"error mean low (95 %) [mm]", if_any(mm(confidence.error_mean.low))},
          {"error mean high (95 %) [mm]", if_any(mm(confidence.error_mean.high))},
          {"error p50 [mm]", mm(summary.error_p50)},
          {"error p99 [mm]", mm(summary.error_p99)},
          {"error p99 low (95 %) [mm]", if_any(mm(confidence.error_p99.low))},
          {"error p99 high (95 %) [mm]", if_any(mm(confidence.error_p99.high))},
          {"error p99.9 [mm]", mm(summary.error_p999)},
          {"error p99.9 upper limit (95 %) [mm]", if_any(mm(confidence.error_p999_limit))},
          {"error max [mm]", mm(summary.error_max)},
          {"proven gap mean [mm]", mm(summary.gap_mean)},
          {"proven gap p99 [mm]", mm(summary.gap_p99)},
          {"violations", std::to_string(band.samples[s].violations)},
          {"triangles", std::to_string(trade.triangles)},
          {"seed", std::to_string(trade.seed)},
          {"build [ms]", full(trade.costs.build * kMilliseconds)},
          {"refit [ms]", full(trade.costs.refit * kMilliseconds)},
          {"rebuild [ms]", full(trade.costs.rebuild * kMilliseconds)},
          {"memory [bytes per triangle]", full(trade.costs.memory)}};
}

struct FamilyLook {
  Family family;
  const char* name;
  const char* colour;
};

constexpr std::array<FamilyLook, 5> kFamilies = {
    {{Family::kGreedy, "greedy (the paper)", colours::kVermilion},
     {Family::kLeaves, "max_leaves", colours::kBlue},
     {Family::kRelative, "max_relative_error", colours::kGreen},
     {Family::kAbsolute, "max_absolute_error", colours::kPurple},
     {Family::kExact, "exact", colours::kBlack}}};

/// No other setting is as good in both and better in one.
bool isParetoBest(const std::vector<Summary>& summaries, std::size_t s) {
  const Summary& own = summaries[s];
  return std::none_of(summaries.begin(), summaries.end(), [&](const Summary& other) {
    return other.time_median <= own.time_median && other.error_p99 <= own.error_p99 &&
           (other.time_median < own.time_median || other.error_p99 < own.error_p99);
  });
}

PlotPoint pointOf(const Setting& setting, const Summary& summary, bool is_best) {
  const bool is_named =
      is_best || setting.family == Family::kGreedy || setting.family == Family::kExact;
  return {summary.time_median * kMicroseconds, summary.error_p99 * kMillimetres,
          is_named ? setting.name : "", is_best};
}

PlotSeries front(const std::vector<Summary>& summaries) {
  PlotSeries line{"Pareto front", "#999999", {}, true, false, true};
  for (std::size_t s = 0; s < summaries.size(); ++s) {
    if (isParetoBest(summaries, s)) line.points.push_back(pointOf({}, summaries[s], true));
  }
  for (PlotPoint& point : line.points) point.label.clear();
  std::sort(line.points.begin(), line.points.end(),
            [](const PlotPoint& a, const PlotPoint& b) { return a.x < b.x; });
  return line;
}

Plot plotOf(const BandTrade& band) {
  Plot plot{band.name,
            {"median time of a query [µs]", true},
            {"p99 of the error [mm]", true, "no error"},
            {front(band.summaries)}};
  const std::vector<Setting> settings = dial();
  for (const FamilyLook& look : kFamilies) {
    PlotSeries series{look.name, look.colour, {}};
    for (std::size_t s = 0; s < settings.size(); ++s) {
      if (settings[s].family != look.family) continue;
      series.points.push_back(
          pointOf(settings[s], band.summaries[s], isParetoBest(band.summaries, s)));
    }
    plot.series.push_back(series);
  }
  return plot;
}

BandList allBands(const Trade& trade) {
  BandList bands = withTips(trade.bands);
  if (trade.path) bands.push_back(&*trade.path);
  return bands;
}

std::size_t violationsOf(const BandTrade& band) {
  std::size_t sum = 0;
  for (const Samples& samples : band.samples) sum += samples.violations;
  return sum;
}

std::string costLines(const Trade& trade) {
  const auto ms = [](double time) { return significant(time * kMilliseconds) + " ms"; };
  return "Building the hierarchy: " + ms(trade.costs.build) +
         "; refitting it to moved vertices: " + ms(trade.costs.refit) +
         ";\nrebuilding it: " + ms(trade.costs.rebuild) +
         "; memory: " + fixed(trade.costs.memory, 0) + " bytes per triangle.\n";
}

}  // namespace

std::string table(const BandTrade& band) {
  if (band.tipCount() == 0) {
    return band.name + ": no tips; there is no room for them, or nothing proves what is inside\n";
  }
  const std::vector<std::size_t> widths = {9, 7, 7, 7, 6, 7, 12, 8, 7, 7, 7, 7, 8, 7};
  std::string lines = band.name + ": " + std::to_string(band.tipCount()) + " tips, " +
                      std::to_string(violationsOf(band)) + " violations of bounds or promises\n";
  lines += std::string(9, ' ') + centred("time [us]", 14) + centred("per query", 13) +
           centred("found nearest [%]", 19) + centred("error [mm]", 36) + "    gap [mm]\n";
  lines += aligned({"setting", "median", "p99", "bounds", "tris", "found", "95 % conf.", "mean",
                    "p50", "p99", "p99.9", "max", "mean", "p99"},
                   widths);
  const std::vector<Setting> settings = dial();
  for (std::size_t s = 0; s < settings.size(); ++s) {
    const Summary& summary = band.summaries[s];
    lines += aligned(
        {settings[s].name, microseconds(summary.time_median), microseconds(summary.time_p99),
         perQuery(summary.bounds), perQuery(summary.triangles), fixed(kPercent * summary.recall, 2),
         recallIn(summary.confidence), millimetres(summary.error_mean),
         millimetres(summary.error_p50), millimetres(summary.error_p99),
         millimetres(summary.error_p999), millimetres(summary.error_max),
         millimetres(summary.gap_mean), millimetres(summary.gap_p99)},
        widths);
  }
  return lines;
}

std::string recommendation(const Trade& trade) {
  BandList near;
  for (std::size_t i = 0; i < std::min(kNearBands, trade.bands.size()); ++i)
    if (trade.bands[i].tipCount() > 0) near.push_back(&trade.bands[i]);
  std::string lines =
      "Recommended: the fastest setting for which 99.9 % of the errors stay below (proven, or "
      "with\n"
      "95 % confidence in every band), and its time.\n";
  lines += recommendationFor("Within 5 mm of the surface", near);
  lines += recommendationFor("Anywhere", withTips(trade.bands));
  if (!trade.path) return lines;
  return lines + recommendationFor(trade.path->name + ", by the largest error seen", {&*trade.path},
                                   "on these tips");
}

std::string report(const Trade& trade) {
  std::string text = trade.mesh + ": " + std::to_string(trade.triangles) +
                     " triangles\nTimes: of each tip the least of " + std::to_string(kRounds) +
                     " rounds.\n\n";
  for (const BandTrade& band : trade.bands) text += table(band) + "\n";
  if (trade.path) text += table(*trade.path) + "\n";
  return text + costLines(trade) + "\n" + recommendation(trade);
}

std::string csv(const Trade& trade) {
  const auto line = [](const std::vector<Cell>& row, std::string Cell::*part) {
    std::vector<std::string> fields(row.size());
    std::transform(row.begin(), row.end(), fields.begin(), std::mem_fn(part));
    return csvLine(fields);
  };
  BandTrade empty;  // a heading there is also where no band has tips
  empty.samples.resize(1);
  empty.summaries.resize(1);
  std::string text = line(csvRow(trade, empty, 0), &Cell::column);
  for (const BandTrade* band : allBands(trade)) {
    for (std::size_t s = 0; s < band->summaries.size(); ++s)
      text += line(csvRow(trade, *band, s), &Cell::value);
  }
  return text;
}

Figure figure(const Trade& trade) {
  Figure result;
  result.title = "Speed against accuracy on " + trade.mesh + ", " +
                 std::to_string(trade.triangles) + " triangles";
  result.note =
      "Left is faster, down is more accurate. Filled: no other setting is better in both; these, "
      "greedy and exact are named.";
  result.columns = 3;
  result.plot_width = 330.0;
  result.plot_height = 300.0;
  result.common_axes = true;
  for (const BandTrade* band : allBands(trade)) result.plots.push_back(plotOf(*band));
  return result;
}

}  // namespace organ_collision::tools
