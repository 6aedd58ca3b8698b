#include "node/update_policy.h"

#include <gmock/gmock.h>

#include <vector>

namespace organ_collision::node {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kMicrosecond = 1e-6;  // [s]

TEST(RefitPolicy, TriesEverySizeOfAPartialRefitOnce) {
  RefitPolicy policy(1000 * kMicrosecond);
  EXPECT_TRUE(policy.prefersPartial(200));
  policy.recordPartial(200, 1500 * kMicrosecond);
  EXPECT_FALSE(policy.prefersPartial(200));
  EXPECT_FALSE(policy.prefersPartial(255)) << "the same power of two";
  EXPECT_TRUE(policy.prefersPartial(256));
  EXPECT_TRUE(policy.prefersPartial(100));
}

TEST(RefitPolicy, GoesByWhatBothHaveCost) {
  RefitPolicy policy(1000 * kMicrosecond);
  policy.recordPartial(200, 900 * kMicrosecond);
  EXPECT_TRUE(policy.prefersPartial(200));
  EXPECT_FALSE(policy.prefersPartial(250)) << "1125 us at 4.5 us each";
  policy.recordFull(200, 800 * kMicrosecond);
  EXPECT_FALSE(policy.prefersPartial(200));
  EXPECT_THAT(policy.figures(200),
              HasSubstr("partial refit costs about 900 us, a full one 800 us"));
}

TEST(RefitPolicy, IsNotMisledByAFullRefitThatWasDisturbed) {
  RefitPolicy policy(1000 * kMicrosecond);
  policy.recordPartial(200, 1500 * kMicrosecond);
  policy.recordFull(200, 90000 * kMicrosecond);
  EXPECT_FALSE(policy.prefersPartial(200));
}

TEST(RefitPolicy, GivesThePartialRefitAnotherChanceAfterAWhile) {
  RefitPolicy policy(1000 * kMicrosecond);
  policy.recordPartial(200, 90000 * kMicrosecond);  // disturbed
  int refits = 0;
  for (; !policy.prefersPartial(200); ++refits) {
    ASSERT_THAT(policy.figures(200), Not(HasSubstr("again")));
    policy.recordFull(200, 1000 * kMicrosecond);
  }
  EXPECT_THAT(policy.figures(200), HasSubstr("90000 us and is tried again, a full one 1000 us"));
  EXPECT_GE(refits, 20) << "else trying costs more than it can gain";
  EXPECT_LE(refits, 200);
  policy.recordPartial(200, 300 * kMicrosecond);
  EXPECT_TRUE(policy.prefersPartial(200));
}

TEST(RefitPolicy, KnowsSizesFromOneVertexToMoreThanThereAre) {
  RefitPolicy policy(1.0);
  for (const std::size_t moved : {std::size_t{1}, std::size_t{1} << 31, ~std::size_t{0}}) {
    policy.recordPartial(moved, 2.0);
    EXPECT_FALSE(policy.prefersPartial(moved));
  }
}

TEST(RebuildPolicy, RebuildsWhenQueriesHaveLostMoreThanARebuildCosts) {
  RebuildPolicy policy(0.015);
  const Wear wear = {2.0, 0.0, 10 * kMicrosecond, 30 * kMicrosecond};  // half of 10 us is lost
  policy.recordQueries(2000, wear);
  EXPECT_NEAR(policy.lost(), 0.010, 1e-12);
  EXPECT_FALSE(policy.isDue());
  policy.recordQueries(2000, wear);
  EXPECT_TRUE(policy.isDue());
  policy.recordRebuild(0.02);
  EXPECT_FALSE(policy.isDue());
  EXPECT_EQ(policy.lost(), 0.0);
  EXPECT_EQ(policy.cost(), 0.02);
}

TEST(RebuildPolicy, NeverRebuildsWhatAnswersAsWellAsNewOrWhatNobodyAsks) {
  RebuildPolicy policy(0.001);
  policy.recordQueries(1000000, {1.0, 0.0, 1.0, 1.0});
  policy.recordQueries(1000000, {0.8, -0.1, 1.0, 1.0});
  policy.recordQueries(0, {100.0, 1.0, 1.0, 1.0});
  EXPECT_FALSE(policy.isDue());
  EXPECT_EQ(policy.lost(), 0.0);
}

TEST(RebuildPolicy, ChargesAGreedyAnswerThatHasBecomeWrongTheExactSearchThatMendsIt) {
  RebuildPolicy policy(0.015);
  const Wear wear = {1.0, 0.25, 1 * kMicrosecond, 20 * kMicrosecond};  // 5 us a query
  policy.recordQueries(2900, wear);
  EXPECT_FALSE(policy.isDue());
  policy.recordQueries(200, wear);
  EXPECT_TRUE(policy.isDue());
  EXPECT_THAT(policy.figures(), HasSubstr("15.5 ms"));
  EXPECT_THAT(policy.figures(), HasSubstr("1.00 times the work, 25 % more answers wrong"));
}

// What benchmark/update_figures logged: the shipped liver and the same with sixteen times the
// triangles, both twisted, asked greedily.
constexpr double kCoarseRebuild = 11787 * kMicrosecond;
constexpr Wear kCoarseWear = {0.99, 0.301, 1.12 * kMicrosecond, 3.20 * kMicrosecond};
constexpr double kFineRebuild = 272284 * kMicrosecond;
constexpr Wear kFineWear = {0.99, 0.361, 3.14 * kMicrosecond, 17.12 * kMicrosecond};

/// A rule that went by the wear alone would rebuild the fine one whenever it rebuilds the coarse
/// one.
TEST(RebuildPolicy, RebuildsTheCoarseOrganBeforeTheFineOneThatIsMoreWorn) {
  RebuildPolicy coarse(kCoarseRebuild);
  RebuildPolicy fine(kFineRebuild);
  ASSERT_GE(kFineWear.newly_wrong, kCoarseWear.newly_wrong);
  ASSERT_GE(kFineWear.work_ratio, kCoarseWear.work_ratio);
  coarse.recordQueries(20000, kCoarseWear);
  fine.recordQueries(20000, kFineWear);
  EXPECT_TRUE(coarse.isDue());
  EXPECT_FALSE(fine.isDue());
}

/// And one that went by the queries alone would rebuild an organ that does not need it.
TEST(RebuildPolicy, DoesNotRebuildForAsManyQueriesWhereTheWearIsLess) {
  RebuildPolicy worn(kCoarseRebuild);
  RebuildPolicy hardly_worn(kCoarseRebuild);
  Wear little = kCoarseWear;
  little.newly_wrong = 0.01;
  worn.recordQueries(20000, kCoarseWear);
  hardly_worn.recordQueries(20000, little);
  EXPECT_TRUE(worn.isDue());
  EXPECT_FALSE(hardly_worn.isDue());
}

TEST(RefitPolicy, ChoosesDifferentlyForTheSameShareOfTwoOrgans) {
  RefitPolicy flat_tree(1000 * kMicrosecond);
  RefitPolicy deep_tree(1000 * kMicrosecond);
  flat_tree.recordPartial(500, 600 * kMicrosecond);
  deep_tree.recordPartial(500, 1600 * kMicrosecond);
  EXPECT_TRUE(flat_tree.prefersPartial(500));
  EXPECT_FALSE(deep_tree.prefersPartial(500));
}

}  // namespace
}  // namespace organ_collision::node
