#include "tools/stability_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <sstream>

#include "io/temporary_folder.h"
#include "tools/outcome.h"

namespace organ_collision::tools {
namespace {

using testing::HasSubstr;

Outcome run(const std::vector<std::string>& words, const Library& library = {}) {
  return outcomeOf(
      [&library](const auto& given, auto& out, auto& errors) {
        return measureStability(given, out, errors, library);
      },
      words);
}

class MeasureStabilityCommand : public testing::Test {
 protected:
  std::string folder(const std::string& name) const { return (folder_.path() / name).string(); }
  std::string tableOf(const std::string& name, const std::string& seed) const {
    EXPECT_EQ(run({"--output", folder(name), "--seed", seed, "--samples", "300"}).exit_code, 0);
    std::ifstream file(folder(name + "/stability.csv"));
    return {std::istreambuf_iterator<char>(file), {}};
  }

  io::TemporaryFolder folder_;
};

TEST_F(MeasureStabilityCommand, FindsEveryPromiseKept) {
  const Outcome done = run({"--output", folder("new"), "--samples", "2000"});
  EXPECT_EQ(done.exit_code, 0) << done.out;
  EXPECT_EQ(done.errors, "");
  EXPECT_THAT(done.out, HasSubstr("All promises are kept."));
  EXPECT_THAT(done.out, HasSubstr(folder("new/stability.csv")));
  EXPECT_TRUE(std::filesystem::exists(folder("new/stability.csv")));
}

TEST_F(MeasureStabilityCommand, EndsWithOneWhereAPromiseIsBroken) {
  Library wrong;
  wrong.intersect = [](const auto& /*first*/, const auto& /*second*/) { return true; };
  const Outcome done = run({"--output", folder("new"), "--samples", "100"}, wrong);
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_EQ(done.errors, "measure_stability: a promise is broken\n");
  EXPECT_THAT(done.out, HasSubstr("random, meet: "));
}

TEST_F(MeasureStabilityCommand, GivesTheSameTableForTheSameSeedOnly) {
  const std::string table = tableOf("first", "7");
  EXPECT_EQ(tableOf("second", "7"), table);
  const std::string other = tableOf("third", "8");
  EXPECT_NE(other.substr(0, other.find("\nrandom,point") + 30),
            table.substr(0, table.find("\nrandom,point") + 30));
}

TEST_F(MeasureStabilityCommand, TakesAsFewSamplesAsOneTipNeeds) {
  EXPECT_EQ(run({"--output", folder("few"), "--samples", "100"}).exit_code, 0);
}

TEST_F(MeasureStabilityCommand, ShowsHowItIsUsed) {
  const Outcome done = run({"--help"});
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_THAT(done.out, HasSubstr("usage: measure_stability [--output DIR]"));
}

TEST_F(MeasureStabilityCommand, EndsWithTwoForWrongArguments) {
  const std::vector<std::vector<std::string>> wrong = {
      {"organ.obj"},       {"--output"},     {"--speed", "3"},    {"--samples", "0"},
      {"--samples", "99"}, {"--seed", "-1"}, {"--samples", "1e5"}};
  for (const auto& words : wrong) {
    const Outcome done = run(words);
    EXPECT_EQ(done.exit_code, 2) << done.errors;
    EXPECT_EQ(done.out, "");
    EXPECT_THAT(done.errors, HasSubstr(words.front()));
    EXPECT_EQ(std::count(done.errors.begin(), done.errors.end(), '\n'), 1) << done.errors;
  }
}

TEST_F(MeasureStabilityCommand, EndsWithOneAndNamesTheFolderThatCannotBeWritten) {
  const std::string taken = folder_.write("taken", "").string();
  const Outcome done = run({"--output", taken});
  EXPECT_EQ(done.exit_code, 1);
  EXPECT_THAT(done.errors, HasSubstr("taken"));
}

}  // namespace
}  // namespace organ_collision::tools
