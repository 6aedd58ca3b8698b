#include <Eigen/Core>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <system_error>

#include "mesh_readers.h"
#include "shown.h"

namespace organ_collision::io {
namespace {

constexpr std::string_view kBlanks = " \t\r\n";
constexpr std::string_view kDigitsAndBlanks = "0123456789 \t\r\n";
constexpr std::size_t kNowhere = std::string_view::npos;

/// Where the first that is not one of some characters is; the end, if there is none.
std::size_t behind(std::string_view characters, std::string_view text, std::size_t at) {
  return std::min(text.find_first_not_of(characters, at), text.size());
}

bool isOneOf(std::string_view characters, std::string_view text, std::size_t at) {
  return at < text.size() && characters.find(text[at]) != kNowhere;
}

[[noreturn]] void refuse(std::string_view text, std::size_t at, const std::string& why) {
  const auto begin = text.begin();
  const auto line = 1 + std::count(begin, begin + static_cast<std::ptrdiff_t>(at), '\n');
  throw std::invalid_argument("line " + std::to_string(line) + ": " + why);
}

/// Calls `check` with where the content of each such tag, as "<p", begins, and with its attributes.
template <class Check>
void forEachTag(std::string_view text, std::string_view opening, const Check& check) {
  for (std::size_t at = text.find(opening); at != kNowhere; at = text.find(opening, at)) {
    at += opening.size();
    if (!isOneOf(" \t\r\n>", text, at)) continue;  // a longer name
    const std::size_t end = std::min(text.find('>', at), text.size());
    check(std::min(end + 1, text.size()), text.substr(at, end - at));
  }
}

/// What stands between the quotes; nothing where there is no such attribute.
std::optional<std::string_view> attributeOf(std::string_view attributes, std::string_view name) {
  for (std::size_t at = attributes.find(name); at != kNowhere; at = attributes.find(name, at)) {
    const bool is_begin = at > 0 && isOneOf(kBlanks, attributes, at - 1);
    at = behind(kBlanks, attributes, at + name.size());
    if (!is_begin || !isOneOf("=", attributes, at)) continue;
    at = behind(kBlanks, attributes, at + 1);
    if (!isOneOf("\"'", attributes, at)) continue;
    const std::size_t end = attributes.find(attributes[at], at + 1);
    return attributes.substr(at + 1, end - at - 1);
  }
  return std::nullopt;
}

/// A unit below 0 would mirror.
void checkUnit(std::string_view text) {
  forEachTag(text, "<unit", [&](std::size_t end, std::string_view attributes) {
    const std::string_view meter = attributeOf(attributes, "meter").value_or("");
    if (isOneOf("-", meter, behind(kBlanks, meter, 0)))
      refuse(text, end, "a number after meter= is below 0");
  });
}

/// assimp takes numbers below 0 for 0, and of what is none asks for all the memory there is.
void checkNumbers(std::string_view text, std::string_view tag) {
  forEachTag(text, tag, [&](std::size_t begin, std::string_view attributes) {
    const std::size_t at = behind(kDigitsAndBlanks, text, begin);
    const bool is_empty = !attributes.empty() && attributes.back() == '/';
    if (is_empty || at == text.size() || text.substr(at, 2) == "</") return;
    const std::string after = " after " + std::string(tag) + ">";
    if (text[at] == '-') refuse(text, at, "a number" + after + " is below 0");
    const std::size_t end = text.find_first_of(" \t\r\n<", at + 1);
    refuse(text, at, quoted(text.substr(at, end - at)) + after + " is no number, 0 or above");
  });
}

/// assimp passes over those whose count it cannot read, or is told to be 0, or is not told.
void checkCount(std::string_view text, const std::string& name) {
  forEachTag(text, "<" + name, [&](std::size_t begin, std::string_view attributes) {
    const std::optional<std::string_view> count = attributeOf(attributes, "count");
    if (count && (behind(kBlanks, *count, 0) == count->size() ||
                  behind(kDigitsAndBlanks, *count, 0) != count->size()))
      refuse(text, begin, quoted(*count) + " is no count of " + name);
    if (count && count->find_first_of("123456789") != kNowhere) return;
    const std::string_view content = text.substr(begin, text.find("</" + name, begin) - begin);
    forEachTag(content, "<p", [&](std::size_t indices, std::string_view) {
      if (isOneOf("0123456789", content, behind(kBlanks, content, indices)))
        refuse(text, begin,
               "the count of " + name + (count ? " is 0" : " is missing") + ", but there are some");
    });
  });
}

/// assimp takes a fan for a polygon, which it fills by triangles of its own.
void checkFans(std::string_view text) {
  forEachTag(text, "<trifans", [&](std::size_t begin, std::string_view) {
    refuse(text, begin, "trifans are not read: save the mesh as triangles");
  });
}

/// Four numbers, from there on; nothing if others than they stand there.
std::optional<Eigen::Vector4d> fourNumbers(std::string_view text, std::size_t at) {
  Eigen::Vector4d numbers;
  for (double& number : numbers) {
    at = behind(" \t\r\n,", text, at);
    const char* const end = text.data() + text.size();
    const auto [stop, error] = std::from_chars(text.data() + at, end, number);
    if (error != std::errc()) return std::nullopt;
    at = static_cast<std::size_t>(stop - text.data());
  }
  return numbers;
}

/// assimp takes any axis and any quaternion for one of length 1, and stretches what it turns by
/// another. Why `direction` is none; empty: it is.
std::string faultOfLength(const std::string& what, const Eigen::VectorXd& direction) {
  constexpr double kTolerance = 1e-4;  // of what files tell with four digits
  const double length = direction.norm();
  if (std::abs(length - 1.0) <= kTolerance) return "";
  std::string numbers;
  for (const double number : direction) numbers += (numbers.empty() ? "" : " ") + shown(number);
  return what + ", " + numbers + ", is of length " + shown(length) + ", not 1";
}

void checkRotations(std::string_view text) {
  forEachTag(text, "<rotate", [&](std::size_t begin, std::string_view) {
    const auto rotation = fourNumbers(text, begin);
    if (!rotation || (*rotation)[3] == 0.0) return;
    const std::string fault = faultOfLength("the axis of a rotation", rotation->head<3>());
    if (!fault.empty()) refuse(text, begin, fault);
  });
}

/// Of the nodes of glTF: `"rotation": [...]`.
void checkQuaternions(std::string_view bytes) {
  constexpr std::string_view kName = "\"rotation\"";
  for (std::size_t at = bytes.find(kName); at != kNowhere; at = bytes.find(kName, at)) {
    at = behind(kBlanks, bytes, at + kName.size());
    if (!isOneOf(":", bytes, at)) continue;
    at = behind(kBlanks, bytes, at + 1);
    const auto rotation = isOneOf("[", bytes, at) ? fourNumbers(bytes, at + 1) : std::nullopt;
    const std::string fault = rotation ? faultOfLength("the rotation of a node", *rotation) : "";
    if (!fault.empty()) throw std::invalid_argument(fault);
  }
}

/// Of an extension of glTF.
bool changesNoShape(std::string_view extension) {
  for (const std::string_view kind : {"KHR_materials_", "KHR_texture_", "KHR_lights_"})
    if (extension.substr(0, kind.size()) == kind) return true;
  return false;
}

}  // namespace

void checkDae(std::string_view text) {
  checkUnit(text);
  checkRotations(text);
  checkFans(text);
  for (const char* const tag : {"<p", "<vcount"}) checkNumbers(text, tag);
  for (const char* const name : {"triangles", "polylist", "polygons", "tristrips"})
    checkCount(text, name);
}

void checkGltf(std::string_view bytes) {
  checkQuaternions(bytes);
  constexpr std::string_view kName = "\"extensionsRequired\"";
  const std::size_t name = bytes.find(kName);
  if (name == kNowhere) return;
  const std::string_view list =
      bytes.substr(name + kName.size(), bytes.find(']', name) - name - kName.size());
  for (std::size_t begin = list.find('"'); begin != kNowhere;) {
    const std::size_t end = std::min(list.find('"', begin + 1), list.size());
    const std::string_view extension = list.substr(begin + 1, end - begin - 1);
    if (!changesNoShape(extension))
      throw std::invalid_argument("it asks for extensions of glTF, of which none is known here: " +
                                  quoted(extension));
    begin = list.find('"', end + 1);
  }
}

}  // namespace organ_collision::io
