#include "organ_collision/core/huge_pages.h"

#include <sys/mman.h>

#include <new>

namespace organ_collision::core {
namespace {

std::align_val_t placed(std::size_t size, std::size_t alignment) {
  return std::align_val_t{size < kLeastInHugePages ? alignment : kHugePage};
}

}  // namespace

void* allocateArray(std::size_t size, std::size_t alignment) {
  void* const array = ::operator new(size, placed(size, alignment));
#if defined(MADV_HUGEPAGE)
  // An advice: a system that does not take it goes on with small pages. So does the end of the
  // array, for which most of a large one might be taken in vain.
  if (size >= kLeastInHugePages) madvise(array, size / kHugePage * kHugePage, MADV_HUGEPAGE);
#endif
  return array;
}

void freeArray(void* array, std::size_t size, std::size_t alignment) noexcept {
  ::operator delete(array, placed(size, alignment));
}

}  // namespace organ_collision::core
