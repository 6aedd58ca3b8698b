#include "svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "output.h"

namespace organ_collision::tools {
namespace {

// All [px].
constexpr double kFontSize = 12.0;
constexpr double kLabelSize = 11.0;
constexpr double kTitleSize = 17.0;
constexpr double kCharacterWidth = 0.64;  // of the font's size, about what sans-serif letters take
constexpr double kMarkerRadius = 4.5;
constexpr double kMargin = 14.0;      // around the figure
constexpr double kLeft = 66.0;        // of a plot's frame: tick labels and the axis' name
constexpr double kBottom = 50.0;      // likewise
constexpr double kTop = 28.0;         // the plot's title
constexpr double kRailHeight = 26.0;  // of the rail for zeros, off the scale
constexpr const char* kInk = "#222222";
constexpr const char* kFaint = "#e4e4e4";

struct Rectangle {
  double left, top, right, bottom;
  bool overlaps(const Rectangle& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
  bool contains(const Rectangle& other) const {
    return left <= other.left && other.right <= right && top <= other.top && other.bottom <= bottom;
  }
};

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  void add(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

struct Tick {
  double value;
  bool labelled;
};

double textWidth(const std::string& text, double size) {
  return static_cast<double>(text.size()) * kCharacterWidth * size;
}

std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string pixels(double value) { return significant(std::round(value * 10.0) / 10.0, 6); }

std::string text(double x, double y, const std::string& words, const std::string& anchor,
                 double size, const std::string& more = "") {
  return "<text x=\"" + pixels(x) + "\" y=\"" + pixels(y) + "\" text-anchor=\"" + anchor +
         "\" font-size=\"" + pixels(size) + "\"" + more + ">" + escaped(words) + "</text>\n";
}

std::string segment(double x1, double y1, double x2, double y2, const std::string& colour) {
  return "<line x1=\"" + pixels(x1) + "\" y1=\"" + pixels(y1) + "\" x2=\"" + pixels(x2) +
         "\" y2=\"" + pixels(y2) + "\" stroke=\"" + colour + "\"/>\n";
}

std::string frame(const Rectangle& area) {
  return "<rect x=\"" + pixels(area.left) + "\" y=\"" + pixels(area.top) + "\" width=\"" +
         pixels(area.right - area.left) + "\" height=\"" + pixels(area.bottom - area.top) +
         "\" fill=\"none\" stroke=\"#888888\"/>\n";
}

std::string marker(double x, double y, const std::string& colour, bool emphasised) {
  const std::string fill =
      emphasised ? colour : "#ffffff\" fill-opacity=\"0.8\" stroke-opacity=\"0.55";
  return "<circle cx=\"" + pixels(x) + "\" cy=\"" + pixels(y) + "\" r=\"" +
         pixels(emphasised ? kMarkerRadius : 0.8 * kMarkerRadius) + "\" stroke=\"" + colour +
         "\" stroke-width=\"1.5\" fill=\"" + fill + "\"/>\n";
}

/// From values to pixels along one axis.
class Scale {
 public:
  /// `range`: of all values, those above 0 only where `axis` is logarithmic.
  Scale(const PlotAxis& axis, Range range, double low_pixel, double high_pixel)
      : logarithmic_(axis.logarithmic), has_rail_(axis.logarithmic && !axis.zero_rail.empty()) {
    const double up = high_pixel > low_pixel ? 1.0 : -1.0;
    rail_ = low_pixel + up * 0.5 * kRailHeight;
    low_pixel_ = has_rail_ ? low_pixel + up * (kRailHeight + 6.0) : low_pixel;
    high_pixel_ = high_pixel;
    if (range.low > range.high) range = logarithmic_ ? Range{0.1, 1.0} : Range{0.0, 1.0};
    low_ = transformed(range.low);
    high_ = transformed(range.high);
    widen();
  }

  /// Nothing for what the axis cannot show.
  std::optional<double> pixel(double value) const {
    if (!std::isfinite(value)) return std::nullopt;
    if (logarithmic_ && value <= 0.0) return has_rail_ ? std::optional(rail_) : std::nullopt;
    const double share = (transformed(value) - low_) / (high_ - low_);
    return low_pixel_ + share * (high_pixel_ - low_pixel_);
  }

  std::vector<Tick> ticks() const { return logarithmic_ ? decades() : steps(); }
  bool hasRail() const { return has_rail_; }
  double rail() const { return rail_; }
  double scaleStart() const { return low_pixel_; }  ///< [px] where the rail has ended

 private:
  double transformed(double value) const { return logarithmic_ ? std::log10(value) : value; }

  /// Room at both ends, or the step's next multiple; 0 is shown if it is near.
  void widen() {
    if (high_ == low_) {
      const double reach = logarithmic_ || low_ == 0.0 ? 0.5 : 0.5 * std::abs(low_);
      low_ -= reach;
      high_ += reach;
    }
    if (logarithmic_) {
      const double room = 0.06 * (high_ - low_);
      low_ -= room;
      high_ += room;
      return;
    }
    if (low_ > 0.0 && low_ < 0.4 * high_) low_ = 0.0;
    const double each = step();
    low_ = std::floor(low_ / each) * each;
    high_ = std::ceil(high_ / each) * each;
  }

  /// 1, 2 or 5 times a power of ten: four to eight fill the axis.
  double step() const {
    const double wanted = (high_ - low_) / 5.0;
    const double power = std::pow(10.0, std::floor(std::log10(wanted)));
    for (const double factor : {1.0, 2.0, 5.0}) {
      if (wanted <= factor * power) return factor * power;
    }
    return 10.0 * power;
  }

  std::vector<Tick> steps() const {
    std::vector<Tick> ticks;
    const double each = step();
    const auto first = static_cast<long>(std::ceil(low_ / each - 1e-9));
    const auto last = static_cast<long>(std::floor(high_ / each + 1e-9));
    for (long i = first; i <= last; ++i) ticks.push_back({static_cast<double>(i) * each, true});
    return ticks;
  }

  /// 1 to 9 times every power of ten; where there are few powers, 2 and 5 are labelled too.
  std::vector<Tick> decades() const {
    std::vector<Tick> ticks;
    const bool few = high_ - low_ < 2.4;
    const auto stride = std::max(1L, std::lround((high_ - low_) / 7.0));
    for (auto power = static_cast<long>(std::floor(low_)); static_cast<double>(power) <= high_;
         ++power) {
      for (int digit = 1; digit <= 9; ++digit) {
        const double value = std::stod(std::to_string(digit) + "e" + std::to_string(power));
        const double place = std::log10(value);
        const bool labelled = digit == 1 ? power % stride == 0 : few && (digit == 2 || digit == 5);
        if (place >= low_ && place <= high_) ticks.push_back({value, labelled});
      }
    }
    return ticks;
  }

  bool logarithmic_;
  bool has_rail_;
  double rail_;
  double low_pixel_, high_pixel_;
  double low_, high_;  // transformed
};

/// Puts words beside points where nothing else is.
class Labels {
 public:
  explicit Labels(const Rectangle& area) : area_(area) {}

  void keepClear(double x, double y) {
    const double reach = kMarkerRadius + 1.0;
    taken_.push_back({x - reach, y - reach, x + reach, y + reach});
  }

  /// Draws `words` at the nearest free place round (x, y), with a thin line if that is not beside
  /// it.
  std::string place(double x, double y, const std::string& words, const std::string& colour) {
    const double width = textWidth(words, kLabelSize);
    for (const double reach : {8.0, 16.0, 26.0, 38.0, 52.0, 68.0}) {
      for (const auto& [right, down] : kDirections) {
        const double centre_x = x + right * (reach + 0.5 * width);
        const double centre_y = y + down * (reach + 0.3 * kLabelSize);
        const Rectangle box = {centre_x - 0.5 * width, centre_y - 0.55 * kLabelSize,
                               centre_x + 0.5 * width, centre_y + 0.55 * kLabelSize};
        if (!area_.contains(box) || isTaken(box)) continue;
        taken_.push_back(box);
        const std::string lead = reach > 8.0 ? leader(x, y, box) : "";
        const std::string anchor = right > 0 ? "start" : right < 0 ? "end" : "middle";
        const double anchor_x = right > 0 ? box.left : right < 0 ? box.right : centre_x;
        const std::string style = std::string(" fill=\"").append(colour).append("\"").append(kHalo);
        return lead +
               text(anchor_x, centre_y + 0.35 * kLabelSize, words, anchor, kLabelSize, style);
      }
    }
    return "";  // no room; the table has it
  }

 private:
  static constexpr std::array<std::pair<double, double>, 8> kDirections = {
      {{1, 0}, {1, -1}, {0, -1}, {1, 1}, {0, 1}, {-1, -1}, {-1, 1}, {-1, 0}}};
  static constexpr const char* kHalo =
      " stroke=\"#ffffff\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\"";

  bool isTaken(const Rectangle& box) const {
    return std::any_of(taken_.begin(), taken_.end(),
                       [&](const Rectangle& other) { return box.overlaps(other); });
  }

  static std::string leader(double x, double y, const Rectangle& box) {
    return segment(x, y, std::clamp(x, box.left, box.right), std::clamp(y, box.top, box.bottom),
                   "#aaaaaa");
  }

  Rectangle area_;
  std::vector<Rectangle> taken_;
};

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
    const std::string x = pixels(area_.left - 50.0);
    const std::string y = pixels(0.5 * (area_.top + area_.bottom));
    return drawing + text(area_.left - 50.0, 0.5 * (area_.top + area_.bottom), plot_.y.label,
                          "middle", kFontSize, " transform=\"rotate(-90 " + x + " " + y + ")\"");
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
