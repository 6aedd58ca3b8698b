#pragma once

#include <malloc.h>

#include <cstddef>

namespace organ_collision::test {

/// Bytes that this process has allocated and not freed; 0 where a sanitizer allocates them.
inline std::size_t allocatedMemory() {
  const auto now = mallinfo2();
  return now.uordblks + now.hblkhd;
}

}  // namespace organ_collision::test
