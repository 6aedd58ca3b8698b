#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "svg_plot.h"

namespace organ_collision::tools {

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

/// From values to pixels along one axis.
class Scale {
 public:
  /// `range`: of all values, those above 0 only where `axis` is logarithmic.
  Scale(const PlotAxis& axis, Range range, double low_pixel, double high_pixel);

  /// Nothing for what the axis cannot show.
  std::optional<double> pixel(double value) const;

  std::vector<Tick> ticks() const { return logarithmic_ ? decades() : steps(); }
  bool hasRail() const { return has_rail_; }
  double rail() const { return rail_; }
  double scaleStart() const { return low_pixel_; }  ///< [px] where the rail has ended

 private:
  double transformed(double value) const { return logarithmic_ ? std::log10(value) : value; }

  /// Room at both ends, or the step's next multiple; 0 is shown if it is near.
  void widen();

  /// 1, 2 or 5 times a power of ten: four to eight fill the axis.
  double step() const;
  std::vector<Tick> steps() const;

  /// 1 to 9 times every power of ten; where there are few powers, 2 and 5 are labelled too.
  std::vector<Tick> decades() const;

  bool logarithmic_;
  bool has_rail_;
  double rail_;
  double low_pixel_, high_pixel_;
  double low_, high_;  // transformed
};

}  // namespace organ_collision::tools
