#include "tools/arguments.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "io/temporary_folder.h"

namespace organ_collision::tools {
namespace {

using testing::ElementsAre;

Arguments parsed(const std::vector<std::string>& words) {
  return {words, {"--seed", "--scale", "--output"}};
}

TEST(Arguments, TellsWordsFromOptions) {
  const Arguments arguments = parsed({"a", "--seed", "7", "b", "--output=c=d"});
  EXPECT_THAT(arguments.words(), ElementsAre("a", "b"));
  EXPECT_EQ(arguments.whole("--seed", 1), 7U);
  EXPECT_EQ(arguments.option("--output"), "c=d");
  EXPECT_EQ(arguments.option("--scale"), std::nullopt);
}

TEST(Arguments, TakesADashAloneForAWord) { EXPECT_THAT(parsed({"-"}).words(), ElementsAre("-")); }

TEST(Arguments, FallsBackWhereAnOptionIsNotGiven) {
  EXPECT_EQ(parsed({}).whole("--seed", 3), 3U);
  EXPECT_EQ(parsed({}).aboveZero("--scale", 0.5), 0.5);
}

TEST(Arguments, RefusesAnUnknownOption) {
  EXPECT_THROW(parsed({"--sed", "7"}), UsageError);
  EXPECT_THROW(parsed({"-s"}), UsageError);
}

TEST(Arguments, RefusesAnOptionWithoutAValue) { EXPECT_THROW(parsed({"--seed"}), UsageError); }

TEST(Arguments, RefusesAnOptionGivenTwice) {
  EXPECT_THROW(parsed({"--seed", "1", "--seed=2"}), UsageError);
}

TEST(Arguments, RefusesNumbersThatAreNotAboveZero) {
  for (const char* value : {"0", "-1", "nan", "inf", "1e999", "1m", "", "m"}) {
    EXPECT_THROW(parsed({"--scale", value}).aboveZero("--scale", 1.0), UsageError) << value;
  }
  EXPECT_EQ(parsed({"--scale", "0.001"}).aboveZero("--scale", 1.0), 0.001);
}

TEST(Arguments, RefusesNumbersThatAreNotWhole) {
  for (const char* value : {"-1", "1.5", "1e3", "", "99999999999999999999", " 1"}) {
    EXPECT_THROW(parsed({"--seed", value}).whole("--seed", 1), UsageError) << value;
  }
  EXPECT_EQ(parsed({"--seed", "0"}).whole("--seed", 1), 0U);
}

TEST(Arguments, DoNotTakeAnOptionForAValue) {
  EXPECT_THROW(parsed({"--scale", "--seed=7"}), UsageError);
  EXPECT_EQ(parsed({"--scale=--seed"}).option("--scale"), "--seed");
}

TEST(FindPackage, ReturnsWhereLinksGoRound) {
  const io::TemporaryFolder folder;
  for (const char* const name : {"a", "b", "c", "d", "e", "f", "g", "h"}) {
    folder.write(std::string(name) + "/readme", "");
    std::filesystem::create_directory_symlink("..", folder.path() / name / "up");
  }
  folder.write("h/liver/package.xml", "<package><name>liver</name></package>");
  ::setenv("ROS_PACKAGE_PATH", folder.path().c_str(), 1);
  EXPECT_EQ(findPackage("stomach"), std::nullopt);
  const std::optional<std::filesystem::path> liver = findPackage("liver");
  ASSERT_TRUE(liver);
  EXPECT_EQ(std::filesystem::canonical(*liver), folder.path() / "h/liver");
  ::unsetenv("ROS_PACKAGE_PATH");
}

TEST(FindPackage, LooksInAndBelowTheFoldersOfThePackagePath) {
  const io::TemporaryFolder folder;
  const auto add_package = [&](const std::string& place, const std::string& name) {
    folder.write(place + "/package.xml", "<package><name> " + name + "</name></package>");
  };
  add_package("source/repository/any_name", "liver");
  add_package("source/repository/any_name/in_it", "hidden");
  add_package("source/ignored/spleen", "spleen");
  folder.write("source/ignored/CATKIN_IGNORE", "");
  add_package("other/stomach", "stomach");
  folder.write("source/no_package/readme", "");
  const std::string path =
      (folder.path() / "source").string() + ":" + (folder.path() / "other/stomach").string();
  ::setenv("ROS_PACKAGE_PATH", path.c_str(), 1);
  EXPECT_EQ(findPackage("liver"), folder.path() / "source/repository/any_name");
  EXPECT_EQ(findPackage("stomach"), folder.path() / "other/stomach");
  for (const char* const name : {"no_package", "any_name", "hidden", "spleen"})
    EXPECT_EQ(findPackage(name), std::nullopt) << name;
  ::unsetenv("ROS_PACKAGE_PATH");
  EXPECT_EQ(findPackage("liver"), std::nullopt);
}

}  // namespace
}  // namespace organ_collision::tools
