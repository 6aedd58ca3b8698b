#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace organ_collision::io {

/// Walks over the lines of a text that have words; they end as on whatever system. A word beginning
/// with # starts a comment. A byte order mark before the first is passed over. The text must
/// outlive it. Its errors are std::invalid_argument with the line's number.
class TextLines {
 public:
  explicit TextLines(std::string_view text);

  /// False at the end of the text.
  bool next();
  /// As next(), but throws at the end, naming what was `wanted`.
  void require(const char* wanted);

  const std::vector<std::string_view>& words() const { return words_; }
  std::size_t number() const { return number_; }  ///< of the line, from 1
  /// What follows the current line.
  std::string_view rest() const { return rest_; }

  /// The number that is word `i` of the line, correctly rounded; nan and inf are numbers. Throws if
  /// there is none.
  double real(std::size_t i) const;
  /// The integer that word `i` is up to the first `end`.
  std::int64_t integer(std::size_t i, char end = ' ') const;

  [[noreturn]] void refuse(const std::string& why) const;
  /// As that, telling what word `i` is instead, if there is one.
  [[noreturn]] void refuse(const std::string& why, std::size_t i) const;
  /// What `action`, which looks at no line, throws as std::invalid_argument is said of this one.
  template <class Action>
  auto ofThisLine(const Action& action) const {
    try {
      return action();
    } catch (const std::invalid_argument& error) {
      refuse(error.what());
    }
  }

 private:
  std::string_view word(std::size_t i) const;

  std::string_view rest_;
  std::vector<std::string_view> words_;
  std::size_t number_ = 0;
};

}  // namespace organ_collision::io
