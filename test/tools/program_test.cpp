#include "tools/program.h"

#include <gtest/gtest.h>

#include <sstream>

#include "tools/arguments.h"

namespace organ_collision::tools {
namespace {

using Words = std::vector<std::string>;

/// What a program that does this with its words says and returns.
struct Ended {
  Ended(const Words& words, std::ostream& out, const std::function<void(const Words&)>& run)
      : status(runProgram({"name", "usage: name"}, words, out, errors, run)) {}

  std::ostringstream errors;
  int status;
};

TEST(Program, TellsItsUsageWhereItIsAskedFor) {
  std::ostringstream out;
  const Ended ended({"word", "--help"}, out, [](const Words&) { FAIL(); });
  EXPECT_EQ(ended.status, 0);
  EXPECT_EQ(out.str(), "usage: name");
}

TEST(Program, TellsWhatIsThrownAndWhetherTheWordsWereWrong) {
  std::ostringstream out;
  const Ended misused({}, out, [](const Words&) { throw UsageError("no word"); });
  EXPECT_EQ(misused.status, 2);
  EXPECT_EQ(misused.errors.str(), "name: no word; --help shows how it is used\n");
  const Ended failed({}, out, [](const Words&) { throw std::runtime_error("no luck"); });
  EXPECT_EQ(failed.status, 1);
  EXPECT_EQ(failed.errors.str(), "name: no luck\n");
}

TEST(Program, FailsWhereItsOutputIsLost) {
  std::ostringstream out;
  const Ended ended({}, out, [&](const Words&) { out.setstate(std::ios::badbit); });
  EXPECT_EQ(ended.status, 1);
  EXPECT_EQ(ended.errors.str(), "name: its output could not be written\n");
}

}  // namespace
}  // namespace organ_collision::tools
