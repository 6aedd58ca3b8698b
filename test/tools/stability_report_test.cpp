#include "tools/stability_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sstream>

namespace organ_collision::tools {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A class in which all is well but for no sign that is told.
StabilityRow rowOf(const std::string& name) {
  StabilityRow row{name, {}, 7};
  for (Tally& tally : row.tallies) tally.trials = 100;
  row[Subject::kSign].trials = 0;
  row[Subject::kClosestPoint].worst = 2.345;
  return row;
}

Stability stabilityOf(const std::vector<StabilityRow>& rows) { return {1000, 5, rows}; }

TEST(BrokenPromises, AreNoneWhereAllIsWell) {
  EXPECT_THAT(brokenPromises(stabilityOf({rowOf("needles"), rowOf("caps")})), IsEmpty());
}

TEST(BrokenPromises, NameClassAndSubject) {
  StabilityRow needles = rowOf("needles");
  needles[Subject::kRefit].worst = 4.5;
  needles[Subject::kDial].wrong = 3;
  StabilityRow caps = rowOf("caps");
  caps[Subject::kIntersection].not_finite = 1;
  EXPECT_THAT(brokenPromises(stabilityOf({needles, caps})),
              ElementsAre("needles, refit: 4.5 u*extent, 0 not finite, 0 wrong of 100",
                          "needles, dial: 0 u*extent, 0 not finite, 3 wrong of 100",
                          "caps, meet: 0 u*extent, 1 not finite, 0 wrong of 100"));
}

TEST(StabilityReport, HasALineForEachClass) {
  const std::string text = report(stabilityOf({rowOf("needles")}));
  EXPECT_THAT(text, HasSubstr("1000 points and triangles, 100 pairs of triangles, 10 tips"));
  EXPECT_THAT(text, HasSubstr("seed 5"));
  EXPECT_THAT(text, HasSubstr("needles                      2.35       0.00   0.00   0.00      0"
                              "      -      0      0      0      0      7\n"));
  EXPECT_THAT(text, HasSubstr("All promises are kept."));
  EXPECT_THAT(text, Not(HasSubstr("BROKEN")));
}

TEST(StabilityReport, SaysWhatIsBroken) {
  StabilityRow needles = rowOf("needles");
  needles[Subject::kScaling].wrong = 3;
  needles[Subject::kNearest].not_finite = 2;
  const std::string text = report(stabilityOf({needles}));
  EXPECT_THAT(text, HasSubstr("BROKEN: needles, scaled: 0 u*extent, 0 not finite, 3 wrong of 100"));
  EXPECT_THAT(text, HasSubstr("      3      0      2      7\n"));
  EXPECT_THAT(text, Not(HasSubstr("All promises")));
}

TEST(StabilityReport, FitsATerminal) {
  std::istringstream text(report(stabilityOf({rowOf("on vertices, edges, faces")})));
  for (std::string line; std::getline(text, line);) EXPECT_LE(line.size(), 110U) << line;
}

TEST(StabilityCsv, HasALineForEachSubjectThatWasTried) {
  const std::string text = csv(stabilityOf({rowOf("needles")}));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1 + 8);
  EXPECT_THAT(text, HasSubstr("needles,point,100,2.3450000000000002,0,0,7,1000,5\n"));
  EXPECT_THAT(text, HasSubstr("needles,dial,100,,0,0,7,1000,5\n"));
  EXPECT_THAT(text, Not(HasSubstr("sign")));
}

}  // namespace
}  // namespace organ_collision::tools
