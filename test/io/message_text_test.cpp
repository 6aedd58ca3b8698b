#include "organ_collision/io/message_text.h"

#include <gmock/gmock.h>

#include <string>

namespace organ_collision::io {
namespace {

using testing::EndsWith;

TEST(Printable, LeavesWordsAsTheyAre) {
  EXPECT_EQ(printable("mesh 'J\u00f6rg.obj': is empty"), "mesh 'J\u00f6rg.obj': is empty");
  EXPECT_EQ(printable(""), "");
}

TEST(Printable, ShowsNothingThatATerminalWouldObey) {
  EXPECT_EQ(printable("a\x1b[2Jb\x7f\n[FATAL]\tc"), "a?[2Jb? [FATAL] c");
  EXPECT_EQ(printable(std::string("a\0b", 3)), "a?b");
}

TEST(Printable, ShortensWhatIsLong) {
  const std::string shown = printable(std::string(4'000'000, 'x'));
  EXPECT_EQ(printable(std::string(1000, 'x')), std::string(1000, 'x'));
  EXPECT_THAT(shown, EndsWith("x... (3999000 more bytes)"));
  EXPECT_LT(shown.size(), 1100U);
}

TEST(Joined, ListsNames) {
  EXPECT_EQ(joined({}), "");
  EXPECT_EQ(joined({"liver"}), "liver");
  EXPECT_EQ(joined({"liver", "kidney", "spleen"}), "liver, kidney, spleen");
}

}  // namespace
}  // namespace organ_collision::io
