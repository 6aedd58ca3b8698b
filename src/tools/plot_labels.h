#pragma once

#include <string>
#include <vector>

#include "svg_elements.h"

namespace organ_collision::tools {

/// Puts words beside points where nothing else is.
class Labels {
 public:
  explicit Labels(const Rectangle& area) : area_(area) {}

  void keepClear(double x, double y);

  /// Draws `words` at the nearest free place round (x, y), with a thin line if that is not beside
  /// it.
  std::string place(double x, double y, const std::string& words, const std::string& colour);

 private:
  bool isTaken(const Rectangle& box) const;

  Rectangle area_;
  std::vector<Rectangle> taken_;
};

}  // namespace organ_collision::tools
