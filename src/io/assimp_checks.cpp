#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>

#include "mesh_readers.h"
#include "text_lines.h"

namespace organ_collision::io {
namespace {

/// The words of a text, whatever lines they are on. Errors name the line.
class Words {
 public:
  explicit Words(std::string_view text) : lines_(text) {}

  bool atEnd() {
    while (next_ >= lines_.words().size()) {
      next_ = 0;
      if (!lines_.next()) return true;
    }
    return false;
  }
  std::string_view take(const char* wanted) {
    if (atEnd()) lines_.require(wanted);  // which throws
    return lines_.words()[next_++];
  }
  bool nextIs(const char* word) { return !atEnd() && lines_.words()[next_] == word; }
  void expect(const char* word) {
    if (take(word) != word) lines_.refuse(std::string("the word ") + word + " is wanted");
  }
  void expectNumber() {
    take("a number");
    lines_.real(next_ - 1);
  }
  void skipLine() { next_ = lines_.words().size(); }

 private:
  TextLines lines_;
  std::size_t next_ = 0;
};

/// As assimp tells them apart: a binary file may begin with "solid", too.
bool isBinaryStl(std::string_view bytes) {
  constexpr std::size_t kHeader = 80;
  constexpr std::size_t kFacet = 50;
  std::uint32_t count = 0;
  if (bytes.size() < kHeader + sizeof count) return false;
  std::memcpy(&count, bytes.data() + kHeader, sizeof count);
  return bytes.size() == kHeader + sizeof count + kFacet * count;
}

void checkFacet(Words& words) {
  for (const char* const word : {"facet", "normal"}) words.expect(word);
  for (int i = 0; i < 3; ++i) words.take("a normal");  // often nan, and of no use
  for (const char* const word : {"outer", "loop"}) words.expect(word);
  for (int i = 0; i < 3; ++i) {
    words.expect("vertex");
    for (int k = 0; k < 3; ++k) words.expectNumber();
  }
  for (const char* const word : {"endloop", "endfacet"}) words.expect(word);
}

}  // namespace

void checkStl(std::string_view bytes) {
  const bool may_be_text =
      !isBinaryStl(bytes) && Words(bytes).take("solid").substr(0, 5) == "solid";
  if (!may_be_text) return;
  Words words(bytes);
  while (!words.atEnd()) {
    words.expect("solid");
    words.skipLine();  // its name
    while (words.nextIs("facet")) checkFacet(words);
    words.expect("endsolid");
    words.skipLine();
  }
}

void checkDae(std::string_view text) {
  for (const std::string_view tag : {"<p>", "<vcount>", " meter=\""}) {
    for (std::size_t at = text.find(tag); at != text.npos; at = text.find(tag, at)) {
      at = std::min(text.find_first_not_of("0123456789 \t\r\n", at + tag.size()), text.size());
      if (text.substr(at, 1) != "-") continue;
      const auto line = 1 + std::count(text.begin(), text.begin() + at, '\n');
      throw std::invalid_argument("line " + std::to_string(line) + ": a number after " +
                                  std::string(tag) + " is below 0");
    }
  }
}

}  // namespace organ_collision::io
