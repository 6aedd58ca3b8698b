#include "text_lines.h"

#include <algorithm>
#include <charconv>
#include <system_error>

#include "shown.h"

namespace organ_collision::io {
namespace {

constexpr std::string_view kBlanks = " \t\r\v\f";

template <typename Number>
bool parse(std::string_view text, Number& number) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, number);  // whatever the locale
  return error == std::errc() && stop == end;
}

void split(std::string_view line, std::vector<std::string_view>& words) {
  words.clear();
  for (;;) {
    const std::size_t begin = line.find_first_not_of(kBlanks);
    if (begin == std::string_view::npos || line[begin] == '#') return;
    line.remove_prefix(begin);
    words.push_back(line.substr(0, line.find_first_of(kBlanks)));
    line.remove_prefix(words.back().size());
  }
}

}  // namespace

TextLines::TextLines(std::string_view text) : rest_(text) {
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (rest_.substr(0, kByteOrderMark.size()) == kByteOrderMark)
    rest_.remove_prefix(kByteOrderMark.size());
}

bool TextLines::next() {
  while (!rest_.empty()) {
    const std::size_t end = std::min(rest_.find_first_of("\r\n"), rest_.size());
    split(rest_.substr(0, end), words_);
    rest_.remove_prefix(end);
    rest_.remove_prefix(rest_.substr(0, 2) == "\r\n" ? 2 : rest_.empty() ? 0 : 1);
    ++number_;
    if (!words_.empty()) return true;
  }
  words_.clear();
  return false;
}

void TextLines::require(const char* wanted) {
  if (!next()) refuse(std::string("the file ends here, but ") + wanted + " is wanted");
}

double TextLines::real(std::size_t i) const {
  double number = 0.0;
  if (!parse(word(i), number)) refuse(quoted(word(i)) + " is not a number that a double can hold");
  return number;
}

std::int64_t TextLines::integer(std::size_t i, char end) const {
  std::int64_t number = 0;
  if (!parse(word(i).substr(0, word(i).find(end)), number))
    refuse(quoted(word(i)) + " is not an integer that 64 bits can hold");
  return number;
}

void TextLines::refuse(const std::string& why) const {
  throw std::invalid_argument("line " + std::to_string(number_) + ": " + why);
}

void TextLines::refuse(const std::string& why, std::size_t i) const {
  refuse(why + (i < words_.size() ? ", not " + quoted(words_[i]) : ""));
}

std::string_view TextLines::word(std::size_t i) const {
  if (i < words_.size()) return words_[i];
  refuse("it has " + std::to_string(words_.size()) + " words, but " + std::to_string(i + 1) +
         " or more are wanted");
}

}  // namespace organ_collision::io
