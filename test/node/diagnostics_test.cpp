#include "node/diagnostics.h"

#include <gtest/gtest.h>

namespace organ_collision::node {
namespace {

using diagnostic_msgs::DiagnosticStatus;

TEST(Diagnostics, TellThatContactsNoLongerFlow) {
  Cycle last;
  const ros::SteadyTime start(100.0);
  EXPECT_EQ(flowOf(last, start).level, DiagnosticStatus::WARN);
  last.published = start;
  EXPECT_EQ(flowOf(last, start + ros::WallDuration(0.9)).level, DiagnosticStatus::OK);
  const DiagnosticStatus silent = flowOf(last, start + ros::WallDuration(2.5));
  EXPECT_EQ(silent.level, DiagnosticStatus::ERROR);
  EXPECT_EQ(silent.message, "no contacts for 2.500000 s");
}

}  // namespace
}  // namespace organ_collision::node
