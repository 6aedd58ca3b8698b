#pragma once

#include <string>
#include <vector>

#include "svg_elements.h"

namespace organ_collision::tools {

/// Puts words beside points where nothing else is.
class Labels {
 public:
  explicit Labels(const Rectangle& area) : area_(area) {}

  /// No words over a marker.
  void keepClear(double x, double y);

  /// Draws `words` at the nearest free place round (x, y), with a thin line if that is not beside
  /// it. Such lines cross neither words nor each other.
  std::string place(double x, double y, const std::string& words, const std::string& colour);

 private:
  Rectangle area_;
  std::vector<Rectangle> markers_;
  std::vector<Rectangle> drawn_;  // words, and lines in short pieces
};

}  // namespace organ_collision::tools
