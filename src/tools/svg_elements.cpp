#include "svg_elements.h"

#include <cmath>

#include "output.h"

namespace organ_collision::tools {
namespace {

constexpr double kCharacterWidth = 0.64;  // of the font's size, about what sans-serif letters take

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

}  // namespace

std::string pixels(double value) { return significant(std::round(value * 10.0) / 10.0, 6); }

double textWidth(const std::string& text, double size) {
  return static_cast<double>(text.size()) * kCharacterWidth * size;
}

std::string text(double x, double y, const std::string& words, const std::string& anchor,
                 double size, const std::string& more) {
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

}  // namespace organ_collision::tools
