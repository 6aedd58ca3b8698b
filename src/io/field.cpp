#include "field.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <variant>

#include "organ_collision/core/triangle_mesh.h"
#include "organ_collision/io/message_text.h"
#include "shown.h"

namespace organ_collision::io {
namespace {

struct Shown {
  std::string operator()(std::monostate) const { return "null"; }
  std::string operator()(bool value) const { return value ? "true" : "false"; }
  std::string operator()(int value) const { return std::to_string(value); }
  std::string operator()(double value) const {
    const std::string text = shown(value);
    const bool is_like_an_integer = text.find_first_not_of("-0123456789") == std::string::npos;
    return is_like_an_integer ? text + ".0" : text;
  }
  std::string operator()(const std::string& value) const { return "'" + value + "'"; }
  std::string operator()(const List& value) const {
    return "a list of " + std::to_string(value.size());
  }
  std::string operator()(const Map&) const { return "a map"; }
};

bool isNumber(const std::string& text) {
  std::istringstream stream(text);
  double number = 0.0;
  return stream >> number && stream.eof();
}

}  // namespace

template <typename Kind>
const Kind& Field::as(const std::string& wanted) const {
  const Kind* const kind = std::get_if<Kind>(value_);
  if (kind == nullptr) refuseFor(wanted);
  return *kind;
}

template <typename IsWanted>
double Field::number(const std::string& wanted, const IsWanted& is_wanted) const {
  const int* const integer = std::get_if<int>(value_);
  const auto* const text = std::get_if<std::string>(value_);
  // As ROS reads YAML, 1e-3 is a text.
  if (text != nullptr && isNumber(*text)) refuseFor(wanted + ", written like 0.001 or 1.0e-3");
  const double number = integer != nullptr ? *integer : as<double>(wanted);
  if (!is_wanted(number)) refuseFor(wanted);
  return number;
}

std::optional<Field> Field::find(const std::string& key) const {
  const Map& map = as<Map>("a map");
  const auto found = map.find(key);
  if (found == map.end()) return std::nullopt;
  return Field(found->second, path_ + "." + key);
}

Field Field::at(const std::string& key) const {
  if (const std::optional<Field> found = find(key)) return *found;
  throw std::invalid_argument(path_ + "." + key + ": is missing");
}

void Field::allowOnly(const std::vector<std::string_view>& keys) const {
  for (const auto& [key, value] : as<Map>("a map")) {
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    throw std::invalid_argument(path_ + "." + key + ": unknown key; known: " + joined(keys));
  }
}

std::vector<Field> Field::items() const {
  const List& list = as<List>("a list");
  std::vector<Field> fields;
  for (std::size_t i = 0; i < list.size(); ++i) {
    fields.emplace_back(list[i], path_ + "[" + std::to_string(i) + "]");
  }
  return fields;
}

std::vector<Field> Field::items(std::size_t count) const {
  const std::string wanted = "a list of " + std::to_string(count);
  std::vector<Field> fields;
  if (std::holds_alternative<List>(*value_)) fields = items();
  if (fields.size() != count) refuseFor(wanted);
  return fields;
}

std::string Field::text() const {
  const auto& text = as<std::string>("a text");
  if (text.empty()) refuseFor("a text that is not empty");
  return text;
}

std::string Field::frame() const {
  std::string frame = text();
  if (frame.front() == '/') refuseFor("a tf frame, which does not begin with '/'");
  return frame;
}

bool Field::yesOrNo() const { return as<bool>("true or false, without quotes"); }

std::uint32_t Field::count() const {
  const char* const wanted = "an integer without a point, 0 or above";
  const int count = as<int>(wanted);
  if (count < 0) refuseFor(wanted);
  return static_cast<std::uint32_t>(count);
}

double Field::coordinate() const {
  return number("a finite number of a magnitude below " + shown(core::kLargestCoordinate),
                [](double number) { return std::abs(number) < core::kLargestCoordinate; });
}

double Field::length() const {
  return number("a number above 0 and below " + shown(core::kLargestCoordinate),
                [](double number) { return number > 0.0 && number < core::kLargestCoordinate; });
}

double Field::aboveZero() const {
  return number("a finite number above 0",
                [](double number) { return std::isfinite(number) && number > 0.0; });
}

double Field::upTo(double most) const {
  return number("a number from 0 to " + shown(most),
                [most](double number) { return number >= 0.0 && number <= most; });
}

void Field::refuse(const std::string& why) const {
  throw std::invalid_argument(path_ + ": " + why);
}

void Field::refuseFor(const std::string& wanted) const {
  refuse(std::visit(Shown(), *value_) + ", but it must be " + wanted);
}

}  // namespace organ_collision::io
