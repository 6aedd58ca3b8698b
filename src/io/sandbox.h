#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>

#include "organ_collision/io/mesh_io.h"

namespace organ_collision::io {

struct ChildLimits {
  double seconds;      ///< [s] wall clock
  std::size_t memory;  ///< [bytes] beyond what the process has now; also the longest answer
};

/// Those of a job that reads a file or a text of `size` [bytes].
ChildLimits limitsFor(std::uintmax_t size, const LoadLimits& limits);

/// What `job` returns, run in a forked child: whatever it does to memory, signals or time, this
/// process goes on. Throws std::runtime_error "`what`: ..." with the message of the job's
/// exception, or with the signal, the time or the memory that ended it. The memory limit is not
/// enforced under the address sanitizer.
std::string runInChild(const std::string& what, const std::function<std::string()>& job,
                       const ChildLimits& limits);

}  // namespace organ_collision::io
