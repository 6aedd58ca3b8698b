#include "node/vertex_moves.h"

#include <gmock/gmock.h>

#include <limits>
#include <map>
#include <random>
#include <stdexcept>

#include "node/moves.h"
#include "test_meshes.h"

namespace organ_collision::node {
namespace {

using core::Points;
using core::VertexId;
using test::movesOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr std::size_t kVertices = 8;

Eigen::Vector3d at(double x) { return {x, 0, 0}; }

Points line() {
  Points points;
  for (std::size_t i = 0; i < kVertices; ++i) points.push_back(at(static_cast<double>(i)));
  return points;
}

/// What the moves make of a line.
Points after(const VertexMoves& moves) { return moved(line(), moves); }

TEST(VertexMoves, AreAsFarAsTheFarthestVertexMoves) {
  Points all = line();
  all[3].y() = -0.5;
  all[6].z() = 2.0;
  EXPECT_DOUBLE_EQ(farthest({{}, all}, line()), 2.0);
  EXPECT_GE(farthest({{}, all}, line()), 2.0);
  EXPECT_DOUBLE_EQ(farthest({{VertexId{3}, VertexId{1}}, {all[3], all[1]}}, line()), 0.5);
  EXPECT_EQ(farthest({{}, line()}, line()), 0.0);
}

TEST(VertexMoves, AreNoLessFarThanTheyAre) {
  std::mt19937 generator(1);
  for (int i = 0; i < 1000; ++i) {
    const Eigen::Vector3d to = test::randomPoint(generator, 1.0);
    const auto exact = to.cast<long double>().norm();
    EXPECT_GE(farthest({{VertexId{0}}, {to}}, line()), exact);
  }
}

TEST(VertexSet, KnowsItsMembersAndForgetsThemAtOnce) {
  VertexSet set(kVertices);
  EXPECT_FALSE(set.contains(VertexId{0}));
  EXPECT_TRUE(set.insert(VertexId{5}));
  EXPECT_TRUE(set.insert(VertexId{0}));
  EXPECT_FALSE(set.insert(VertexId{5}));
  EXPECT_EQ(set.place(VertexId{0}), 1U);
  set.clear();
  EXPECT_FALSE(set.contains(VertexId{5}));
  EXPECT_TRUE(set.insert(VertexId{0}));
  EXPECT_FALSE(set.contains(VertexId{5}));
}

TEST(PendingMoves, KeepsTheLatestPositionOfEachVertexThatMoved) {
  PendingMoves pending(kVertices);
  EXPECT_TRUE(pending.empty());
  pending.add(movesOf({3, 1}, {at(30), at(10)}));
  pending.add(movesOf({1, 2}, {at(11), at(20)}));
  const VertexMoves all = pending.take();
  EXPECT_EQ(all.vertices.size(), 3U);
  Points expected = line();
  expected[3] = at(30);
  expected[1] = at(11);
  expected[2] = at(20);
  EXPECT_EQ(after(all), expected);
  EXPECT_TRUE(pending.empty());
  EXPECT_TRUE(pending.take().none());
}

TEST(PendingMoves, AWholeUpdateTakesThePlaceOfAllAndTakesInWhatFollows) {
  PendingMoves pending(kVertices);
  pending.add(movesOf({3}, {at(30)}));
  Points whole(kVertices, at(7));
  pending.add({{}, whole});
  pending.add(movesOf({6}, {at(60)}));
  const VertexMoves all = pending.take();
  EXPECT_TRUE(all.whole());
  whole[6] = at(60);
  EXPECT_EQ(all.positions, whole);
  pending.add(movesOf({2}, {at(20)}));
  EXPECT_EQ(pending.take().vertices, std::vector<VertexId>{VertexId{2}});
}

TEST(PendingMoves, RefusesWhatDoesNotFitAndChangesNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  PendingMoves pending(kVertices);
  pending.add(movesOf({3}, {at(30)}));
  const auto refuses = [&](const VertexMoves& moves, const char* reason) {
    EXPECT_THAT([&] { pending.add(moves); },
                ThrowsMessage<std::invalid_argument>(HasSubstr(reason)));
  };
  refuses({}, "0 positions given for 8 vertices");
  refuses({{}, Points(7, at(0))}, "7 positions given for 8 vertices");
  refuses({{}, Points(9, at(0))}, "9 positions given for 8 vertices");
  refuses(movesOf({1, 2}, {at(0)}), "1 positions given for 2 vertices");
  refuses(movesOf({1, 2}, {}), "0 positions given for 2 vertices");
  refuses(movesOf({1, 8}, {at(0), at(0)}), "index 8 names no vertex: there are 8");
  refuses(movesOf({1, 2, 1}, {at(0), at(0), at(0)}), "index 1 is given twice");
  refuses(movesOf({1, 5}, {at(0), at(nan)}), "vertex 5");
  refuses(movesOf({1, 5}, {at(0), at(-infinity)}), "vertex 5");
  Points with_nan = line();
  with_nan[7].z() = nan;
  refuses({{}, with_nan}, "vertex 7");
  const VertexMoves all = pending.take();
  EXPECT_EQ(all.vertices, std::vector<VertexId>{VertexId{3}});
  EXPECT_EQ(all.positions, Points{at(30)});
}

TEST(PendingMoves, NamesNoVertexTwiceWhateverWasRefusedBefore) {
  PendingMoves pending(kVertices);
  EXPECT_THROW(pending.add(movesOf({4, 4}, {at(0), at(0)})), std::invalid_argument);
  EXPECT_NO_THROW(pending.add(movesOf({4}, {at(0)})));
}

TEST(MoveLog, ReplaysWhatAnOlderStateMissed) {
  MoveLog log(kVertices, 1);
  Points latest = line();
  log.record(2, {VertexId{1}});
  log.record(3, {VertexId{2}, VertexId{1}});
  EXPECT_TRUE(log.since(3, {}, latest).none());
  EXPECT_EQ(log.since(2, {}, latest).vertices, (std::vector<VertexId>{VertexId{2}, VertexId{1}}));
  const VertexMoves missed = log.since(1, movesOf({2, 5}, {at(20), at(50)}), latest);
  EXPECT_EQ(missed.vertices, (std::vector<VertexId>{VertexId{2}, VertexId{5}, VertexId{1}}));
  EXPECT_EQ(missed.positions, (Points{at(20), at(50), latest[1]}));
}

TEST(MoveLog, MovesEverythingWhereItDoesNotReachBack) {
  MoveLog log(kVertices, 4);
  EXPECT_TRUE(log.since(3, {}, line()).whole());
  log.record(5, {});
  EXPECT_TRUE(log.since(4, {}, line()).whole());
  EXPECT_TRUE(log.since(5, {}, line()).none());
  for (std::uint32_t version = 6; version < 20; ++version)
    log.record(version, {VertexId{1}, VertexId{2}, VertexId{3}});
  EXPECT_EQ(log.since(17, {}, line()).vertices.size(), 3U) << "two updates of three fit in eight";
  EXPECT_TRUE(log.since(16, {}, line()).whole());
}

/// Many states, each left behind at a random version, all of which must catch up.
TEST(MoveLog, LeadsEveryStateToTheLatestPositions) {
  std::mt19937 generator(41);
  MoveLog log(kVertices, 1);
  PendingMoves pending(kVertices);
  Points latest = line();
  std::map<std::uint32_t, Points> states = {{1, latest}};
  for (std::uint32_t version = 2; version < 500; ++version) {
    VertexMoves moves;
    if (generator() % 10 == 0) {
      moves.positions = Points(kVertices, at(version));
    } else {
      moves = movesOf({generator() % kVertices}, {at(version)});
    }
    pending.add(moves);
    if (generator() % 3 != 0) pending.add(movesOf({generator() % kVertices}, {at(version + 0.5)}));
    moves = pending.take();
    for (auto& [left_at, state] : states) {
      ASSERT_EQ(moved(state, log.since(left_at, moves, latest)), moved(latest, moves));
    }
    latest = moved(latest, moves);
    log.record(version, moves.vertices);
    states[version] = latest;
  }
}

}  // namespace
}  // namespace organ_collision::node
