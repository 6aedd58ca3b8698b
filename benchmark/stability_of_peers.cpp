// How far are the answers of other libraries from the truth, on the inputs of measure_stability?
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "reference/triangle_pairs.h"
#include "stability/peers.h"
#include "tools/arguments.h"
#include "tools/output.h"
#include "tools/program.h"
#include "tools/stability.h"

namespace organ_collision {
namespace {

using bench::meshOf;
using bench::Organ;
using bench::Peer;
using core::Triangle;
using Eigen::Vector3d;

std::vector<Peer> peers() {
  return {bench::libraryPeer(), bench::cgalPeer(), bench::fclPeer(), bench::bulletPeer(),
          bench::embreePeer()};
}

// ---- measuring

/// What an action returns; NaN where it throws.
template <typename Action>
double answerOf(const Action& action) {
  try {
    return action();
  } catch (const std::exception&) {
    return std::numeric_limits<double>::quiet_NaN();
  }
}

void countError(tools::Tally& tally, double found, const core::exact::Real& truth, double extent) {
  ++tally.trials;
  if (std::isfinite(found)) {
    tally.worst = std::max(tally.worst, tools::errorOf(found, truth, extent));
  } else {
    ++tally.not_finite;
  }
}

enum Column { kPoint, kOrgan, kTriangles, kMeet };

/// What a peer made of a class.
struct Outcome {
  std::array<tools::Tally, 4> tallies;
  bool crashed = false;  ///< or took too long
};

void measurePoints(const tools::Extreme& extreme, const Peer& peer, std::size_t trials,
                   tools::Tally& tally) {
  tools::Extreme::Random random(1);
  for (std::size_t i = 0; extreme.sample && i < trials; ++i) {
    const core::Sample sample = extreme.sample(random);
    const auto& [tip, triangle] = sample;
    countError(tally, answerOf([&] { return peer.organ(meshOf(sample.triangle))(sample.query); }),
               core::exact::distance(tip, triangle), tools::extentOf(tip, triangle));
  }
}

void measureTips(const tools::Extreme& extreme, const Peer& peer, std::size_t trials,
                 tools::Tally& tally) {
  tools::Extreme::Random random(2);
  const Organ organ = peer.organ(extreme.organ);
  for (std::size_t i = 0; i < trials; ++i) {
    const Vector3d tip = extreme.tip(random, extreme.organ);
    const core::exact::Nearest nearest = core::exact::nearest(extreme.organ, tip);
    countError(tally, answerOf([&] { return organ(tip); }), nearest.distance,
               tools::extentOf(tip, extreme.organ.triangle(nearest.triangle)));
  }
}

void countMeeting(const Peer& peer, const Triangle& first, const Triangle& second, bool truth,
                  tools::Tally& tally) {
  ++tally.trials;
  const double meets = answerOf([&] { return peer.intersect(first, second) ? 1.0 : 0.0; });
  if (meets != (truth ? 1.0 : 0.0)) ++tally.wrong;
}

void measurePairs(const tools::Extreme& extreme, const Peer& peer, std::size_t trials,
                  Outcome& outcome) {
  tools::Extreme::Random random(3);
  for (std::size_t i = 0; extreme.pair && i < trials; ++i) {
    const auto pair = extreme.pair(random);
    const core::exact::Real truth = core::exact::distance(pair.first, pair.second);
    if (peer.distance) {
      countError(outcome.tallies[kTriangles],
                 answerOf([&] { return peer.distance(pair.first, pair.second); }), truth,
                 tools::extentOf(pair.first, pair.second));
    }
    if (peer.intersect)
      countMeeting(peer, pair.first, pair.second, truth == 0, outcome.tallies[kMeet]);
  }
}

/// The published cases in their 72 orders.
Outcome onPublishedCases(const Peer& peer) {
  Outcome outcome;
  for (const core::HardPair& pair : core::kHardPairs) {
    core::forEachOrder(pair.first, pair.second, [&](const Triangle& one, const Triangle& other) {
      if (peer.intersect)
        countMeeting(peer, one, other, pair.distance == 0, outcome.tallies[kMeet]);
    });
  }
  return outcome;
}

/// Runs `action` in a process of its own: libraries crash and hang.
template <typename Action>
Outcome inChild(const Action& action) {
  constexpr unsigned kPatience = 60;  // [s]
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no process");
  if (child == 0) {
    alarm(kPatience);
    try {
      const Outcome outcome = action();
      _exit(write(ends[1], &outcome, sizeof outcome) == sizeof outcome ? 0 : 1);
    } catch (...) {
      _exit(2);
    }
  }
  close(ends[1]);
  Outcome outcome;
  const bool answered = read(ends[0], &outcome, sizeof outcome) == sizeof outcome;
  close(ends[0]);
  waitpid(child, nullptr, 0);
  if (!answered) outcome.crashed = true;
  return outcome;
}

/// What all peers made of one class.
struct Row {
  std::string name;
  std::vector<Outcome> outcomes;
};

Row measure(const tools::Extreme& extreme, const std::vector<Peer>& all,
            const tools::Trials& trials) {
  Row row{extreme.name, {}};
  for (const Peer& peer : all) {
    row.outcomes.push_back(inChild([&] {
      Outcome outcome;
      measurePoints(extreme, peer, trials.points, outcome.tallies[kPoint]);
      measureTips(extreme, peer, trials.tips, outcome.tallies[kOrgan]);
      measurePairs(extreme, peer, trials.pairs, outcome);
      return outcome;
    }));
  }
  return row;
}

// ---- the tables, in Markdown

using Cell = std::function<std::string(const tools::Tally&)>;

std::string errorCell(const tools::Tally& tally) {
  if (tally.trials == 0) return "-";
  const std::string worst =
      tally.worst < 100.0 ? tools::fixed(tally.worst, 2) : tools::significant(tally.worst, 2);
  return tally.not_finite == 0 ? worst : "NaN or inf";
}

std::string wrongCell(const tools::Tally& tally) {
  return tally.trials == 0 ? "-" : std::to_string(tally.wrong);
}

void printLine(const std::string& name, const std::vector<Outcome>& outcomes, Column column,
               const Cell& cell) {
  std::cout << "| " << name << " |";
  for (const Outcome& outcome : outcomes)
    std::cout << " " << (outcome.crashed ? "crash" : cell(outcome.tallies[column])) << " |";
  std::cout << "\n";
}

void print(const std::string& heading, const std::vector<Row>& rows, const std::vector<Peer>& all,
           Column column, const Cell& cell) {
  std::cout << "\n" << heading << "\n\n| |";
  for (const Peer& peer : all) std::cout << " " << peer.name << " |";
  std::cout << "\n|---|";
  for (std::size_t p = 0; p < all.size(); ++p) std::cout << "---|";
  std::cout << "\n";
  for (const Row& row : rows) {
    if (row.outcomes.front().tallies[column].trials > 0)
      printLine(row.name, row.outcomes, column, cell);
  }
}

void run(const std::vector<std::string>& words) {
  const tools::Arguments arguments(words, {"--points"});
  arguments.requireNoWords();
  const tools::Trials trials(arguments.whole("--points", 10'000));
  const std::vector<Peer> all = peers();
  std::vector<Row> rows;
  for (const tools::Extreme& extreme : tools::extremes()) {
    rows.push_back(measure(extreme, all, trials));
    std::cerr << "measured: " << extreme.name << std::endl;
  }
  std::vector<Outcome> published;
  for (const Peer& peer : all) published.push_back(inChild([&] { return onPublishedCases(peer); }));

  std::cout << "Of " << trials.points << " points and triangles, " << trials.tips
            << " tips and organs, " << trials.pairs << " pairs in each class\n";
  print("Point and triangle, worst error in u*extent", rows, all, kPoint, errorCell);
  print("Point and organ, worst error in u*extent", rows, all, kOrgan, errorCell);
  print("Two triangles, worst error in u*extent", rows, all, kTriangles, errorCell);
  print("Do two triangles meet, wrong answers", rows, all, kMeet, wrongCell);
  printLine("published cases in 72 orders each", published, kMeet, wrongCell);
}

}  // namespace
}  // namespace organ_collision

int main(int count, char** words) {
  using namespace organ_collision;
  return tools::runProgram({"stability_of_peers", "usage: stability_of_peers [--points N]\n"},
                           {words + 1, words + count}, std::cout, std::cerr, run);
}
