#include "node/wear.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "node/stopwatch.h"
#include "test_meshes.h"

namespace organ_collision::node {
namespace {

using core::Accuracy;
using core::CollisionMesh;
using core::Points;

std::vector<Question> questionsNear(const CollisionMesh& organ, const Accuracy& accuracy) {
  std::mt19937 generator(51);
  std::vector<Question> questions;
  for (int i = 0; i < 200; ++i) {
    const auto triangle = static_cast<core::TriangleId>(generator() % organ.mesh().triangleCount());
    questions.push_back(
        {core::centroid(organ.mesh().triangle(triangle)) + test::randomPoint(generator, 0.005),
         accuracy});
  }
  return questions;
}

/// Crushed to a hundredth of its length: splits across it part nothing any more.
CollisionMesh crushed(CollisionMesh organ) {
  Points points = organ.mesh().positions();
  for (Eigen::Vector3d& point : points) {
    point = Eigen::Vector3d(0.01 * point.x(), 3.0 * point.y() + std::sin(60.0 * point.x()) * 0.1,
                            point.z());
  }
  organ.refit(points);
  return organ;
}

TEST(Wear, IsNoneWhereNothingHasMoved) {
  const CollisionMesh organ(test::blob(4));
  const auto wear = measureWear(questionsNear(organ, Accuracy::greedy()), organ, organ);
  ASSERT_TRUE(wear);
  EXPECT_EQ(wear->work_ratio, 1.0);
  EXPECT_EQ(wear->newly_wrong, 0.0);
  EXPECT_GT(wear->query_duration, 0.0);
  EXPECT_GT(wear->exact_duration, 0.0);
}

/// A look at the clock of a thread takes as long as some queries.
TEST(Wear, TakesWhatAQueryCostsAndLittleOfTheClock) {
  const CollisionMesh organ(test::blob(4));
  const std::vector<Question> questions = questionsNear(organ, Accuracy::exact());
  const std::vector<Question> some(questions.begin(), questions.begin() + 64);
  double cost = 1.0, told = 1.0;
  for (int i = 0; i < 20; ++i) {  // the least of some: other programs may disturb
    const CostStopwatch watch;
    for (const Question& question : questions) core::nearestTriangle(organ, question.tip);
    cost = std::min(cost, watch.elapsed() / static_cast<double>(questions.size()));
    told = std::min(told, measureWear(some, organ, organ)->query_duration);
  }
  EXPECT_LT(told, 2.0 * cost);
  EXPECT_GT(told, 0.2 * cost);
}

TEST(Wear, IsNotAskedOfTipsThatTheSurfaceCarriesOutOfTheWorld) {
  const CollisionMesh built(test::blob(1));
  CollisionMesh turned = built;
  Points points = built.mesh().positions();
  for (Eigen::Vector3d& point : points)
    point = Eigen::AngleAxisd(M_PI / 4, Eigen::Vector3d::UnitZ()) * point;
  turned.refit(points);
  std::vector<Question> questions;
  for (const double x : {-9.9e149, 9.9e149})
    for (const double y : {-9.9e149, 9.9e149})
      questions.push_back({{x, y, 0.0}, Accuracy::exact()});
  EXPECT_FALSE(measureWear(questions, turned, built));
}

TEST(Wear, IsNoneWhereTheOrganHasMovedAsAWhole) {
  CollisionMesh built(test::blob(4));
  Points points = built.mesh().positions();
  built.refit(points);  // which draws the boxes less closely than a build does
  for (Eigen::Vector3d& point : points) point += Eigen::Vector3d(0.3, -0.2, 0.1);
  CollisionMesh organ = built;
  organ.refit(points);
  const auto wear = measureWear(questionsNear(organ, Accuracy::exact()), organ, built);
  ASSERT_TRUE(wear);
  EXPECT_NEAR(wear->work_ratio, 1.0, 0.02) << "what is left are ties that rounding decides";
}

TEST(Wear, TellsAWornHierarchyFromAFreshOne) {
  const CollisionMesh built(test::blob(4));
  const CollisionMesh worn = crushed(built);
  const auto exact = measureWear(questionsNear(worn, Accuracy::exact()), worn, built);
  ASSERT_TRUE(exact);
  EXPECT_GT(exact->work_ratio, 1.2);
  EXPECT_EQ(exact->newly_wrong, 0.0) << "refitting keeps exact answers exact";
  const auto greedy = measureWear(questionsNear(worn, Accuracy::greedy()), worn, built);
  ASSERT_TRUE(greedy);
  EXPECT_GT(greedy->newly_wrong, 0.1);
}

TEST(Wear, CallsNoAnswerWrongThatIsAsGoodAsAskedFor) {
  const CollisionMesh built(test::blob(4));
  const CollisionMesh worn = crushed(built);
  for (const Accuracy& accuracy : {Accuracy{0.5, 0.0, 0}, Accuracy{0.0, 1.0, 1}}) {
    const auto wear = measureWear(questionsNear(worn, accuracy), worn, built);
    ASSERT_TRUE(wear);
    EXPECT_EQ(wear->newly_wrong, 0.0);
  }
}

TEST(Wear, IsNotTakenFromATipThatGoesWhereAnswersCostMore) {
  const CollisionMesh built(test::blob(4));
  CollisionMesh organ = built;
  organ.refit({core::VertexId{0}}, {organ.mesh().positions()[0] * 1.001});
  const auto wear = measureWear({{{0.001, 0.002, 0.003}, Accuracy::exact()}}, organ, built);
  ASSERT_TRUE(wear);  // in the middle: everything is as near
  EXPECT_NEAR(wear->work_ratio, 1.0, 0.05);
}

TEST(Wear, IsUnknownWhereAllTrianglesNearTheTipsHaveLostTheirArea) {
  const CollisionMesh built(test::cube());
  CollisionMesh point = built;
  point.refit(Points(8, {1, 1, 1}));
  EXPECT_FALSE(measureWear({{{2, 2, 2}, Accuracy::exact()}}, point, built));
  EXPECT_FALSE(measureWear({}, built, built));
}

TEST(RecentQuestions, AreWorthALookWhenThereAreEnough) {
  RecentQuestions questions;
  int count = 1;
  for (; !questions.add({{static_cast<double>(count % 2), 0, 0}, {}}); ++count)
    EXPECT_FALSE(questions.take());
  const auto asked = questions.take();
  ASSERT_TRUE(asked);
  EXPECT_EQ(asked->count, static_cast<std::uint64_t>(count));
  EXPECT_GE(asked->sample.size(), 8U);
  EXPECT_LE(asked->sample.size(), asked->count / 16) << "asking again must cost little";
  double odd = 0.0;
  for (const Question& question : asked->sample) odd += question.tip.x();
  EXPECT_NEAR(odd, 0.5 * static_cast<double>(asked->sample.size()), 1.0) << "pairs take turns";
  EXPECT_FALSE(questions.take());
}

}  // namespace
}  // namespace organ_collision::node
