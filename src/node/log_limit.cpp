#include "node/log_limit.h"

#include <cctype>
#include <cstdlib>
#include <iterator>

namespace organ_collision::node {
namespace {

constexpr std::size_t kMostTexts = 64;  // texts at a time: who sends ever new names fills no memory

bool isNumber(const std::string& word) {
  char* end = nullptr;
  std::strtod(word.c_str(), &end);
  return !word.empty() && *end == '\0';
}

}  // namespace

/// Nan and inf are numbers, too.
std::string withoutNumbers(const std::string& text) {
  bool in_name = false;
  std::string kept;
  std::string word;
  const auto end_word = [&] {
    if (in_name || !isNumber(word)) kept += word;
    word.clear();
  };
  for (const char c : text) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '+' || c == '-' || c == '.') {
      word += c;
      continue;
    }
    end_word();
    in_name = in_name != (c == '\'');
    kept += c;
  }
  end_word();
  return kept;
}

bool LogLimit::allows(const std::string& text, const ros::SteadyTime& now) {
  for (auto known = silent_until_.begin(); known != silent_until_.end();)
    known = known->second <= now ? silent_until_.erase(known) : std::next(known);
  if (silent_until_.size() == kMostTexts) return false;
  return silent_until_.emplace(withoutNumbers(text), now + ros::WallDuration(kPeriod)).second;
}

}  // namespace organ_collision::node
