#pragma once

#include <cstddef>
#include <mutex>
#include <string>

#include "organ_collision/io/message_text.h"

namespace organ_collision::node {

/// What went wrong, until diagnostics tell it. For any threads.
class Incidents {
 public:
  struct News {
    std::size_t count;  ///< of all
    std::size_t more;   ///< since the last time
    std::string last;
  };

  void note(const std::string& what) {
    std::string reason = io::printable(what);
    const std::lock_guard<std::mutex> lock(mutex_);
    ++news_.count;
    ++news_.more;
    news_.last.swap(reason);  // the former is freed after the lock
  }
  News takeNews() {
    const std::lock_guard<std::mutex> lock(mutex_);
    News news = news_;
    news_.more = 0;
    return news;
  }

 private:
  std::mutex mutex_;
  News news_ = {};
};

}  // namespace organ_collision::node
