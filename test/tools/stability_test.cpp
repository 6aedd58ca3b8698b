#include "tools/stability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <utility>

namespace organ_collision::tools {
namespace {

using core::exact::Real;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Extreme named(const std::string& name) {
  for (const Extreme& extreme : extremes()) {
    if (extreme.name == name) return extreme;
  }
  throw std::out_of_range(name);
}

StabilityRow measured(const Extreme& extreme, std::size_t samples = 1000,
                      const Library& library = {}) {
  return measureStability(
      extreme, Trials(samples), 1, [] {}, library);
}

/// The subjects of which a promise is broken if the library is such.
std::vector<Subject> brokenBy(const Library& library) {
  const StabilityRow row = measured(named("random"), 1000, library);
  std::vector<Subject> broken;
  for (const SubjectName& subject : kSubjects)
    if (!row[subject.subject].isKept()) broken.push_back(subject.subject);
  return broken;
}

/// With `spoil` done to answers.
Library withWrongNearest(const std::function<void(const core::CollisionMesh&, const core::Accuracy&,
                                                  core::NearestTriangle&)>& spoil) {
  Library library;
  library.nearest_triangle = [spoil](const auto& organ, const auto& tip, const auto& accuracy) {
    core::NearestTriangle answer = core::nearestTriangle(organ, tip, accuracy);
    spoil(organ, accuracy, answer);
    return answer;
  };
  return library;
}

TEST(ErrorOf, IsInUnitsOfHalfAnUlpOfTheExtent) {
  EXPECT_EQ(errorOf(1.0, Real(1), 8.0), 0.0);
  EXPECT_EQ(errorOf(1.0 + 0x1p-52, Real(1), 1.0), 2.0);
  EXPECT_EQ(errorOf(1.0, Real(1) + Real(0x1p-60), 0x1p-7), 1.0);
  EXPECT_EQ(errorOf(0.0, Real(0), 0.0), 0.0);
  EXPECT_EQ(errorOf(1.0, Real(0), 0.0), std::numeric_limits<double>::infinity());
}

TEST(ExtentOf, IsTheLongestVectorToACorner) {
  const core::Triangle t{{0, 0, 0}, {3, 4, 0}, {1, 0, 0}};
  EXPECT_EQ(extentOf({0, 0, 0}, t), 5.0);
  EXPECT_EQ(extentOf({3, 4, 12}, t), 13.0);
  EXPECT_EQ(extentOf(t, {{0, 0, 0}, {0, 0, 1}, {0, 0, 2}}), std::sqrt(29.0));
  EXPECT_EQ(extentOf({1e200, 0, 0}, t), 1e200);
}

TEST(Tally, IsKeptWithoutAWrongANonFiniteAndAnErrorAboveFour) {
  EXPECT_TRUE((Tally{10, 4.0, 0, 0}.isKept()));
  EXPECT_FALSE((Tally{10, 4.1, 0, 0}.isKept()));
  EXPECT_FALSE((Tally{10, 0.0, 1, 0}.isKept()));
  EXPECT_FALSE((Tally{10, 0.0, 0, 1}.isKept()));
}

TEST(MeasureStability, TriesAllSubjectsOfAllClasses) {
  const StabilityRow row = measured(named("random"));
  EXPECT_EQ(row[Subject::kClosestPoint].trials, 1000U);
  EXPECT_EQ(row[Subject::kTriangleDistance].trials, 100U);
  EXPECT_EQ(row[Subject::kIntersection].trials, 100U);
  EXPECT_EQ(row[Subject::kNearest].trials, 10U);
  EXPECT_EQ(row[Subject::kRefit].trials, 10U);
  EXPECT_EQ(row[Subject::kSign].trials, 10U);
  EXPECT_EQ(row[Subject::kDial].trials, 140U);
  EXPECT_EQ(row[Subject::kScaling].trials, 2 * 1010U);
  EXPECT_EQ(row[Subject::kRenumbering].trials, 10U);
  for (const Subject subject :
       {Subject::kClosestPoint, Subject::kTriangleDistance, Subject::kNearest, Subject::kRefit})
    EXPECT_GT(row[subject].worst, 0.0);
}

TEST(MeasureStability, SeesNoSidesOfAnOpenOrgan) {
  const StabilityRow row = measured(named("one triangle"));
  EXPECT_EQ(row[Subject::kSign].trials, 0U);
  EXPECT_EQ(row[Subject::kClosestPoint].trials, 0U);
  EXPECT_EQ(row[Subject::kNearest].trials, 10U);
}

TEST(MeasureStability, CountsAnErrorThatIsTooLarge) {
  Extreme underflow = named("random");  // squares of such lengths are 0: beyond what is promised
  underflow.sample = [](Extreme::Random&) {
    return core::Sample{{0, 0, 0x1p-600}, {{0, 0, 0}, {0x1p-600, 0, 0}, {0, 0x1p-600, 0}}};
  };
  const StabilityRow row = measured(underflow);
  EXPECT_FALSE(row[Subject::kClosestPoint].isKept());
  EXPECT_FALSE(row[Subject::kScaling].isKept());
  EXPECT_TRUE(row[Subject::kTriangleDistance].isKept());
}

TEST(MeasureStability, SeesWrongMeasurementsOfTriangles) {
  EXPECT_THAT(brokenBy({}), IsEmpty());
  Library library;
  library.closest_point = [](const auto& query, const auto& triangle) {
    core::ClosestPoint closest = closestPointOnTriangle(query, triangle);
    closest.squared_distance *= 1 + 0x1p-40;
    return closest;
  };
  EXPECT_THAT(brokenBy(library), ElementsAre(Subject::kClosestPoint));
  library = {};
  library.closest_point = [](const auto& query, const auto& triangle) {
    core::ClosestPoint closest = closestPointOnTriangle(query, triangle);
    closest.squared_distance = kNan;
    return closest;
  };
  EXPECT_THAT(brokenBy(library), Contains(Subject::kClosestPoint));
  library = {};
  library.closest_points = [](const auto& first, const auto& second) {
    core::ClosestPair pair = closestPoints(first, second);
    pair.point_on_first.x() = kNan;
    return pair;
  };
  EXPECT_THAT(brokenBy(library), ElementsAre(Subject::kTriangleDistance));
  library = {};
  library.intersect = [](const auto& /*first*/, const auto& /*second*/) { return false; };
  EXPECT_THAT(brokenBy(library), ElementsAre(Subject::kIntersection));
}

TEST(MeasureStability, SeesWrongNearestTriangles) {
  const auto is_exact = [](const core::Accuracy& accuracy) {
    return accuracy.max_leaves == 0 && accuracy.max_relative_error == 0 &&
           accuracy.max_absolute_error == 0;
  };
  const auto turned = [](const auto& /*organ*/, const auto& /*accuracy*/, auto& answer) {
    answer.distance = -answer.distance;
    std::swap(answer.lower_bound, answer.upper_bound);
    answer.lower_bound = -answer.lower_bound;
    answer.upper_bound = -answer.upper_bound;
  };
  EXPECT_THAT(brokenBy(withWrongNearest(turned)), ElementsAre(Subject::kSign, Subject::kDial));
  const auto unsure = [](const auto& /*organ*/, const auto& accuracy, auto& answer) {
    if (accuracy.max_leaves == 1) answer.upper_bound = answer.lower_bound;
  };
  EXPECT_THAT(brokenBy(withWrongNearest(unsure)), Contains(Subject::kDial));
  const auto infinite = [&](const auto& /*organ*/, const auto& accuracy, auto& answer) {
    if (is_exact(accuracy)) answer.normal.x() = kNan;
  };
  EXPECT_THAT(brokenBy(withWrongNearest(infinite)), Contains(Subject::kNearest));
  const auto scaled = [](const auto& organ, const auto& /*accuracy*/, auto& answer) {
    if (organ.health().box.high.norm() < 0x1p-32) answer.closest.barycentric.x() += 0x1p-52;
  };
  EXPECT_THAT(brokenBy(withWrongNearest(scaled)), ElementsAre(Subject::kScaling));
  // The first organ that is asked is the one built; the next is refitted.
  std::map<const core::CollisionMesh*, int> organs;
  const auto differs_in = [&organs](int guise) {
    return [&organs, guise](const auto& organ, const auto& accuracy, auto& answer) {
      const int number = organs.emplace(&organ, static_cast<int>(organs.size())).first->second;
      if (number == guise && accuracy.max_leaves == 0) answer.distance *= 1 + 0x1p-52;
    };
  };
  EXPECT_THAT(brokenBy(withWrongNearest(differs_in(1))), ElementsAre(Subject::kRefit));
  organs.clear();
  EXPECT_THAT(brokenBy(withWrongNearest(differs_in(4))), ElementsAre(Subject::kRenumbering));
}

TEST(MeasureStability, AdvancesWithEveryTip) {
  int advanced = 0;
  measureStability(named("random"), Trials(500), 1, [&advanced] { ++advanced; });
  EXPECT_EQ(advanced, 5);
}

}  // namespace
}  // namespace organ_collision::tools
