#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "organ_collision/io/value.h"

namespace organ_collision::io {

/// A value and the path of keys that leads to it. The value must outlive it.
/// All errors are std::invalid_argument "path: value, but it must be ...".
class Field {
 public:
  Field(const Value& value, std::string path) : value_(&value), path_(std::move(path)) {}

  // Of a map.
  std::optional<Field> find(const std::string& key) const;
  Field at(const std::string& key) const;
  void allowOnly(const std::vector<std::string_view>& keys) const;

  std::vector<Field> items() const;                   ///< of a list
  std::vector<Field> items(std::size_t count) const;  ///< of a list of so many

  std::string text() const;   ///< not empty
  std::string frame() const;  ///< a text that tf takes for a frame
  bool yesOrNo() const;
  std::uint32_t count() const;
  double coordinate() const;       ///< of a magnitude below core::kLargestCoordinate
  double length() const;           ///< above 0, below core::kLargestCoordinate
  double aboveZero() const;        ///< finite
  double upTo(double most) const;  ///< from 0

  [[noreturn]] void refuse(const std::string& why) const;

 private:
  template <typename Kind>
  const Kind& as(const std::string& wanted) const;
  template <typename IsWanted>
  double number(const std::string& wanted, const IsWanted& is_wanted) const;
  [[noreturn]] void refuseFor(const std::string& wanted) const;

  const Value* value_;
  std::string path_;
};

}  // namespace organ_collision::io
