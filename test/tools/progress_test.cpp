#include "tools/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace organ_collision::tools {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A clock that the test moves.
struct Watch {
  std::chrono::steady_clock::time_point now;
  Progress::Clock clock() {
    return [this] { return now; };
  }
};

TEST(Progress, WritesALineForEveryTenthWhereThereIsNoTerminal) {
  Watch watch;
  std::ostringstream out;
  {
    Progress progress("measuring", 200, out, false, watch.clock());
    for (int i = 0; i < 200; ++i) progress.advance();
  }
  const std::string text = out.str();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 10);
  EXPECT_THAT(text, HasSubstr("measuring 10 %, 0 s left\n"));
  EXPECT_THAT(text, HasSubstr("measuring 100 %, 0 s left\n"));
  EXPECT_THAT(text, Not(HasSubstr("\r")));
}

TEST(Progress, TellsTheTimeLeftFromThePaceSoFar) {
  Watch watch;
  std::ostringstream out;
  Progress progress("measuring", 10, out, false, watch.clock());
  watch.now += std::chrono::seconds(6);
  progress.advance(2);
  EXPECT_EQ(out.str(), "measuring 20 %, 24 s left\n");
}

TEST(Progress, RedrawsOneLineOnATerminalAndEndsIt) {
  Watch watch;
  std::ostringstream out;
  {
    Progress progress("measuring", 4, out, true, watch.clock());
    progress.advance(2);
    progress.advance(2);
  }
  EXPECT_THAT(out.str(), HasSubstr("\rmeasuring [###############...............] 50 %"));
  EXPECT_THAT(out.str(), HasSubstr("\rmeasuring [##############################] 100 %"));
  EXPECT_EQ(out.str().find('\n'), out.str().size() - 1);
}

TEST(Progress, IsSilentWhereNothingIsDone) {
  Watch watch;
  std::ostringstream out;
  { Progress progress("measuring", 0, out, true, watch.clock()); }
  EXPECT_EQ(out.str(), "");
}

}  // namespace
}  // namespace organ_collision::tools
