#include "svg_plot.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "output.h"
#include "plot_labels.h"
#include "plot_scale.h"
#include "svg_elements.h"

namespace organ_collision::tools {
namespace {

// All [px].
constexpr double kFontSize = 12.0;
constexpr double kTitleSize = 17.0;
constexpr double kMargin = 14.0;    // around the figure
constexpr double kLeft = 82.0;      // of a plot's frame: tick labels and the axis' name
constexpr double kAxisName = 66.0;  // where that starts, left of the frame
constexpr double kBottom = 50.0;    // likewise
constexpr double kTop = 28.0;       // the plot's title
constexpr const char* kInk = "#222222";
constexpr const char* kFaint = "#e4e4e4";

void extend(Range& range, const PlotAxis& axis, double value) {
  if (std::isfinite(value) && (value > 0.0 || !axis.logarithmic)) range.add(value);
}

struct Ranges {
  Range x, y;
  void add(const Plot& plot) {
    for (const PlotSeries& series : plot.series) {
      for (const PlotPoint& point : series.points) {
        extend(x, plot.x, point.x);
        extend(y, plot.y, point.y);
      }
    }
  }
};

/// One plot, its frame at `area`.
class PlotDrawing {
 public:
  PlotDrawing(const Plot& plot, const Ranges& ranges, const Rectangle& area)
      : plot_(plot),
        area_(area),
        x_(plot.x, ranges.x, area.left, area.right),
        y_(plot.y, ranges.y, area.bottom, area.top) {}

  std::string svg() const {
    std::string drawing = text(area_.left, area_.top - 9.0, plot_.title, "start", kFontSize + 1.0,
                               " font-weight=\"bold\"");
    drawing += xAxis() + yAxis() + frame(area_);
    for (const PlotSeries& series : plot_.series) {
      if (series.line) drawing += line(series);
    }
    return drawing + markers() + labels();
  }

 private:
  std::string xAxis() const {
    std::string drawing;
    for (const Tick& tick : x_.ticks()) {
      const double x = *x_.pixel(tick.value);
      drawing += segment(x, area_.bottom, x, area_.bottom + (tick.labelled ? 5.0 : 2.5), kInk);
      if (!tick.labelled) continue;
      drawing += segment(x, area_.top, x, area_.bottom, kFaint);
      drawing += text(x, area_.bottom + 17.0, significant(tick.value, 10), "middle", kLabelSize);
    }
    if (x_.hasRail()) {
      drawing += segment(x_.scaleStart(), area_.top, x_.scaleStart(), area_.bottom, "#888888");
      drawing += text(x_.rail(), area_.bottom + 17.0, plot_.x.zero_rail, "middle", kLabelSize);
    }
    return drawing + text(0.5 * (area_.left + area_.right), area_.bottom + 36.0, plot_.x.label,
                          "middle", kFontSize);
  }

  std::string yAxis() const {
    std::string drawing;
    for (const Tick& tick : y_.ticks()) {
      const double y = *y_.pixel(tick.value);
      drawing += segment(area_.left - (tick.labelled ? 5.0 : 2.5), y, area_.left, y, kInk);
      if (!tick.labelled) continue;
      drawing += segment(area_.left, y, area_.right, y, kFaint);
      drawing += text(area_.left - 7.0, y + 4.0, significant(tick.value, 10), "end", kLabelSize);
    }
    if (y_.hasRail()) {
      drawing += segment(area_.left, y_.scaleStart(), area_.right, y_.scaleStart(), "#888888");
      drawing += text(area_.left - 7.0, y_.rail() + 4.0, plot_.y.zero_rail, "end", kLabelSize);
    }
    const double x = area_.left - kAxisName;
    const double y = 0.5 * (area_.top + area_.bottom);
    return drawing + text(x, y, plot_.y.label, "middle", kFontSize,
                          " transform=\"rotate(-90 " + pixels(x) + " " + pixels(y) + ")\"");
  }

  struct Place {
    double x, y;
  };

  std::optional<Place> place(const PlotPoint& point) const {
    const auto x = x_.pixel(point.x);
    const auto y = y_.pixel(point.y);
    if (!x || !y) return std::nullopt;
    return Place{*x, *y};
  }

  std::string line(const PlotSeries& series) const {
    std::string points;
    for (const PlotPoint& point : series.points) {
      if (const auto at = place(point)) points += pixels(at->x) + "," + pixels(at->y) + " ";
    }
    return "<polyline points=\"" + points + "\" fill=\"none\" stroke-width=\"1.8\" stroke=\"" +
           series.colour + "\"" + (series.dashed ? " stroke-dasharray=\"5 4\"" : "") + "/>\n";
  }

  /// The emphasised ones on top.
  std::string markers() const {
    std::string drawing;
    for (const bool emphasised : {false, true}) {
      for (const PlotSeries& series : plot_.series) {
        if (!series.markers) continue;
        for (const PlotPoint& point : series.points) {
          const auto at = place(point);
          if (at && point.emphasised == emphasised) {
            drawing += marker(at->x, at->y, series.colour, emphasised);
          }
        }
      }
    }
    return drawing;
  }

  std::string labels() const {
    Labels places(area_);
    for (const PlotSeries& series : plot_.series) {
      if (!series.markers) continue;
      for (const PlotPoint& point : series.points) {
        if (const auto at = place(point)) places.keepClear(at->x, at->y);
      }
    }
    std::string drawing;
    for (const PlotSeries& series : plot_.series) {
      for (const PlotPoint& point : series.points) {
        const auto at = place(point);
        if (at && !point.label.empty()) {
          drawing += places.place(at->x, at->y, point.label, series.colour);
        }
      }
    }
    return drawing;
  }

  const Plot& plot_;
  Rectangle area_;
  Scale x_, y_;
};

std::string legendMark(const PlotSeries& series, double x, double y) {
  std::string mark;
  if (series.line) {
    mark += "<line x1=\"" + pixels(x - 9.0) + "\" y1=\"" + pixels(y) + "\" x2=\"" +
            pixels(x + 9.0) + "\" y2=\"" + pixels(y) + "\" stroke-width=\"1.8\" stroke=\"" +
            series.colour + "\"" + (series.dashed ? " stroke-dasharray=\"5 4\"" : "") + "/>\n";
  }
  if (series.markers) mark += marker(x, y, series.colour, true);
  return mark;
}

/// One entry for each name, in a row.
std::string legend(const Figure& figure, double x, double y) {
  std::string drawing;
  std::vector<std::string> shown;
  for (const Plot& plot : figure.plots) {
    for (const PlotSeries& series : plot.series) {
      if (series.name.empty() ||
          std::find(shown.begin(), shown.end(), series.name) != shown.end()) {
        continue;
      }
      shown.push_back(series.name);
      drawing += legendMark(series, x + 9.0, y - 4.0);
      drawing += text(x + 24.0, y, series.name, "start", kFontSize);
      x += 24.0 + textWidth(series.name, kFontSize) + 22.0;
    }
  }
  return drawing;
}

}  // namespace

std::string svg(const Figure& figure) {
  const std::size_t columns = std::max<std::size_t>(1, figure.columns);
  const std::size_t rows = (figure.plots.size() + columns - 1) / columns;
  const double note_height = figure.note.empty() ? 0.0 : 20.0;
  const double header = kMargin + kTitleSize + 8.0 + note_height + 28.0;
  const double width = 2.0 * kMargin + static_cast<double>(columns) * figure.plot_width;
  const double height = header + static_cast<double>(rows) * figure.plot_height + kMargin;

  std::string document = "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"" + pixels(width) +
                         "\" height=\"" + pixels(height) + "\" viewBox=\"0 0 " + pixels(width) +
                         " " + pixels(height) +
                         "\" font-family=\"DejaVu Sans, Helvetica, Arial, sans-serif\" fill=\"" +
                         kInk + "\">\n<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n";
  document += text(kMargin, kMargin + kTitleSize, figure.title, "start", kTitleSize,
                   " font-weight=\"bold\"");
  if (!figure.note.empty()) {
    document += text(kMargin, kMargin + kTitleSize + 20.0, figure.note, "start", kFontSize);
  }
  document += legend(figure, kMargin, header - 14.0);

  Ranges common;
  for (const Plot& plot : figure.plots) common.add(plot);
  for (std::size_t i = 0; i < figure.plots.size(); ++i) {
    const Plot& plot = figure.plots[i];
    Ranges own;
    own.add(plot);
    const std::size_t row = i / columns;
    const double left = kMargin + static_cast<double>(i % columns) * figure.plot_width;
    const double top = header + static_cast<double>(row) * figure.plot_height;
    const Rectangle area = {left + kLeft, top + kTop, left + figure.plot_width - 10.0,
                            top + figure.plot_height - kBottom};
    document += PlotDrawing(plot, figure.common_axes ? common : own, area).svg();
  }
  return document + "</svg>\n";
}

}  // namespace organ_collision::tools
