// How far are the answers of other libraries from the truth, on the inputs of measure_stability?
// Exit code 1 where this library crashes or is too slow.
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <csignal>
#include <cstdint>
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

void measurePoints(const tools::Extreme& extreme, const Peer& peer, const tools::Trials& trials,
                   tools::Tally& tally) {
  tools::Extreme::Random random(1);
  for (std::size_t i = 0; extreme.sample && i < trials.points; ++i) {
    const core::Sample sample = extreme.sample(random);
    const auto& [tip, triangle] = sample;
    countError(tally, answerOf([&] { return peer.organ(meshOf(sample.triangle))(sample.query); }),
               core::exact::distance(tip, triangle), tools::extentOf(tip, triangle));
  }
}

void measureTips(const tools::Extreme& extreme, const Peer& peer, const tools::Trials& trials,
                 tools::Tally& tally) {
  tools::Extreme::Random random(2);
  const Organ organ = peer.organ(extreme.organ);
  for (std::size_t i = 0; i < trials.tips; ++i) {
    const Vector3d tip = extreme.tip(random, extreme.organ);
    const core::exact::Nearest nearest = core::exact::nearest(extreme.organ, tip);
    countError(tally, answerOf([&] { return organ(tip); }), nearest.distance,
               tools::extentOf(tip, extreme.organ.triangle(nearest.triangle)));
  }
}

void measureDistances(const tools::Extreme& extreme, const Peer& peer, const tools::Trials& trials,
                      tools::Tally& tally) {
  tools::Extreme::Random random(3);
  for (std::size_t i = 0; extreme.pair && peer.distance && i < trials.pairs; ++i) {
    const auto pair = extreme.pair(random);
    countError(tally, answerOf([&] { return peer.distance(pair.first, pair.second); }),
               core::exact::distance(pair.first, pair.second),
               tools::extentOf(pair.first, pair.second));
  }
}

void countMeeting(const Peer& peer, const Triangle& first, const Triangle& second, bool truth,
                  tools::Tally& tally) {
  ++tally.trials;
  const double meets = answerOf([&] { return peer.intersect(first, second) ? 1.0 : 0.0; });
  if (meets != (truth ? 1.0 : 0.0)) ++tally.wrong;
}

void measureMeeting(const tools::Extreme& extreme, const Peer& peer, const tools::Trials& trials,
                    tools::Tally& tally) {
  tools::Extreme::Random random(3);  // the pairs of measureDistances
  for (std::size_t i = 0; extreme.pair && peer.intersect && i < trials.pairs; ++i) {
    const auto pair = extreme.pair(random);
    const bool truth = core::exact::distance(pair.first, pair.second) == 0;
    countMeeting(peer, pair.first, pair.second, truth, tally);
  }
}

/// The published cases in their 72 orders.
void measurePublishedCases(const Peer& peer, tools::Tally& tally) {
  if (!peer.intersect) return;
  for (const core::HardPair& pair : core::kHardPairs) {
    core::forEachOrder(pair.first, pair.second, [&](const Triangle& one, const Triangle& other) {
      countMeeting(peer, one, other, pair.distance == 0, tally);
    });
  }
}

// ---- in processes of their own

enum class End : std::uint8_t { kAnswered, kCrashed, kTooSlow };

/// What a peer made of what it was asked.
struct Outcome {
  End end = End::kAnswered;
  tools::Tally tally;  ///< empty unless it answered
};

constexpr unsigned kPatience = 60;  // [s]

/// Runs `action(tally)` in a process of its own: libraries crash and hang.
template <typename Action>
Outcome inChild(const Action& action) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no process");
  if (child == 0) {
    alarm(kPatience);
    try {
      tools::Tally tally;
      action(tally);
      _exit(write(ends[1], &tally, sizeof tally) == sizeof tally ? 0 : 1);
    } catch (...) {
      _exit(2);
    }
  }
  close(ends[1]);
  Outcome outcome;
  const bool answered = read(ends[0], &outcome.tally, sizeof outcome.tally) == sizeof outcome.tally;
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  const bool alarmed = WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM;
  if (!answered) outcome.end = alarmed ? End::kTooSlow : End::kCrashed;
  return outcome;
}

/// Every peer's outcome of `measure(peer, tally)`.
template <typename Measure>
std::vector<Outcome> outcomesOf(const std::vector<Peer>& all, const Measure& measure) {
  std::vector<Outcome> outcomes;
  outcomes.reserve(all.size());
  for (const Peer& peer : all)
    outcomes.push_back(inChild([&](tools::Tally& tally) { measure(peer, tally); }));
  return outcomes;
}

// ---- the tables, in Markdown

using Cell = std::string (*)(const tools::Tally&);

std::string worstError(const tools::Tally& tally) {
  if (tally.not_finite > 0) return "NaN or inf";
  return tally.worst < 100.0 ? tools::fixed(tally.worst, 2) : tools::significant(tally.worst, 2);
}

std::string wrongAnswers(const tools::Tally& tally) { return std::to_string(tally.wrong); }

/// A table: what is asked of a class, and what of the answers is told.
struct Question {
  const char* heading;
  void (*measure)(const tools::Extreme&, const Peer&, const tools::Trials&, tools::Tally&);
  Cell cell;
};

constexpr std::array<Question, 4> kQuestions = {
    {{"Point and triangle, worst error in u*extent", measurePoints, worstError},
     {"Point and organ, worst error in u*extent", measureTips, worstError},
     {"Two triangles, worst error in u*extent", measureDistances, worstError},
     {"Do two triangles meet, wrong answers", measureMeeting, wrongAnswers}}};

/// It had something to answer, as far as is known.
bool wasAsked(const Outcome& outcome) {
  return outcome.end != End::kAnswered || outcome.tally.trials > 0;
}

std::string cellOf(const Outcome& outcome, Cell cell) {
  if (outcome.end == End::kCrashed) return "crash";
  if (outcome.end == End::kTooSlow) return "too slow";
  return wasAsked(outcome) ? cell(outcome.tally) : "-";
}

void printHead(const std::string& heading, const std::vector<Peer>& all) {
  std::cout << "\n" << heading << "\n\n| |";
  for (const Peer& peer : all) std::cout << " " << peer.name << " |";
  std::cout << "\n|---|";
  for (std::size_t p = 0; p < all.size(); ++p) std::cout << "---|";
  std::cout << std::endl;
}

/// No line where nobody was asked.
void printLine(const std::string& name, const std::vector<Outcome>& outcomes, Cell cell) {
  if (std::none_of(outcomes.begin(), outcomes.end(), wasAsked)) return;
  std::cout << "| " << name << " |";
  for (const Outcome& outcome : outcomes) std::cout << " " << cellOf(outcome, cell) << " |";
  std::cout << std::endl;
}

/// Throws std::runtime_error where this library crashed or was too slow.
void run(const std::vector<std::string>& words) {
  constexpr std::size_t kFewestPoints = 100;    // one tip in each class
  constexpr std::size_t kMostPoints = 100'000;  // takes seconds, not kPatience
  const tools::Arguments arguments(words, {"--points"});
  arguments.requireNoWords();
  const tools::Trials trials(arguments.whole("--points", 10'000, kFewestPoints, kMostPoints));
  const std::vector<Peer> all = peers();
  const std::vector<tools::Extreme> classes = tools::extremes();
  bool ours_answered = true;
  const auto tell = [&](const std::string& name, Cell cell, const auto& measure) {
    const std::vector<Outcome> outcomes = outcomesOf(all, measure);
    printLine(name, outcomes, cell);
    ours_answered = ours_answered && outcomes.front().end == End::kAnswered;
  };

  std::cout << "Of " << trials.points << " points and triangles, " << trials.tips
            << " tips and organs, " << trials.pairs << " pairs in each class\n";
  for (const Question& question : kQuestions) {
    printHead(question.heading, all);
    for (const tools::Extreme& extreme : classes) {
      tell(extreme.name, question.cell, [&](const Peer& peer, tools::Tally& tally) {
        question.measure(extreme, peer, trials, tally);
      });
    }
  }
  tell("published cases in 72 orders each", wrongAnswers, measurePublishedCases);
  if (!ours_answered) throw std::runtime_error("this library crashed or was too slow");
}

}  // namespace
}  // namespace organ_collision

int main(int count, char** words) {
  using namespace organ_collision;
  return tools::runProgram({"stability_of_peers", "usage: stability_of_peers [--points N]\n"},
                           {words + 1, words + count}, std::cout, std::cerr, run);
}
