#include "plot_labels.h"

#include <algorithm>
#include <array>
#include <utility>

namespace organ_collision::tools {
namespace {

constexpr std::array<std::pair<double, double>, 8> kDirections = {
    {{1, 0}, {1, -1}, {0, -1}, {1, 1}, {0, 1}, {-1, -1}, {-1, 1}, {-1, 0}}};
constexpr const char* kHalo =
    " stroke=\"#ffffff\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\"";

std::string leader(double x, double y, const Rectangle& box) {
  return segment(x, y, std::clamp(x, box.left, box.right), std::clamp(y, box.top, box.bottom),
                 "#aaaaaa");
}

}  // namespace

void Labels::keepClear(double x, double y) {
  const double reach = kMarkerRadius + 1.0;
  taken_.push_back({x - reach, y - reach, x + reach, y + reach});
}

std::string Labels::place(double x, double y, const std::string& words, const std::string& colour) {
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
      return lead + text(anchor_x, centre_y + 0.35 * kLabelSize, words, anchor, kLabelSize, style);
    }
  }
  return "";  // no room; the table has it
}

bool Labels::isTaken(const Rectangle& box) const {
  return std::any_of(taken_.begin(), taken_.end(),
                     [&](const Rectangle& other) { return box.overlaps(other); });
}

}  // namespace organ_collision::tools
