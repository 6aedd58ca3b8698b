#include "arguments.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <system_error>

namespace organ_collision::tools {
namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& value,
                         const std::string& wanted) {
  throw UsageError(option + " " + value + ": " + wanted + " is wanted");
}

/// What a package.xml says between <name> and </name>.
std::string nameIn(const std::filesystem::path& package_xml) {
  std::ifstream file(package_xml);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  const std::regex name("<name>\\s*([^<\\s]*)\\s*</name>");
  std::smatch match;
  return std::regex_search(text, match, name) ? match[1].str() : "";
}

/// In a folder that was not `seen` yet: links may go round.
std::optional<std::filesystem::path> findPackageIn(const std::filesystem::path& folder,
                                                   const std::string& package,
                                                   std::set<std::filesystem::path>& seen) {
  namespace fs = std::filesystem;
  std::error_code ignored;
  if (!seen.insert(fs::canonical(folder, ignored)).second) return std::nullopt;
  if (fs::exists(folder / "CATKIN_IGNORE", ignored)) return std::nullopt;
  if (fs::exists(folder / "package.xml", ignored))
    return nameIn(folder / "package.xml") == package ? std::optional(folder) : std::nullopt;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored)) {
    const bool is_hidden = entry.path().filename().string().front() == '.';
    if (is_hidden || !entry.is_directory(ignored)) continue;
    if (auto found = findPackageIn(entry.path(), package, seen)) return found;
  }
  return std::nullopt;
}

}  // namespace

Arguments::Arguments(const std::vector<std::string>& words, const std::vector<std::string>& known) {
  for (auto word = words.begin(); word != words.end(); ++word) {
    if (word->size() < 2 || word->front() != '-') {
      words_.push_back(*word);
      continue;
    }
    const std::size_t equals = word->find('=');
    const std::string name = word->substr(0, equals);
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      throw UsageError("there is no option " + name);
    }
    const auto next = std::next(word);
    if (equals == std::string::npos && (next == words.end() || next->substr(0, 2) == "--")) {
      throw UsageError(name + " has no value");
    }
    const std::string value = equals == std::string::npos ? *++word : word->substr(equals + 1);
    if (!options_.emplace(name, value).second) throw UsageError(name + " is given twice");
  }
}

void Arguments::requireNoWords() const {
  if (!words_.empty()) throw UsageError(words_.front() + ": no such argument is wanted");
}

std::optional<std::string> Arguments::option(const std::string& name) const {
  const auto found = options_.find(name);
  if (found == options_.end()) return std::nullopt;
  return found->second;
}

double Arguments::aboveZero(const std::string& name, double otherwise) const {
  const std::optional<std::string> text = option(name);
  if (!text) return otherwise;
  char* end = nullptr;
  const double value = std::strtod(text->c_str(), &end);
  if (text->empty() || *end != '\0' || !std::isfinite(value) || value <= 0.0) {
    refuse(name, *text, "a finite number above 0");
  }
  return value;
}

std::size_t Arguments::whole(const std::string& name, std::size_t otherwise, std::size_t least,
                             std::size_t most) const {
  const std::optional<std::string> text = option(name);
  if (!text) return otherwise;
  std::size_t value = 0;
  const char* const end = text->data() + text->size();
  const auto [stop, error] = std::from_chars(text->data(), end, value);
  if (error != std::errc() || stop != end || value < least || value > most)
    refuse(name, *text,
           "a whole number from " + std::to_string(least) + " to " + std::to_string(most));
  return value;
}

std::optional<std::filesystem::path> findPackage(const std::string& package) {
  const char* path = std::getenv("ROS_PACKAGE_PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  std::set<std::filesystem::path> seen;
  for (std::string folder; std::getline(folders, folder, ':');)
    if (auto found = findPackageIn(folder, package, seen)) return found;
  return std::nullopt;
}

}  // namespace organ_collision::tools
