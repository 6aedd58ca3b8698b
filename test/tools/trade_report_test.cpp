#include "tools/trade_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <sstream>

namespace organ_collision::tools {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr std::size_t kGreedy = 0;
constexpr std::size_t kLeaves16 = 4;
constexpr std::size_t kLeaves64 = 5;
constexpr std::size_t kOnePercent = 6;
constexpr std::size_t kTenthOfMillimetre = 11;
constexpr std::size_t kExact = 13;

/// A band in which every setting takes 10 us and errs by 9 mm, the exact one by nothing.
BandTrade bandOf(const std::string& name) {
  BandTrade band{name, {}, {}};
  for (std::size_t s = 0; s < dial().size(); ++s) {
    band.samples.push_back({{10e-6}, {9e-3}, {9e-3}, {{1, 1}}, 0});
    Summary summary{};
    summary.time_median = summary.time_p99 = 10e-6;
    summary.error_p99 = summary.error_max = s == kExact ? 0.0 : 9e-3;
    summary.confidence = Confidence{{}, {}, {}, summary.error_p99};
    band.summaries.push_back(summary);
  }
  return band;
}

/// The same of tips that are not independent.
BandTrade pathOf(const std::string& name) {
  BandTrade path = bandOf(name);
  for (Summary& summary : path.summaries) summary.confidence.reset();
  return path;
}

void set(BandTrade& band, std::size_t setting, double time, double error) {
  band.samples[setting].times = {time};
  band.summaries[setting].time_median = time;
  band.summaries[setting].error_p99 = error;
  band.summaries[setting].error_max = error;
  auto& confidence = band.summaries[setting].confidence;
  if (confidence) confidence->error_p999_limit = error;
}

BandTrade emptyBand(const std::string& name) {
  return {name, std::vector<Samples>(dial().size()), {}};
}

Trade tradeOf(std::vector<BandTrade> bands) {
  return {"organ.obj", 1000, 7, {}, std::move(bands), {}};
}

TEST(Recommendation, IsTheFastestSettingThatStaysBelowTheError) {
  BandTrade band = bandOf("0-1 mm");
  set(band, kGreedy, 1e-6, 2e-3);
  set(band, kLeaves16, 2e-6, 5e-5);
  set(band, kLeaves64, 3e-6, 5e-6);
  const std::string words = recommendation(tradeOf({band}));
  EXPECT_THAT(words, HasSubstr("below 1 mm on this mesh: max_leaves 16, 2.00 us (p99 2.00 us)\n"));
  EXPECT_THAT(words, HasSubstr("below 0.1 mm on this mesh: max_leaves 16, 2.00 us"));
  EXPECT_THAT(words, HasSubstr("below 0.01 mm on this mesh: max_leaves 64, 3.00 us"));
  EXPECT_THAT(words, HasSubstr("for the exact answer: all zero (exact), 10.00 us"));
}

TEST(Recommendation, HoldsInTheWorstBand) {
  BandTrade near = bandOf("0-1 mm");
  BandTrade next = bandOf("1-5 mm");
  BandTrade far = bandOf("far");
  for (BandTrade* band : {&near, &next, &far}) set(*band, kLeaves16, 2e-6, 5e-5);
  set(far, kLeaves16, 2e-6, 5e-3);
  const std::string words = recommendation(tradeOf({near, next, far}));
  const std::size_t anywhere = words.find("Anywhere");
  EXPECT_THAT(words.substr(0, anywhere), HasSubstr("below 0.1 mm on this mesh: max_leaves 16"));
  EXPECT_THAT(words.substr(anywhere), HasSubstr("below 0.1 mm on this mesh: all zero (exact)"));
}

TEST(Recommendation, TrustsAProvenErrorWhereTheTipsAreTooFew) {
  BandTrade band = bandOf("0-1 mm");
  EXPECT_THAT(recommendation(tradeOf({band})), Not(HasSubstr("too few tips")));
  set(band, kGreedy, 1e-6, std::numeric_limits<double>::infinity());
  set(band, kLeaves16, 2e-6, std::numeric_limits<double>::infinity());
  set(band, kTenthOfMillimetre, 3e-6, std::numeric_limits<double>::infinity());
  EXPECT_THAT(recommendation(tradeOf({band})),
              HasSubstr("below 0.1 mm on this mesh: max_absolute_error 0.0001 m, 3.00 us"));
  EXPECT_THAT(recommendation(tradeOf({band})), HasSubstr("Anywhere (too few tips"));
}

TEST(Recommendation, IsExactWhereThatCostsHardlyMore) {
  BandTrade band = bandOf("0-1 mm");
  set(band, kLeaves16, 9.5e-6, 0.0);
  EXPECT_THAT(recommendation(tradeOf({band})), Not(HasSubstr("max_leaves")));
}

TEST(Recommendation, SpeaksOfTheUsersOwnTipsByTheLargestError) {
  Trade trade = tradeOf({bandOf("0-1 mm")});
  trade.path = pathOf("tips of path.csv");
  set(*trade.path, kGreedy, 1e-6, 5e-4);
  trade.path->summaries[kGreedy].error_p999 = 0.0;
  EXPECT_THAT(recommendation(trade),
              HasSubstr("tips of path.csv, by the largest error seen:\n"
                        "  for an error below 1 mm on these tips: max_leaves 1 (greedy), 1.00 us "
                        "(p99 1.00 us)\n"
                        "  for an error below 0.1 mm on these tips: all zero (exact)"));
}

TEST(Table, FitsATerminalWhateverTheNumbers) {
  BandTrade band = bandOf("0-1 mm");
  const Confidence sure{{1.0, 1.0}, {}, {}, 1.0};
  band.summaries[0] = {123e-6,  98765e-6, 12345.6, 1234.5,  1.0,     12.3456, 12.3456,
                       12.3456, 12.3456,  12.3456, 12.3456, 12.3456, sure};
  std::istringstream lines(table(band));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 110U) << line;
}

TEST(Table, HasAnIntervalOnlyWhereThereIsConfidence) {
  EXPECT_THAT(table(bandOf("0-1 mm")), HasSubstr("0.0-0.0"));
  EXPECT_THAT(table(pathOf("path")), Not(HasSubstr("0.0-0.0")));
}

TEST(Table, SaysThatABandIsEmpty) {
  EXPECT_THAT(table(emptyBand("inside")), HasSubstr("inside: no tips"));
}

TEST(Table, CountsTheViolations) {
  BandTrade band = bandOf("0-1 mm");
  band.samples[2].violations = 3;
  EXPECT_THAT(table(band), HasSubstr("3 violations"));
}

TEST(Table, ShowsAnErrorThatIsSmallAsNotZero) {
  BandTrade band = bandOf("0-1 mm");
  band.summaries[0].error_max = 1e-9;
  EXPECT_THAT(table(band), HasSubstr("<.0001"));
}

TEST(Csv, HasAsManyFieldsInEachRowAsInItsHeader) {
  std::istringstream lines(csv(tradeOf({bandOf("0-1 mm"), emptyBand("inside")})));
  std::string header;
  std::getline(lines, header);
  const auto commas = std::count(header.begin(), header.end(), ',');
  std::size_t rows = 0;
  for (std::string line; std::getline(lines, line); ++rows) {
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), commas) << line;
  }
  EXPECT_EQ(rows, dial().size()) << "an empty band has no rows";
  EXPECT_EQ(csv(tradeOf({emptyBand("inside")})), header + "\n");
}

TEST(Figure, EmphasisesWhatNoOtherSettingBeats) {
  BandTrade band = bandOf("0-1 mm");
  set(band, kGreedy, 1e-6, 2e-3);
  set(band, kLeaves16, 2e-6, 5e-5);
  set(band, kLeaves64, 3e-6, 6e-5);
  const Figure drawn = figure(tradeOf({band}));
  std::vector<std::string> best;
  for (const PlotSeries& series : drawn.plots.at(0).series) {
    if (!series.markers) continue;
    for (const PlotPoint& point : series.points) {
      if (point.emphasised) best.push_back(point.label);
    }
  }
  EXPECT_THAT(best, testing::ElementsAre("greedy", "16 leaves", "exact"));
}

TEST(Figure, HasAPlotForEachBandWithTips) {
  Trade trade = tradeOf({bandOf("0-1 mm"), emptyBand("inside")});
  trade.path = bandOf("path");
  EXPECT_EQ(figure(trade).plots.size(), 2U);
}

/// Every number another.
BandTrade bandOfManyNumbers() {
  BandTrade band = bandOf("0-1 mm");
  band.samples[0].violations = 2;
  band.summaries[0] = {1e-6,
                       2e-6,
                       3,
                       4,
                       0.5,
                       6e-3,
                       7e-3,
                       8e-3,
                       9e-3,
                       10e-3,
                       11e-3,
                       12e-3,
                       Confidence{{0.25, 0.75}, {13e-3, 14e-3}, {15e-3, 16e-3}, 17e-3}};
  return band;
}

TEST(Table, HasEachNumberUnderItsHeading) {
  const std::string lines = table(bandOfManyNumbers());
  EXPECT_THAT(lines, HasSubstr("setting   median    p99 bounds  tris  found  95 % conf.    mean    "
                               "p50    p99  p99.9    max    mean    p99\n"
                               "greedy      1.00   2.00    3.0   4.0  50.00   25.0-75.0  6.0000 "
                               "7.0000 8.0000 9.0000  10.00   11.00  12.00\n"));
}

TEST(Table, ShowsTheLeastErrorThatItsDigitsTell) {
  BandTrade band = bandOf("0-1 mm");
  band.summaries[0].error_max = 1e-7;
  EXPECT_THAT(table(band), HasSubstr(" 0.0001 "));
}

TEST(Csv, HasEachNumberInItsColumn) {
  Trade trade = tradeOf({bandOfManyNumbers()});
  trade.costs = {0.018, 0.019, 0.020, 21};
  EXPECT_THAT(
      csv(trade),
      HasSubstr("\n0-1 mm,greedy,0,0,1,1,1,2,3,4,0.5,0.25,0.75,6,13,14,7,8,15,16,9,17,10,11,"
                "12,2,1000,7,18,19,20,21\n"));
}

TEST(Report, TellsTheCosts) {
  Trade trade = tradeOf({bandOf("0-1 mm")});
  trade.costs = {0.018, 0.019, 0.020, 21};
  EXPECT_THAT(report(trade), HasSubstr("hierarchy: 18 ms; refitting it to moved vertices: 19 ms;\n"
                                       "rebuilding it: 20 ms; memory: 21 bytes"));
}

TEST(Recommendation, TellsThe99thPercentileOfTheTimes) {
  BandTrade band = bandOf("0-1 mm");
  band.samples[kExact].times = {1e-6, 2e-6, 3e-6};
  EXPECT_THAT(recommendation(tradeOf({band})),
              HasSubstr("exact answer: all zero (exact), 2.00 us (p99 3.00 us)"));
}

TEST(Recommendation, NearTheSurfaceIsThatOfBothNearBands) {
  BandTrade first = bandOf("0-1 mm");
  first.samples[kLeaves16].times = {1e-6};
  first.summaries[kLeaves16].confidence->error_p999_limit = 0.0;
  const std::string words = recommendation(tradeOf({first, bandOf("1-5 mm")}));
  EXPECT_EQ(words.find("max_leaves 16"), std::string::npos);
}

TEST(Recommendation, TakesNoRelativeErrorForAProvenOne) {
  BandTrade band = bandOf("0-1 mm");
  band.samples[kOnePercent].times = {1e-6};
  EXPECT_EQ(recommendation(tradeOf({band})).find("max_relative_error"), std::string::npos);
}

TEST(Figure, DrawsThe99thPercentileOfTheErrorOverTheMedianTime) {
  const PlotSeries greedy = figure(tradeOf({bandOfManyNumbers()})).plots.at(0).series.at(1);
  EXPECT_DOUBLE_EQ(greedy.points.at(0).x, 1.0);
  EXPECT_DOUBLE_EQ(greedy.points.at(0).y, 8.0);
}

}  // namespace
}  // namespace organ_collision::tools
