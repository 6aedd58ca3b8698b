#pragma once

#include <gtest/gtest.h>

#include <string>

#include "organ_collision/core/vector_unit.h"

namespace organ_collision::test {

/// Tests that run once with each vector unit that the machine has.
class EveryVectorUnit : public testing::TestWithParam<core::VectorUnit> {
 protected:
  void SetUp() override { core::useVectorUnit(GetParam()); }
  void TearDown() override { core::useVectorUnit(core::availableVectorUnits().back()); }
};

inline std::string nameOf(const testing::TestParamInfo<core::VectorUnit>& unit) {
  const char* const names[] = {"Baseline", "Avx2", "Avx512"};
  return names[static_cast<std::size_t>(unit.param)];
}

}  // namespace organ_collision::test

/// Runs the tests of a fixture that derives from EveryVectorUnit.
#define ORGAN_COLLISION_ON_EVERY_VECTOR_UNIT(fixture)                                        \
  INSTANTIATE_TEST_SUITE_P(Vectors, fixture,                                                 \
                           testing::ValuesIn(organ_collision::core::availableVectorUnits()), \
                           organ_collision::test::nameOf)
