#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <ostream>
#include <string>

namespace organ_collision::tools {

/// Tells how far a long task is and how long it will still take: a bar that is redrawn on a
/// terminal, a line for every tenth elsewhere.
class Progress {
 public:
  using Clock = std::function<std::chrono::steady_clock::time_point()>;

  /// Shown on stderr.
  Progress(std::string task, std::size_t steps);
  Progress(std::string task, std::size_t steps, std::ostream& out, bool is_terminal, Clock clock);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;
  /// Ends the line, whether or not all steps were done.
  ~Progress();

  void advance(std::size_t steps = 1);

 private:
  void show();
  double secondsLeft() const;

  std::string task_;
  std::size_t steps_;
  std::ostream& out_;
  bool is_terminal_;
  Clock clock_;
  std::chrono::steady_clock::time_point start_;
  std::size_t done_ = 0;
  std::size_t shown_ = 0;  // in ticks: per cent on a terminal, else tenths
};

}  // namespace organ_collision::tools
