#include "node/log_limit.h"

#include <cctype>
#include <iterator>

namespace organ_collision::node {
namespace {

constexpr std::size_t kMostTexts = 64;  // texts at a time: who sends ever new names fills no memory

std::string withoutNumbers(const std::string& text) {
  bool in_name = false;
  const auto is_of_number = [&in_name](unsigned char c) {
    in_name = in_name != (c == '\'');
    return !in_name && std::isdigit(c) != 0;
  };
  std::string kept;
  for (const char c : text)
    if (!is_of_number(static_cast<unsigned char>(c))) kept += c;
  return kept;
}

}  // namespace

bool LogLimit::allows(const std::string& text, const ros::SteadyTime& now) {
  for (auto known = silent_until_.begin(); known != silent_until_.end();)
    known = known->second <= now ? silent_until_.erase(known) : std::next(known);
  if (silent_until_.size() == kMostTexts) return false;
  return silent_until_.emplace(withoutNumbers(text), now + ros::WallDuration(kPeriod)).second;
}

}  // namespace organ_collision::node
