#include "node/duty.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <future>
#include <thread>

namespace organ_collision::node {
namespace {

struct Scheduling {
  int nice;
  std::uint64_t turn;  // [ns] 0: this kernel does not tell
};

Scheduling ofThisThread() {
  constexpr std::size_t kTurnOffset = 24;  // in sched_attr, see sched_setattr(2)
  std::array<unsigned char, 48> attributes = {};
  syscall(SYS_sched_getattr, 0, attributes.data(), attributes.size(), 0U);
  Scheduling scheduling = {getpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid))), 0};
  std::memcpy(&scheduling.turn, &attributes[kTurnOffset], sizeof(scheduling.turn));
  return scheduling;
}

/// Of a thread that was started by one that answers, and keeps that duty unless it is another.
Scheduling ofThreadWith(Duty duty) {
  std::promise<Scheduling> scheduling;
  std::thread([&] {
    setDuty(Duty::kAnswer);
    std::thread([&] {
      if (duty != Duty::kAnswer) setDuty(duty);
      scheduling.set_value(ofThisThread());
    }).join();
  }).join();
  return scheduling.get_future().get();
}

TEST(Duty, UpdatesStepBackAndRebuildsFarther) {
  const int own = ofThisThread().nice;
  if (own >= 5) GTEST_SKIP() << "these tests step back already";
  EXPECT_EQ(ofThreadWith(Duty::kAnswer).nice, own);
  EXPECT_EQ(ofThreadWith(Duty::kServe).nice, own);
  EXPECT_GT(ofThreadWith(Duty::kUpdate).nice, own);
  EXPECT_GT(ofThreadWith(Duty::kRebuild).nice, ofThreadWith(Duty::kUpdate).nice);
}

TEST(Duty, ThoseWhoAnswerTakeShorterTurnsThanTheOthers) {
  const std::uint64_t turn = ofThreadWith(Duty::kAnswer).turn;
  if (turn == 0) GTEST_SKIP() << "this kernel knows no turns";
  for (const Duty duty : {Duty::kServe, Duty::kUpdate, Duty::kRebuild})
    EXPECT_GT(ofThreadWith(duty).turn, turn);
}

}  // namespace
}  // namespace organ_collision::node
