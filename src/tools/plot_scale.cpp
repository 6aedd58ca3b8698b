#include "plot_scale.h"

#include <string>

namespace organ_collision::tools {
namespace {

constexpr double kRailHeight = 26.0;  // [px] of the rail for zeros, off the scale

}  // namespace

Scale::Scale(const PlotAxis& axis, Range range, double low_pixel, double high_pixel)
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

std::optional<double> Scale::pixel(double value) const {
  if (!std::isfinite(value)) return std::nullopt;
  if (logarithmic_ && value <= 0.0) return has_rail_ ? std::optional(rail_) : std::nullopt;
  const double share = (transformed(value) - low_) / (high_ - low_);
  return low_pixel_ + share * (high_pixel_ - low_pixel_);
}

void Scale::widen() {
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

double Scale::step() const {
  const double wanted = (high_ - low_) / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(wanted)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (wanted <= factor * power) return factor * power;
  }
  return 10.0 * power;
}

std::vector<Tick> Scale::steps() const {
  std::vector<Tick> ticks;
  const double each = step();
  const auto first = static_cast<long>(std::ceil(low_ / each - 1e-9));
  const auto last = static_cast<long>(std::floor(high_ / each + 1e-9));
  for (long i = first; i <= last; ++i) ticks.push_back({static_cast<double>(i) * each, true});
  return ticks;
}

std::vector<Tick> Scale::decades() const {
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

}  // namespace organ_collision::tools
