#pragma once

#include <string>

// Elements of an SVG document, as text. All lengths are in [px].
namespace organ_collision::tools {

constexpr double kLabelSize = 11.0;  // of the font of labels and ticks
constexpr double kMarkerRadius = 4.5;

struct Rectangle {
  double left, top, right, bottom;
  bool overlaps(const Rectangle& other) const {
    return left < other.right && other.left < right && top < other.bottom && other.top < bottom;
  }
  bool contains(const Rectangle& other) const {
    return left <= other.left && other.right <= right && top <= other.top && other.bottom <= bottom;
  }
};

/// `value` as an attribute.
std::string pixels(double value);

/// How wide `text` is in a font of this size, about.
double textWidth(const std::string& text, double size);

/// `anchor`: "start", "middle" or "end"; `more`: further attributes.
std::string text(double x, double y, const std::string& words, const std::string& anchor,
                 double size, const std::string& more = "");

std::string segment(double x1, double y1, double x2, double y2, const std::string& colour);

std::string frame(const Rectangle& area);

std::string marker(double x, double y, const std::string& colour, bool emphasised);

}  // namespace organ_collision::tools
