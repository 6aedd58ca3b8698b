#include "node/log_limit.h"

#include <algorithm>
#include <cctype>

namespace organ_collision::node {
namespace {

constexpr std::size_t kMost = 64;  // texts at a time: who sends ever new names fills no memory

std::string withoutDigits(std::string text) {
  const auto is_digit = [](unsigned char c) { return std::isdigit(c) != 0; };
  text.erase(std::remove_if(text.begin(), text.end(), is_digit), text.end());
  return text;
}

}  // namespace

bool LogLimit::allows(const std::string& text, const ros::SteadyTime& now) {
  for (auto known = silent_until_.begin(); known != silent_until_.end();)
    known = known->second <= now ? silent_until_.erase(known) : std::next(known);
  if (silent_until_.size() == kMost) return false;
  return silent_until_.emplace(withoutDigits(text), now + ros::WallDuration(kPeriod)).second;
}

}  // namespace organ_collision::node
