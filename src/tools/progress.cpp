#include "progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>

namespace organ_collision::tools {
namespace {

constexpr std::size_t kBarLength = 30;  // characters

std::string bar(std::size_t done, std::size_t steps) {
  const std::size_t filled = kBarLength * done / steps;
  return "[" + std::string(filled, '#') + std::string(kBarLength - filled, '.') + "]";
}

}  // namespace

Progress::Progress(std::string task, std::size_t steps)
    : Progress(std::move(task), steps, std::cerr, isatty(STDERR_FILENO) != 0,
               std::chrono::steady_clock::now) {}

Progress::Progress(std::string task, std::size_t steps, std::ostream& out, bool is_terminal,
                   Clock clock)
    : task_(std::move(task)),
      steps_(std::max<std::size_t>(steps, 1)),
      out_(out),
      is_terminal_(is_terminal),
      clock_(std::move(clock)),
      start_(clock_()) {}

Progress::~Progress() {
  if (is_terminal_ && shown_ > 0) out_ << std::endl;
}

void Progress::advance(std::size_t steps) {
  done_ = std::min(done_ + steps, steps_);
  const std::size_t ticks = is_terminal_ ? 100 : 10;
  const std::size_t reached = done_ * ticks / steps_;
  if (reached == shown_) return;
  shown_ = reached;
  show();
}

double Progress::secondsLeft() const {
  const std::chrono::duration<double> elapsed = clock_() - start_;
  return elapsed.count() * static_cast<double>(steps_ - done_) / static_cast<double>(done_);
}

void Progress::show() {
  if (is_terminal_) out_ << '\r';
  out_ << task_ << ' ';
  if (is_terminal_) out_ << bar(done_, steps_) << ' ';
  out_ << 100 * done_ / steps_ << " %, " << std::lround(secondsLeft()) << " s left";
  if (is_terminal_) {
    out_ << "   " << std::flush;  // covers what a longer number left
  } else {
    out_ << std::endl;
  }
}

}  // namespace organ_collision::tools
