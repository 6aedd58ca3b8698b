#include <algorithm>
#include <array>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "mesh_readers.h"

namespace organ_collision::io {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";
constexpr std::string_view kDigitsAndBlanks = "0123456789 \t\r\n";

/// Where numbers begin: behind a name and, with or without blanks between them, what follows it.
struct Opening {
  std::string_view name, shown;
  std::array<std::string_view, 2> then;  // of each, one of these characters; none: nothing
};

/// Where the first that is not one of some characters is; the end, if there is none.
std::size_t behind(std::string_view characters, std::string_view text, std::size_t at) {
  return std::min(text.find_first_not_of(characters, at), text.size());
}

/// `at` is behind the name; npos if something else follows.
std::size_t behindOpening(const Opening& opening, std::string_view text, std::size_t at) {
  for (const std::string_view characters : opening.then) {
    if (characters.empty()) continue;
    at = behind(kBlanks, text, at);
    if (at == text.size() || characters.find(text[at]) == characters.npos) return text.npos;
    ++at;
  }
  return at;
}

}  // namespace

void checkDae(std::string_view text) {
  for (const Opening& opening : {Opening{"<p", "<p>", {">"}}, Opening{"<vcount", "<vcount>", {">"}},
                                 Opening{"meter", "meter=", {"=", "\"'"}}}) {
    std::size_t next = 0;
    while ((next = text.find(opening.name, next)) != text.npos) {
      next += opening.name.size();
      std::size_t at = behindOpening(opening, text, next);
      if (at == text.npos) continue;
      at = next = behind(kDigitsAndBlanks, text, at);
      if (text.substr(at, 1) != "-") continue;
      const auto line = 1 + std::count(text.begin(), text.begin() + at, '\n');
      throw std::invalid_argument("line " + std::to_string(line) + ": a number after " +
                                  std::string(opening.shown) + " is below 0");
    }
  }
}

void checkGltf(std::string_view bytes) {
  if (bytes.find("\"extensionsRequired\"") != bytes.npos)
    throw std::invalid_argument("it asks for extensions of glTF, of which none is known here");
}

}  // namespace organ_collision::io
