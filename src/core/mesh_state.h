#pragma once

#include <cstdint>
#include <optional>

#include "organ_collision/core/collision_mesh.h"

namespace organ_collision::core {

/// A mesh as a tracker last saw it; at first, none.
class MeshState {
 public:
  MeshState() = default;
  MeshState(const CollisionMesh& mesh, double travel)
      : splits_(mesh.splitsNumber()), positions_(mesh.positionsNumber()), travel_(travel) {}

  bool hasPositionsOf(const MeshState& other) const { return positions_ == other.positions_; }

  /// [m] No vertex has moved farther since `before`; nothing where that is not known, or the splits
  /// are others.
  std::optional<double> since(const MeshState& before) const {
    constexpr double kRoundoff = 0x1p-53;
    if (splits_ != before.splits_) return std::nullopt;
    if (hasPositionsOf(before)) return 0.0;
    if (!(travel_ > before.travel_)) return std::nullopt;
    return travel_ - before.travel_ + 4 * kRoundoff * travel_;
  }

 private:
  std::uint64_t splits_ = 0, positions_ = 0;
  double travel_ = 0.0;  // [m]
};

}  // namespace organ_collision::core
