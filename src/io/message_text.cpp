#include "organ_collision/io/message_text.h"

#include <algorithm>
#include <cstddef>

namespace organ_collision::io {

std::string printable(std::string_view text) {
  constexpr std::size_t kLongest = 1000;  // [bytes]
  constexpr char kDelete = '\x7f';
  std::string shown(text.substr(0, kLongest));
  std::replace_if(
      shown.begin(), shown.end(), [](char c) { return c == '\n' || c == '\r' || c == '\t'; }, ' ');
  const auto is_control = [](char c) { return (c >= '\0' && c < ' ') || c == kDelete; };
  std::replace_if(shown.begin(), shown.end(), is_control, '?');
  const std::size_t rest = text.size() - shown.size();
  return rest == 0 ? shown : shown + "... (" + std::to_string(rest) + " more bytes)";
}

std::string joined(const std::vector<std::string_view>& names) {
  std::string text;
  for (const std::string_view name : names) text.append(text.empty() ? "" : ", ").append(name);
  return text;
}

}  // namespace organ_collision::io
