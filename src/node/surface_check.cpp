#include "node/surface_check.h"

#include <atomic>
#include <exception>
#include <utility>

#include "node/stopwatch.h"
#include "organ_collision/core/self_intersections.h"

namespace organ_collision::node {
namespace {

constexpr std::size_t kMostPairs = 1000;  // more are as wrong
constexpr double kShare = 0.01;           // of a processor's time

/// Of surfaces without an inside it is told that distances carry no sign.
std::string complaintAbout(const core::CollisionMesh& organ) {
  if (!organ.health().isSolid()) return "";
  return core::warning(core::selfIntersections(organ, kMostPairs));
}

}  // namespace

/// Until `done`, the background thread's alone.
struct SurfaceCheck::Look {
  void run() {
    const Stopwatch watch;
    try {
      complaint = complaintAbout(organ->organ);
    } catch (const std::exception& error) {  // memory, most likely
      complaint = std::string("whether the surface crosses itself is not known: ") + error.what();
    }
    duration = watch.elapsed();
    done = true;
  }

  // Let go by who takes the result: where queries let go of theirs, the background thread must not.
  std::shared_ptr<const OrganSnapshot> organ;
  std::string complaint;
  double duration = 0.0;  // [s]
  std::atomic<bool> done{false};
};

const std::string& SurfaceCheck::complaint(const std::shared_ptr<const OrganSnapshot>& organ,
                                           const ros::SteadyTime& now) {
  takeResult(now);
  const bool is_due = hierarchy_ != organ->hierarchy || (version_ != organ->version && due_ <= now);
  if (!look_ && is_due) look(organ);
  return complaint_;
}

void SurfaceCheck::takeResult(const ros::SteadyTime& now) {
  if (!look_ || !look_->done) return;
  const std::shared_ptr<const OrganSnapshot> let_go = std::move(look_->organ);
  complaint_ = std::move(look_->complaint);
  due_ = now + ros::WallDuration(look_->duration / kShare);
  look_ = nullptr;
}

void SurfaceCheck::look(const std::shared_ptr<const OrganSnapshot>& organ) {
  auto look = std::make_shared<Look>();
  look->organ = organ;
  thread_->run([look] { look->run(); });
  look_ = std::move(look);
  hierarchy_ = organ->hierarchy;
  version_ = organ->version;
}

}  // namespace organ_collision::node
