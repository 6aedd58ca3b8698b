#include "tools/trade_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

#include "io/temporary_folder.h"
#include "tools/outcome.h"
#include "tools/trade.h"

namespace organ_collision::tools {
namespace {

using io::TemporaryFolder;
using testing::HasSubstr;

constexpr const char* kTetrahedron =
    "v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nv 0 0 0.1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

Outcome run(const std::vector<std::string>& words) { return outcomeOf(measureTrade, words); }

/// The rows of a CSV file without quotes.
std::vector<std::vector<std::string>> rowsOf(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::vector<std::vector<std::string>> rows;
  for (std::string line; std::getline(stream, line);) {
    std::istringstream fields(line);
    rows.emplace_back();
    for (std::string field; std::getline(fields, field, ',');) rows.back().push_back(field);
  }
  return rows;
}

/// A run of an own mesh in its own folder.
class MeasureTrade : public testing::Test {
 protected:
  std::string mesh(const std::string& text = kTetrahedron) const {
    return folder_.write("organ.obj", text).string();
  }
  std::string folder(const std::string& name = "") const {
    return (folder_.path() / name).string();
  }

  TemporaryFolder folder_;
};

TEST_F(MeasureTrade, PrintsAReportAndWritesTableAndPlot) {
  const Outcome done = run({mesh(), "--output", folder("new"), "--queries", "20"});
  EXPECT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_EQ(done.errors, "");
  EXPECT_THAT(done.out, HasSubstr("organ.obj: 4 triangles"));
  EXPECT_THAT(done.out, HasSubstr("Times: of each tip the least of 3 rounds."));
  EXPECT_THAT(done.out, HasSubstr("0 violations"));
  EXPECT_THAT(done.out, HasSubstr("for an error below 0.1 mm on this mesh: "));
  EXPECT_EQ(rowsOf(folder("new/trade.csv")).size(), 1 + 5 * dial().size());
  EXPECT_TRUE(std::filesystem::exists(folder("new/trade.svg")));
}

TEST_F(MeasureTrade, GivesTheSameCountsAndErrorsForTheSameSeed) {
  const std::string organ = std::string(MESHES) + "/liver.obj";
  for (const char* name : {"first", "second"}) {
    ASSERT_EQ(run({organ, "--output", folder(name), "--queries", "100", "--seed", "3"}).exit_code,
              0);
  }
  const auto first = rowsOf(folder("first/trade.csv"));
  const auto second = rowsOf(folder("second/trade.csv"));
  ASSERT_EQ(first.size(), second.size());
  std::size_t compared = 0;
  for (std::size_t column = 0; column < first[0].size(); ++column) {
    const std::string& name = first[0][column];
    if (name.find("[us]") != std::string::npos || name.find("[ms]") != std::string::npos) continue;
    for (std::size_t row = 0; row < first.size(); ++row) {
      EXPECT_EQ(first[row][column], second[row][column]) << name;
    }
    ++compared;
  }
  EXPECT_EQ(compared, first[0].size() - 5);
}

TEST_F(MeasureTrade, GivesOtherErrorsForAnotherSeed) {
  const std::string organ = std::string(MESHES) + "/liver.obj";
  run({organ, "--output", folder("first"), "--queries", "100", "--seed", "3"});
  run({organ, "--output", folder("second"), "--queries", "100", "--seed", "4"});
  const auto first = rowsOf(folder("first/trade.csv"));
  const auto second = rowsOf(folder("second/trade.csv"));
  ASSERT_EQ(first[0][13], "error mean [mm]");
  EXPECT_NE(first[1][13], second[1][13]);
}

TEST_F(MeasureTrade, MeasuresTheUsersOwnTips) {
  const std::string tips = folder_.write("tips.csv", "x,y,z\n0.1,0.1,0.1\n0.2,0,0\n").string();
  const Outcome done = run({mesh(), "--output", folder(), "--queries", "5", "--tips", tips});
  EXPECT_EQ(done.exit_code, 0) << done.errors;
  EXPECT_THAT(done.out, HasSubstr("tips of " + tips + ": 2 tips"));
  EXPECT_EQ(rowsOf(folder("trade.csv")).size(), 1 + 6 * dial().size());
}

TEST_F(MeasureTrade, HasNoConfidenceInAPathHoweverManyTipsItHas) {
  std::string path;
  for (int i = 0; i < 3000; ++i) path += "0.1,0.1,0.1\n";  // enough for 99.9 % if each were drawn
  const std::string tips = folder_.write("tips.csv", path).string();
  const Outcome done = run({mesh(), "--output", folder(), "--queries", "5", "--tips", tips});
  EXPECT_THAT(done.out, HasSubstr("for an error below 0.01 mm on these tips: "));
  const auto rows = rowsOf(folder("trade.csv"));
  for (std::size_t column = 0; column < rows[0].size(); ++column) {
    if (rows[0][column].find("(95 %)") == std::string::npos) continue;
    EXPECT_NE(rows[1][column], "") << rows[0][column];
    EXPECT_EQ(rows.back()[column], "") << rows[0][column];
  }
}

TEST_F(MeasureTrade, SaysThatNothingIsInsideAnOpenMesh) {
  const Outcome done = run(
      {mesh("v 0 0 0\nv 0.1 0 0\nv 0 0.1 0\nf 1 2 3\n"), "--output", folder(), "--queries", "5"});
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_THAT(done.out, HasSubstr("inside: no tips"));
}

TEST_F(MeasureTrade, ScalesTheMesh) {
  const Outcome done =
      run({mesh("v 0 0 0\nv 100 0 0\nv 0 100 0\nv 0 0 100\nf 1 3 2\nf 1 2 4\nf 1 4 3\n"
                "f 2 3 4\n"),
           "--output", folder(), "--queries", "5", "--scale", "0.001"});
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_EQ(done.errors, "") << "100 m would be warned of";
}

TEST_F(MeasureTrade, ShowsHowItIsUsed) {
  const Outcome done = run({"--help"});
  EXPECT_EQ(done.exit_code, 0);
  EXPECT_THAT(done.out, HasSubstr("usage: measure_trade MESH [--output DIR]"));
}

TEST_F(MeasureTrade, EndsWithTwoForWrongArguments) {
  const std::vector<std::vector<std::string>> wrong = {{},
                                                       {"a.obj", "b.obj"},
                                                       {"a.obj", "--speed", "3"},
                                                       {"a.obj", "--output"},
                                                       {"a.obj", "--scale", "-1"},
                                                       {"a.obj", "--queries", "0"},
                                                       {"a.obj", "--queries", "10000001"},
                                                       {"a.obj", "--seed", "x"}};
  for (const auto& words : wrong) {
    const Outcome done = run(words);
    EXPECT_EQ(done.exit_code, 2) << done.errors;
    EXPECT_EQ(done.out, "");
    EXPECT_EQ(std::count(done.errors.begin(), done.errors.end(), '\n'), 1) << done.errors;
  }
}

TEST_F(MeasureTrade, EndsWithOneAndNamesTheFileThatCannotBeUsed) {
  const std::string empty = folder_.write("empty.obj", "").string();
  const std::string broken = folder_.write("broken.obj", "v 0 0 0\nf 1 2 3\n").string();
  const std::string bad_tips = folder_.write("tips.csv", "1,2\n").string();
  const std::string taken = folder_.write("taken", "").string();
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{folder("none.obj")}, "none.obj"},
      {{folder()}, folder_.path().filename().string()},
      {{empty}, "empty.obj"},
      {{broken}, "broken.obj"},
      {{"package://no_such_package/organ.obj"}, "no_such_package"},
      {{mesh(), "--tips", bad_tips}, "tips.csv:1"},
      {{mesh(), "--tips", folder("none.csv")}, "none.csv"},
      {{mesh(), "--output", taken}, "taken"}};
  for (auto [words, named] : cases) {
    if (words.size() < 3) words.insert(words.end(), {"--output", folder()});
    const Outcome done = run(words);
    EXPECT_EQ(done.exit_code, 1) << named;
    EXPECT_THAT(done.errors, HasSubstr(named));
    EXPECT_EQ(std::count(done.errors.begin(), done.errors.end(), '\n'), 1) << done.errors;
  }
}

}  // namespace
}  // namespace organ_collision::tools
