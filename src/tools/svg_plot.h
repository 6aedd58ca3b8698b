#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace organ_collision::tools {

struct PlotAxis {
  std::string label;  ///< with the unit
  bool logarithmic = false;
  /// Of a logarithmic axis: values of 0 or less are drawn on a rail of this name, apart from the
  /// scale. Without a name they are left out.
  std::string zero_rail = {};
};

struct PlotPoint {
  double x, y;
  std::string label = {};  ///< beside the point; empty: none
  bool emphasised = true;  ///< filled; else a pale ring
};

/// Points of one colour; series of the same name share one entry of the legend.
struct PlotSeries {
  std::string name;
  std::string colour;  ///< as in CSS: "#0072B2"
  std::vector<PlotPoint> points;
  bool line = false;    ///< joins the points, in their order
  bool markers = true;  ///< draws the points
  bool dashed = false;
};

struct Plot {
  std::string title;
  PlotAxis x, y;
  std::vector<PlotSeries> series;
};

/// One picture of one or more plots, side by side and in rows, under one title and one legend.
struct Figure {
  std::string title;
  std::string note = {};  ///< a line below the title
  std::vector<Plot> plots;
  std::size_t columns = 1;
  double plot_width = 440.0;   ///< [px]
  double plot_height = 320.0;  ///< [px]
  bool common_axes = false;    ///< all plots have the same scales, logarithmic in all or in none
};

/// Colours that people who are colour-blind can tell apart.
/// Source: M. Okabe and K. Ito, "Color universal design" (2008).
namespace colours {
constexpr const char* kBlack = "#000000";
constexpr const char* kOrange = "#E69F00";
constexpr const char* kSkyBlue = "#56B4E9";
constexpr const char* kGreen = "#009E73";
constexpr const char* kBlue = "#0072B2";
constexpr const char* kVermilion = "#D55E00";
constexpr const char* kPurple = "#CC79A7";
}  // namespace colours

/// `figure` as an SVG document on white. Points that are not finite are left out.
std::string svg(const Figure& figure);

}  // namespace organ_collision::tools
