#include "plot_labels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace organ_collision::tools {
namespace {

constexpr std::array<std::pair<double, double>, 8> kDirections = {
    {{1, 0}, {1, -1}, {0, -1}, {1, 1}, {0, 1}, {-1, -1}, {-1, 1}, {-1, 0}}};
constexpr double kBeside = 8.0;  // [px] from a point: needs no leader
constexpr const char* kHalo =
    " stroke=\"#ffffff\" stroke-width=\"3\" stroke-linejoin=\"round\" paint-order=\"stroke\"";

struct Leader {
  double from_x, from_y, to_x, to_y;

  std::string svg() const { return segment(from_x, from_y, to_x, to_y, "#aaaaaa"); }

  /// As squares, one after the other, clear of the marker, from which others may start, and of the
  /// end, which touches the words.
  std::vector<Rectangle> pieces() const {
    constexpr double kSize = 2.0;  // [px]
    const double length = std::hypot(to_x - from_x, to_y - from_y);
    std::vector<Rectangle> squares;
    for (double along = kMarkerRadius; along < length - kSize; along += kSize) {
      const double x = from_x + along / length * (to_x - from_x);
      const double y = from_y + along / length * (to_y - from_y);
      squares.push_back({x - 0.5 * kSize, y - 0.5 * kSize, x + 0.5 * kSize, y + 0.5 * kSize});
    }
    return squares;
  }
};

Leader leaderTo(const Rectangle& box, double x, double y) {
  return {x, y, std::clamp(x, box.left, box.right), std::clamp(y, box.top, box.bottom)};
}

bool overlapAny(const std::vector<Rectangle>& some, const std::vector<Rectangle>& others) {
  return std::any_of(some.begin(), some.end(), [&](const Rectangle& one) {
    return std::any_of(others.begin(), others.end(),
                       [&](const Rectangle& other) { return one.overlaps(other); });
  });
}

}  // namespace

void Labels::keepClear(double x, double y) {
  const double reach = kMarkerRadius + 1.0;
  markers_.push_back({x - reach, y - reach, x + reach, y + reach});
}

std::string Labels::place(double x, double y, const std::string& words, const std::string& colour) {
  const double width = textWidth(words, kLabelSize);
  for (const double reach : {kBeside, 16.0, 26.0, 38.0, 52.0, 68.0}) {
    for (const auto& [right, down] : kDirections) {
      const double centre_x = x + right * (reach + 0.5 * width);
      const double centre_y = y + down * (reach + 0.3 * kLabelSize);
      const Rectangle box = {centre_x - 0.5 * width, centre_y - 0.55 * kLabelSize,
                             centre_x + 0.5 * width, centre_y + 0.55 * kLabelSize};
      const Leader leader = leaderTo(box, x, y);
      const auto pieces = reach > kBeside ? leader.pieces() : std::vector<Rectangle>{};
      if (!area_.contains(box) || overlapAny({box}, markers_) || overlapAny({box}, drawn_) ||
          overlapAny(pieces, drawn_))
        continue;
      drawn_.push_back(box);
      drawn_.insert(drawn_.end(), pieces.begin(), pieces.end());
      const std::string anchor = right > 0 ? "start" : right < 0 ? "end" : "middle";
      const double anchor_x = right > 0 ? box.left : right < 0 ? box.right : centre_x;
      const std::string style = std::string(" fill=\"").append(colour).append("\"").append(kHalo);
      return (pieces.empty() ? "" : leader.svg()) +
             text(anchor_x, centre_y + 0.35 * kLabelSize, words, anchor, kLabelSize, style);
    }
  }
  return "";  // no room; the table has it
}

}  // namespace organ_collision::tools
