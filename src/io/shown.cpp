#include "shown.h"

#include <array>
#include <charconv>
#include <cstddef>

namespace organ_collision::io {

std::string quoted(std::string_view word) {
  constexpr std::size_t kLongest = 40;
  std::string text(word.substr(0, kLongest));
  for (char& letter : text) {
    if (letter < ' ' || letter > '~') letter = '?';
  }
  return "'" + text + (word.size() > kLongest ? "...'" : "'");
}

std::string shown(double number) {
  std::array<char, 32> text{};
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), number);
  return {text.data(), end};
}

}  // namespace organ_collision::io
