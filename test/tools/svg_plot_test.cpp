#include "tools/svg_plot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <regex>

namespace organ_collision::tools {
namespace {

using testing::HasSubstr;
using testing::Not;

struct Circle {
  double x, y;
};

/// The markers of `colour`, in the order in which they are drawn.
std::vector<Circle> circles(const std::string& document, const std::string& colour) {
  const std::regex circle("<circle cx=\"([0-9.e-]+)\" cy=\"([0-9.e-]+)\" r=\"[0-9.]+\" stroke=\"" +
                          colour + "\"");
  std::vector<Circle> found;
  for (std::sregex_iterator i(document.begin(), document.end(), circle), end; i != end; ++i) {
    found.push_back({std::stod((*i)[1]), std::stod((*i)[2])});
  }
  return found;
}

std::size_t occurrences(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

/// A figure of one plot; the series has no name, so no marker in the legend.
Figure figureOf(const PlotAxis& x, const PlotAxis& y, const std::vector<PlotPoint>& points) {
  return {"title", "note", {{"plot", x, y, {{"", "#123456", points}}}}};
}

constexpr double kPixel = 0.11;  // coordinates are written to a tenth of a pixel

TEST(Svg, PutsLinearValuesInProportion) {
  const auto drawn = circles(svg(figureOf({"x"}, {"y"}, {{1, 1}, {2, 3}, {4, 7}})), "#123456");
  ASSERT_EQ(drawn.size(), 3U);
  EXPECT_NEAR(drawn[2].x - drawn[1].x, 2.0 * (drawn[1].x - drawn[0].x), 2.0 * kPixel);
  EXPECT_NEAR(drawn[1].y - drawn[2].y, 2.0 * (drawn[0].y - drawn[1].y), 2.0 * kPixel);
  EXPECT_LT(drawn[0].x, drawn[1].x);
  EXPECT_GT(drawn[0].y, drawn[1].y) << "up is less in SVG";
}

TEST(Svg, PutsEqualRatiosAtEqualDistancesOnALogarithmicAxis) {
  const auto drawn =
      circles(svg(figureOf({"x", true}, {"y", true}, {{0.1, 5}, {1, 50}, {10, 500}})), "#123456");
  ASSERT_EQ(drawn.size(), 3U);
  EXPECT_NEAR(drawn[1].x - drawn[0].x, drawn[2].x - drawn[1].x, kPixel);
  EXPECT_NEAR(drawn[0].y - drawn[1].y, drawn[1].y - drawn[2].y, kPixel);
}

TEST(Svg, PutsZeroOnItsRailBelowEveryOtherValue) {
  const std::string document =
      svg(figureOf({"x", true}, {"y", true, "no error"}, {{1, 1e-6}, {2, 0}, {3, 1}}));
  const auto drawn = circles(document, "#123456");
  ASSERT_EQ(drawn.size(), 3U);
  EXPECT_GT(drawn[1].y, drawn[0].y + 10.0);
  EXPECT_THAT(document, HasSubstr(">no error<"));
}

TEST(Svg, LeavesOutWhatAnAxisCannotShow) {
  const double nan = std::nan("");
  const double infinity = std::numeric_limits<double>::infinity();
  const std::string document =
      svg(figureOf({"x", true}, {"y", true}, {{1, 1}, {0, 1}, {1, -1}, {nan, 1}, {1, infinity}}));
  EXPECT_EQ(circles(document, "#123456").size(), 1U);
  EXPECT_THAT(document, Not(HasSubstr("nan")));
  EXPECT_THAT(document, Not(HasSubstr("inf")));
}

TEST(Svg, DrawsEmptyAndConstantPlotsToo) {
  for (const bool logarithmic : {false, true}) {
    EXPECT_EQ(circles(svg(figureOf({"x", logarithmic}, {"y", logarithmic}, {})), "#123456").size(),
              0U);
    const std::string constant =
        svg(figureOf({"x", logarithmic}, {"y", logarithmic}, {{2, 3}, {2, 3}}));
    EXPECT_EQ(circles(constant, "#123456").size(), 2U);
    EXPECT_THAT(constant, Not(HasSubstr("nan")));
  }
  EXPECT_THAT(svg({"nothing", "", {}}), HasSubstr("</svg>"));
}

TEST(Svg, EscapesWords) {
  EXPECT_THAT(svg({"a < b & \"c\"", "", {}}), HasSubstr("a &lt; b &amp; &quot;c&quot;"));
}

TEST(Svg, NamesEverySeriesOnceInTheLegend) {
  const Plot plot{"plot", {"x"}, {"y"}, {{"leaves", "#123456", {{1, 1}}}}};
  EXPECT_EQ(occurrences(svg({"title", "", {plot, plot}, 2}), ">leaves<"), 1U);
}

TEST(Svg, GivesAllPlotsOneScaleWhereAskedTo) {
  const Plot small{"small", {"x"}, {"y"}, {{"", "#111111", {{1, 1}, {2, 2}}}}};
  const Plot large{"large", {"x"}, {"y"}, {{"", "#222222", {{1, 1}, {20, 20}}}}};
  Figure figure{"title", "", {small, large}, 2};
  const auto height = [&](const char* colour) { return circles(svg(figure), colour)[0].y; };
  EXPECT_NE(height("#111111"), height("#222222"));
  figure.common_axes = true;
  EXPECT_EQ(height("#111111"), height("#222222"));
}

TEST(Svg, PlacesLabelsOfNeighboursApart) {
  const std::string document =
      svg(figureOf({"x"}, {"y"}, {{0, 0}, {5, 5, "first"}, {5.05, 5, "second"}, {10, 10}}));
  const auto place = [&](const std::string& label) {
    std::smatch match;
    const std::regex text("<text x=\"([0-9.]+)\" y=\"([0-9.]+)\"[^>]*>" + label + "<");
    EXPECT_TRUE(std::regex_search(document, match, text)) << label;
    return Circle{std::stod(match[1]), std::stod(match[2])};
  };
  constexpr double kLetterHeight = 11.0;  // [px]
  EXPECT_TRUE(std::abs(place("first").y - place("second").y) >= kLetterHeight ||
              std::abs(place("first").x - place("second").x) >= 5.0 * kLetterHeight);
}

struct Line {
  double x1, y1, x2, y2;
  /// On which side of it a point is: > 0, < 0.
  double sideOf(double x, double y) const { return (x2 - x1) * (y - y1) - (y2 - y1) * (x - x1); }
  bool separates(const Line& other) const {
    return sideOf(other.x1, other.y1) * sideOf(other.x2, other.y2) < 0.0;
  }
  /// Without what its point's marker hides.
  Line shown() const {
    const double hidden = 6.0 / std::hypot(x2 - x1, y2 - y1);
    return {x1 + hidden * (x2 - x1), y1 + hidden * (y2 - y1), x2, y2};
  }
};

TEST(Svg, LeadsToLabelsByLinesThatDoNotCross) {
  const std::regex leader(
      "<line x1=\"([0-9.]+)\" y1=\"([0-9.]+)\" x2=\"([0-9.]+)\" y2=\"([0-9.]+)\" "
      "stroke=\"#aaaaaa\"");
  std::mt19937 generator(1);
  std::uniform_real_distribution<double> place(4.5, 5.5);
  std::size_t count = 0;
  for (int i = 0; i < 100; ++i) {
    std::vector<PlotPoint> crowd = {{0, 0}, {10, 10}};
    for (int k = 0; k < 8; ++k) crowd.push_back({place(generator), place(generator), "number"});
    const std::string document = svg(figureOf({"x"}, {"y"}, crowd));
    std::vector<Line> lines;
    for (std::sregex_iterator k(document.begin(), document.end(), leader), end; k != end; ++k)
      lines.push_back(
          Line{std::stod((*k)[1]), std::stod((*k)[2]), std::stod((*k)[3]), std::stod((*k)[4])}
              .shown());
    count += lines.size();
    for (const Line& one : lines) {
      for (const Line& other : lines) ASSERT_FALSE(one.separates(other) && other.separates(one));
    }
  }
  EXPECT_GT(count, 100U);
}

}  // namespace
}  // namespace organ_collision::tools
