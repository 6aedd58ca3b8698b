#pragma once

namespace organ_collision::node {

/// What a thread is there for.
enum class Duty {
  kAnswer,   ///< tips: little to do, and at once
  kServe,    ///< callers, some of whom want much
  kUpdate,   ///< organs: others go first, but not always
  kRebuild,  ///< when nobody else has anything to do, and a little even then
};

/// Tells the kernel, for the calling thread and those that it starts from now on. Real-time
/// priority is left to those that answer; they ask otherwise for short turns, which brings them
/// before who takes longer ones (Linux 6.12; older kernels pay no heed). No more than a wish: what
/// the kernel does not grant stays as it was.
void setDuty(Duty duty);

}  // namespace organ_collision::node
