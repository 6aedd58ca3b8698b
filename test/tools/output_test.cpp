#include "tools/output.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <iterator>

#include "io/temporary_folder.h"

namespace organ_collision::tools {
namespace {

using io::messageOf;
using io::TemporaryFolder;
using testing::HasSubstr;

TEST(Significant, KeepsSoManyDigitsAndNoZerosBehind) {
  EXPECT_EQ(significant(0.0012345), "0.00123");
  EXPECT_EQ(significant(1.0), "1");
  EXPECT_EQ(significant(1.0 / 3.0, 9), "0.333333333");
}

TEST(Fixed, KeepsSoManyDecimals) {
  EXPECT_EQ(fixed(1.25, 1), "1.2");
  EXPECT_EQ(fixed(2.0, 2), "2.00");
  EXPECT_EQ(fixed(1e300, 0).size(), 301U);
}

TEST(Aligned, PutsTheFirstCellToTheLeftAndTheOthersToTheRight) {
  EXPECT_EQ(aligned({"ab", "1", "23"}, {4, 3, 3}), "ab    1 23\n");
  EXPECT_EQ(aligned({"abc", "1234"}, {2, 3}), "abc1234\n");
}

TEST(CsvLine, QuotesOnlyWhatNeedsIt) {
  EXPECT_EQ(csvLine({"a", "1 mm", ""}), "a,1 mm,\n");
  EXPECT_EQ(csvLine({"", "b"}), ",b\n");
  EXPECT_EQ(csvLine({"a,b", "say \"no\"", "two\nlines"}),
            "\"a,b\",\"say \"\"no\"\"\",\"two\nlines\"\n");
}

TEST(RequireWritableFolder, MakesFoldersThatAreNotThere) {
  const TemporaryFolder folder;
  requireWritableFolder(folder.path() / "a" / "b");
  EXPECT_TRUE(std::filesystem::is_directory(folder.path() / "a" / "b"));
}

TEST(RequireWritableFolder, RefusesAFileInTheWay) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.write("file", "");
  EXPECT_THAT(messageOf([&] { requireWritableFolder(file); }), HasSubstr(file.string()));
  EXPECT_THAT(messageOf([&] { requireWritableFolder(file / "below"); }), HasSubstr(file.string()));
}

TEST(WriteFile, WritesWhatItIsGiven) {
  const TemporaryFolder folder;
  writeFile(folder.path() / "text", "one\ntwo");
  std::ifstream stream(folder.path() / "text");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(stream), {}), "one\ntwo");
}

TEST(WriteFile, NamesTheFileThatCannotBeWritten) {
  const TemporaryFolder folder;
  EXPECT_THAT(messageOf([&] { writeFile(folder.path() / "none" / "text", "one"); }),
              HasSubstr("none/text': cannot write"));
}

}  // namespace
}  // namespace organ_collision::tools
