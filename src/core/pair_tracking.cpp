#include "organ_collision/core/pair_tracking.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/kernels/kernels.h"
#include "core/mesh_state.h"
#include "core/nearest_pair_search.h"
#include "core/pair_sign.h"
#include "core/rigid_pose.h"

namespace organ_collision::core {

/// Of the last query.
struct PairTracker::Memory {
  FollowedPairs followed;  // in the second's unit frame
  bool knows_pair = false;
  FarthestPairTree::Leaf leaf_of_first = 0, leaf_of_second = 0;  // the nearest
  Eigen::Isometry3d pose;                                        // second_from_first
  MeshState first, second;
  double scale = 0.0;  // of the second's unit frame
  double slack = 0.0;  // what is farther than the nearest by this is to be followed
};

namespace {

/// As many pairs are followed as cost little to keep, and seldom leave too little clear.
constexpr std::uint32_t kFewPairs = 160;
constexpr std::uint32_t kManyPairs = 320;
/// Steps that what is followed must last for, to be worth it.
constexpr double kWorthSteps = 4.0;

// `Memory`, which is private, has one name only by a template.
template <class Memory>
class TrackedPairSearch : private NearestPairSearch {
 public:
  TrackedPairSearch(const CollisionMesh& first_surface, double travel_of_first,
                    const Eigen::Isometry3d& pose, const CollisionMesh& second_surface,
                    double travel_of_second, Memory& memory)
      : NearestPairSearch(first_surface, pose, second_surface, Accuracy::exact()),
        first_state_(first_surface, travel_of_first),
        second_state_(second_surface, travel_of_second),
        memory_(memory) {}

  /// Nothing where the surfaces meet, or are too far apart or too small to tell triangles apart.
  std::optional<NearestPair> run() {
    if (isTooFar() || isBlurred() || areAllAlike()) return std::nullopt;
    if (const std::optional<double> step = this->step()) {
      measure(memory_.leaf_of_first, memory_.leaf_of_second);
      if (!follow(*step)) walk(*step);
    } else {
      measureGreedily();
      memory_.slack = kFirstSlack / std::sqrt(static_cast<double>(second_.mesh().triangleCount()));
      walk(0.0);
    }
    if (!(best > 0.0)) return std::nullopt;
    remember();
    return answer();
  }

 private:
  static constexpr double kSlackStep = 1.25;
  /// Sizes of a triangle, of those that would fill the second's box, at first.
  static constexpr double kFirstSlack = 0.125;

  /// How far the surfaces have moved towards each other at most, in the second's unit frame: no
  /// point of a box moves farther than all its corners. Nothing if that is not known.
  std::optional<double> step() const {
    constexpr double kRounding = 1.0 + 0x1p-40;
    const std::optional<double> of_first = first_state_.since(memory_.first);
    const std::optional<double> of_second = second_state_.since(memory_.second);
    if (!memory_.knows_pair || !of_first || !of_second ||
        memory_.scale != second_.wideTree().frame().scale)
      return std::nullopt;
    double farthest = 0.0;
    for (const Eigen::Vector3d& corner : cornersOf(first_.health().box))
      farthest = std::max(farthest, (pose_ * corner - memory_.pose * corner).stableNorm());
    constexpr double kStretch = 1.0 + 0x1p-4;  // see requireRigid()
    const double travel = kStretch * *of_first + *of_second;
    // Where the corners are is off by as much as where triangles are, before and after.
    return (farthest + travel) * kRounding * memory_.scale + 4 * rounding;
  }

  /// Whether the pairs that are followed are enough.
  bool follow(double step) {
    double& clear = memory_.followed.clear;
    clear = (1.0 - 0x1p-50) * clear - step;
    if (!(best < clear)) return false;
    followed = &memory_.followed;
    kernels().followPairs(*this, step);
    bounds += memory_.followed.count;
    return true;
  }

  void walk(double step) {
    FollowedPairs& near = memory_.followed;
    memory_.knows_pair = false;  // should a search throw
    near.count = 0;
    near.clear = unopened = std::numeric_limits<double>::infinity();
    if (best > 0.0) measureToAndFro();
    const bool is_worth_it = memory_.slack > kWorthSteps * step;
    followed = is_worth_it ? &near : nullptr;
    slack = is_worth_it ? memory_.slack : 0.0;
    kernels().walkPairs(*this);
    if (!is_worth_it) {
      near.clear = 0.0;
    } else if (near.count < kFewPairs) {
      memory_.slack *= kSlackStep;
    } else if (near.count > kManyPairs) {
      memory_.slack /= kSlackStep;
    }
  }

  void remember() {
    memory_.knows_pair = true;
    memory_.leaf_of_first = best_leaves_.first;
    memory_.leaf_of_second = best_leaves_.second;
    memory_.pose = pose_;
    memory_.first = first_state_;
    memory_.second = second_state_;
    memory_.scale = second_.wideTree().frame().scale;
  }

  const MeshState first_state_, second_state_;
  Memory& memory_;
};

}  // namespace

PairTracker::PairTracker() = default;
PairTracker::~PairTracker() = default;
PairTracker::PairTracker(PairTracker&&) noexcept = default;
PairTracker& PairTracker::operator=(PairTracker&&) noexcept = default;

NearestPair PairTracker::nearestPair(const CollisionMesh& first, double travel_of_first,
                                     const Eigen::Isometry3d& second_from_first,
                                     const CollisionMesh& second, double travel_of_second) {
  requireRigid(second_from_first);
  if (memory_ == nullptr) memory_ = std::make_unique<Memory>();
  const std::optional<NearestPair> pair =
      TrackedPairSearch(first, travel_of_first, second_from_first, second, travel_of_second,
                        *memory_)
          .run();
  memory_->knows_pair = pair.has_value();
  // Of all triangles that meet a search names any.
  if (!pair) return core::nearestPair(first, second_from_first, second);
  return withSign(first, second_from_first, second, *pair);
}

}  // namespace organ_collision::core
