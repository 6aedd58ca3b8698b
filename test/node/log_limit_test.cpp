#include "node/log_limit.h"

#include <gtest/gtest.h>

namespace organ_collision::node {
namespace {

const ros::SteadyTime kStart(10.0);
const ros::WallDuration kPeriod(LogLimit::kPeriod);

TEST(LogLimit, AllowsTheSameOnceInAPeriodWhateverItsNumbers) {
  LogLimit limit;
  EXPECT_TRUE(limit.allows("vertex 3 of 4", kStart));
  EXPECT_FALSE(limit.allows("vertex 17 of 4", kStart));
  EXPECT_TRUE(limit.allows("triangle 17 of 4", kStart));
  EXPECT_FALSE(limit.allows("vertex 3 of 4", kStart + ros::WallDuration(0.9 * LogLimit::kPeriod)));
  EXPECT_TRUE(limit.allows("vertex 3 of 4", kStart + kPeriod));
  EXPECT_FALSE(limit.allows("vertex 3 of 4", kStart + kPeriod));
}

TEST(LogLimit, TellsNamesApartThatDifferInTheirNumbers) {
  LogLimit limit;
  EXPECT_TRUE(limit.allows("'psm1' is 3 s old", kStart));
  EXPECT_TRUE(limit.allows("'psm2' is 3 s old", kStart));
  EXPECT_FALSE(limit.allows("'psm2' is 4 s old", kStart));
}

TEST(LogLimit, KnowsNumbersOfAnyForm) {
  LogLimit limit;
  EXPECT_TRUE(limit.allows("its rotation (0.5, -1e-07, nan, 3) is not of length 1.", kStart));
  EXPECT_FALSE(limit.allows("its rotation (-inf, 2, +4.5, -nan) is not of length 1.", kStart));
  EXPECT_TRUE(limit.allows("its rotation (0.5, x, nan, 3) is not of length 1.", kStart));
}

TEST(LogLimit, AllowsAFewOfManyThingsAtATime) {
  LogLimit limit;
  std::string name;
  int allowed = 0;
  for (int i = 0; i < 1000; ++i) allowed += limit.allows(name += 'x', kStart) ? 1 : 0;
  EXPECT_EQ(allowed, 64);
  EXPECT_TRUE(limit.allows("another", kStart + kPeriod));
}

}  // namespace
}  // namespace organ_collision::node
