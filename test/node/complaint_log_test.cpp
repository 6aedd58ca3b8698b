#include "node/complaint_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <vector>

namespace organ_collision::node {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(ComplaintLog, TellsPairsWithTheSameReasonInOneLineWhenItHasLasted) {
  const std::vector<Complaint> complaints = {{"left", "liver", "tf is silent"},
                                             {"right", "liver", "tf is silent"},
                                             {"left", "stomach", "tf is late"}};
  const auto written = [&](ComplaintLog& log) {
    testing::internal::CaptureStderr();
    log.write(complaints);
    return testing::internal::GetCapturedStderr();
  };
  ComplaintLog log;
  EXPECT_EQ(written(log), "");
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  EXPECT_THAT(written(log), AllOf(HasSubstr("left to liver, right to liver: tf is silent"),
                                  HasSubstr("left to stomach: tf is late")));
  EXPECT_EQ(written(log), "") << "again after a while only";
}

}  // namespace
}  // namespace organ_collision::node
