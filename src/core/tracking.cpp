#include "organ_collision/core/tracking.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/mesh_state.h"
#include "core/nearest_search.h"

namespace organ_collision::core {

/// Whether to follow on: where triangles are small for the tip's steps, it costs more than it
/// saves. Then it is tried again after ever longer rests, in which tips are searched for.
class Tracker::Patience {
 public:
  void noteHit() { ++hits_; }
  /// After a miss.
  bool lasts() {
    rest_ = hits_ < kFewHits ? std::min(2 * rest_ + 1, kLongestRest) : 0;
    hits_ = 0;
    left_ = rest_;
    return left_ == 0;
  }
  /// Asked once a query.
  bool rests() {
    if (left_ == 0) return false;
    --left_;
    return true;
  }

 private:
  static constexpr std::uint32_t kFewHits = 2;
  static constexpr std::uint32_t kLongestRest = 63;  // queries
  std::uint32_t hits_ = 0;                           // since the last miss
  std::uint32_t rest_ = 0;                           // the last
  std::uint32_t left_ = 0;                           // of it
};

/// Of the last query.
struct Tracker::Memory {
  Front front;  // in the unit frame, of the splits of `organ`; perhaps none
  std::array<std::array<double, 3>, 3> origin;  // of the front: where the tip's corners were
  std::uint32_t origin_corners = 0;
  Eigen::Vector3d centre;         // [m] of the unit frame then
  std::uint32_t fresh_count = 0;  // of the front, when it had been followed once; 0: it was not yet
  Patience patience;
  std::array<Eigen::Vector3d, 3> corners;  // [m] of the tip
  std::size_t corner_count = 0;
  MeshState organ;
  double scale = 0.0;  // of the unit frame
  std::optional<SurfaceNormal> normal;
  TriangleId triangle;  // where it is
  Feature feature;
};

namespace {

// `Memory`, which is private, has one name only by a template.
template <class Tip, class Memory>
class TrackedSearch : private NearestSearch<Tip> {
 public:
  /// What was nearest is measured before all else: for how far that is the rest waits longest.
  TrackedSearch(const CollisionMesh& organ, const Tip& tip, double travel, Sign sign,
                Memory& memory, NearestTriangle& nearest)
      : NearestSearch<Tip>(organ, tip, sign, nearest),
        sign_(sign),
        state_(organ, travel),
        memory_(memory),
        mesh_step_(state_.since(memory.organ)) {
    const FarthestPairTree::Leaf last = memory.front.nearest;
    if (mesh_step_ && last != kNoLeaf) this->measure(last);
    NearestSearch<Tip>::prepare(Accuracy::exact());
    step_ = step();
  }

  void run() {
    if (this->farthest < kFar) return runNear();
    NearestSearch<Tip>::run();  // what was followed is as far away as it was
    if (sign_ == Sign::kProven) this->addSign();
  }

 private:
  void runNear() {
    auto& patience = memory_.patience;
    const bool rests = patience.rests();
    const bool tries = !rests && follows();
    if (tries && follow()) {
      patience.noteHit();
    } else if (rests || (tries && !patience.lasts())) {
      search();
    } else {
      walk();
    }
    this->answer();
    if (!isNormalKnown()) memory_.normal.reset();
    remember();  // first: addSign() may throw
    if (sign_ == Sign::kProven) this->addSign(normal());
  }

  /// Sets that may be opened before the front is worn: all that is kept is looked at each time.
  static constexpr std::uint32_t kMostOpened = 16;
  /// In sizes of a triangle, of those that would fill the organ's box: tips that move farther are
  /// not near where they were.
  static constexpr double kJump = 4.0;

  /// How far the mesh, and how far mesh and tip have moved towards each other at most, in the unit
  /// frame.
  struct Step {
    double of_mesh, of_both;
  };
  /// Nothing if that is not known.
  std::optional<Step> step() const {
    constexpr double kRounding = 1 + 8 * 0x1p-53;
    if (!mesh_step_ || memory_.corner_count != Tip::kCorners) return std::nullopt;
    double tip_step = 0.0;
    for (std::size_t i = 0; i < Tip::kCorners; ++i)
      tip_step = std::max(tip_step, (this->tip_.corner(i) - memory_.corners[i]).norm());
    return Step{*mesh_step_ * kRounding * this->scale_,
                (tip_step + *mesh_step_) * kRounding * this->scale_};
  }

  bool follows() const {
    return memory_.front.count > 0 && step_ && memory_.scale == this->scale_ &&
           memory_.origin_corners == this->corner_count;
  }

  /// Whether the front was enough.
  bool follow() {
    Front& kept = memory_.front;
    kept.drift += step_->of_mesh;
    kept.approach += step_->of_both;
    if (!state_.hasPositionsOf(memory_.organ)) kept.tied_vertex = kNoVertex;
    const bool is_worn = memory_.fresh_count > 0 && kept.count > memory_.fresh_count + kMostOpened;
    if (is_worn || !(kept.approach < kFar)) return false;
    const Eigen::Vector3d moved =
        (this->organ_.wideTree().frame().centre - memory_.centre) * this->scale_;
    for (std::uint32_t i = 0; i < this->corner_count; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        kept.shift[i][axis] =
            static_cast<float>((this->corners[i][axis] - memory_.origin[i][axis]) +
                               moved[static_cast<Eigen::Index>(axis)]);
    this->front = &kept;
    if (!kernels().follow(*this)) return false;
    if (memory_.fresh_count == 0) memory_.fresh_count = kept.count;
    return true;
  }

  /// Keeps nothing.
  void search() {
    startFromLast();
    memory_.front.count = 0;
    this->front = nullptr;
    NearestSearch<Tip>::walk();
  }

  /// Of a tip that is near where it was, most is farther than what was nearest.
  void startFromLast() {
    const double jump = kJump / std::sqrt(static_cast<double>(this->organ_.mesh().triangleCount()));
    this->dives = this->best_leaf == kNoLeaf || !step_ || !(step_->of_both <= jump);
  }

  void walk() {
    startFromLast();
    Front& kept = memory_.front;
    this->front = &kept;
    kept.count = 0;
    kept.drift = kept.approach = 0.0;
    kept.shift = {};
    memory_.origin = this->corners;
    memory_.origin_corners = this->corner_count;
    memory_.centre = this->organ_.wideTree().frame().centre;
    memory_.fresh_count = 0;
    NearestSearch<Tip>::walk();
  }

  /// At the nearest point.
  const SurfaceNormal& normal() {
    if (!memory_.normal) {
      memory_.triangle = this->nearest_.triangle;
      memory_.feature = this->nearest_.closest.feature;
      memory_.normal = surfaceNormal(this->organ_, memory_.triangle, memory_.feature);
    }
    return *memory_.normal;
  }

  bool isNormalKnown() const {
    return memory_.normal && state_.hasPositionsOf(memory_.organ) &&
           memory_.triangle == this->nearest_.triangle &&
           memory_.feature == this->nearest_.closest.feature;
  }

  void remember() {
    for (std::size_t i = 0; i < Tip::kCorners; ++i) memory_.corners[i] = this->tip_.corner(i);
    memory_.corner_count = Tip::kCorners;
    memory_.front.nearest = this->best_leaf;
    memory_.organ = state_;
    memory_.scale = this->scale_;
  }

  const Sign sign_;
  const MeshState state_;
  Memory& memory_;
  const std::optional<double> mesh_step_;  // [m] nothing: other splits, or it is not known
  std::optional<Step> step_;
};

}  // namespace

Tracker::Tracker() = default;
Tracker::~Tracker() = default;
Tracker::Tracker(Tracker&&) noexcept = default;
Tracker& Tracker::operator=(Tracker&&) noexcept = default;

NearestTriangle Tracker::nearestTriangle(const CollisionMesh& organ, double travel,
                                         const Eigen::Vector3d& tip, Sign sign) {
  requireUsable(tip, "tip", 0);
  if (memory_ == nullptr) memory_ = std::make_unique<Memory>();
  NearestTriangle nearest;
  TrackedSearch(organ, PointTip(tip), travel, sign, *memory_, nearest).run();
  return nearest;
}

NearestTriangle Tracker::nearestTriangle(const CollisionMesh& organ, double travel,
                                         const Triangle& tip, Sign sign) {
  requireUsable(tip);
  if (memory_ == nullptr) memory_ = std::make_unique<Memory>();
  NearestTriangle nearest;
  TrackedSearch(organ, TriangleTip(tip), travel, sign, *memory_, nearest).run();
  return nearest;
}

}  // namespace organ_collision::core
