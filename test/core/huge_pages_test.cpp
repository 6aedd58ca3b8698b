#include "organ_collision/core/huge_pages.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

namespace organ_collision::core {
namespace {

using testing::HasSubstr;
using testing::Not;

std::uintptr_t addressOf(const void* place) { return reinterpret_cast<std::uintptr_t>(place); }

/// What the system tells of the memory around a place, in its own words.
std::string flagsAt(const void* place) {
  std::ifstream maps("/proc/self/smaps");
  bool is_here = false;
  for (std::string line; std::getline(maps, line);) {
    std::uintptr_t begin = 0, end = 0;
    char dash = 0;
    if (std::istringstream range(line); range >> std::hex >> begin >> dash >> end && dash == '-')
      is_here = begin <= addressOf(place) && addressOf(place) < end;
    if (is_here && line.rfind("VmFlags:", 0) == 0) return line + " ";
  }
  return {};
}

TEST(HugePages, LargeArraysAskForThem) {
  if (!std::ifstream("/sys/kernel/mm/transparent_hugepage/enabled"))
    GTEST_SKIP() << "the system has no huge pages";
  const HugePageVector<int> smaller(kLeastInHugePages / sizeof(int) - 1);
  EXPECT_THAT(flagsAt(smaller.data()), Not(HasSubstr(" hg ")));
  const HugePageVector<int> large(kLeastInHugePages / sizeof(int));
  EXPECT_EQ(addressOf(large.data()) % kHugePage, 0U);
  EXPECT_THAT(flagsAt(large.data()), HasSubstr(" hg "));
}

TEST(HugePages, SmallArraysLieAsTheirElementsWant) {
  struct alignas(64) Line {
    char bytes[64];
  };
  for (std::size_t count = 1; count < 100; ++count)
    EXPECT_EQ(addressOf(HugePageVector<Line>(count).data()) % alignof(Line), 0U);
}

TEST(HugePages, ElementsStayWhileArraysGrow) {
  HugePageVector<std::uint32_t> numbers;
  std::vector<std::uint32_t> expected(kHugePage);  // 8 MB
  std::iota(expected.begin(), expected.end(), 0U);
  for (const std::uint32_t number : expected) numbers.push_back(number);
  HugePageVector<std::uint32_t> copy = numbers;
  numbers = {};
  EXPECT_TRUE(std::equal(copy.begin(), copy.end(), expected.begin(), expected.end()));
}

}  // namespace
}  // namespace organ_collision::core
