#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace organ_collision::tools {

/// The user asked for what there is not.
struct UsageError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// What a command line says: words, and options with a value each ("--seed 7" or "--seed=7").
class Arguments {
 public:
  /// `words`: without the program's name. Throws UsageError for an option that is not in `known`,
  /// is given twice or has no value.
  Arguments(const std::vector<std::string>& words, const std::vector<std::string>& known);

  const std::vector<std::string>& words() const { return words_; }
  /// Throws UsageError if there are any.
  void requireNoWords() const;
  std::optional<std::string> option(const std::string& name) const;

  /// The option's number, or `otherwise`. Throws UsageError unless it is finite and above 0.
  double aboveZero(const std::string& name, double otherwise) const;
  /// The same for a whole number from `least` to `most`.
  std::size_t whole(const std::string& name, std::size_t otherwise, std::size_t least = 0,
                    std::size_t most = 999'999'999'999'999) const;

 private:
  std::vector<std::string> words_;
  std::map<std::string, std::string> options_;
};

/// Where ROS_PACKAGE_PATH has a package of that name: one of its folders or one below. Not in
/// packages, nor where a file CATKIN_IGNORE is.
std::optional<std::filesystem::path> findPackage(const std::string& package);

}  // namespace organ_collision::tools
