#include "node/duty.h"

#include <sched.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>

namespace organ_collision::node {
namespace {

constexpr std::uint64_t kShortTurn = 100'000;  // [ns] the shortest that there is
constexpr std::uint64_t kUsualTurn = 0;        // as long as the kernel finds right
constexpr int kInFront = -20;                  // nice: no step back at all
constexpr int kBehind = 5;                     // a third of the time of those in front
// The lowest that still gets its turn: with SCHED_IDLE a machine whose processors are all busy
// would never finish a rebuild that a caller waits for.
constexpr int kLast = 19;

/// What sched_setattr(2) calls sched_attr. C libraries that do not know it yet clash with the
/// kernel's header that does.
struct Attributes {
  std::uint32_t size;
  std::uint32_t policy;
  std::uint64_t flags;
  std::int32_t nice;
  std::uint32_t priority;
  std::uint64_t runtime, deadline, period;  // [ns]
};

int leastNice(Duty duty) {
  switch (duty) {
    case Duty::kUpdate:
      return kBehind;
    case Duty::kRebuild:
      return kLast;
    default:
      return kInFront;
  }
}

}  // namespace

void setDuty(Duty duty) {
  constexpr int kThisThread = 0;
  constexpr unsigned kNoFlags = 0;
  Attributes wanted = {};
  if (syscall(SYS_sched_getattr, kThisThread, &wanted, sizeof(wanted), kNoFlags) != 0) return;
  if (duty == Duty::kAnswer && wanted.policy != SCHED_OTHER) return;
  wanted.policy = SCHED_OTHER;
  wanted.priority = 0;
  wanted.nice = std::max(wanted.nice, leastNice(duty));
  wanted.runtime = duty == Duty::kAnswer ? kShortTurn : kUsualTurn;
  syscall(SYS_sched_setattr, kThisThread, &wanted, kNoFlags);
}

}  // namespace organ_collision::node
