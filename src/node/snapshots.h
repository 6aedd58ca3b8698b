#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "organ_collision/core/collision_mesh.h"

namespace organ_collision::node {

/// What last happened to a mesh; the numbers are those of the message MeshInfo.
enum class Action : std::uint8_t { kLoad, kRefit, kPartialRefit, kRebuild, kNone };

/// One state of an organ. Queries read it, nobody changes it.
struct OrganSnapshot {
  core::CollisionMesh organ;
  std::uint32_t version;  ///< accepted geometry, counted from 1
  Action last_action;
  std::string reason;           ///< of that action
  double last_duration;         ///< [s] that it took
  std::uint64_t hierarchy = 1;  ///< number of the build that its splits come from
  double travel = 0.0;  ///< [m] sum, over the versions since, of the farthest that a vertex moved;
                        ///< rounded up
};

/// The state that queries read, and former ones to write the next one into: to bring a former one
/// up to date costs less than a copy. One thread at a time writes; any number reads.
class Snapshots {
 public:
  explicit Snapshots(OrganSnapshot first);

  /// Locks for a pointer's copy.
  std::shared_ptr<const OrganSnapshot> current() const;

  /// A state with the current one's splits, but perhaps an older version's positions: a former one
  /// that nobody reads any more or, where there is none, a copy of the current one.
  std::unique_ptr<OrganSnapshot> writable();

  /// Every later current() is `next`. The former one comes back when its last reader lets it go.
  /// Or throws std::bad_alloc, and nothing is published.
  std::shared_ptr<const OrganSnapshot> publish(std::unique_ptr<OrganSnapshot> next);

  /// Frees former states that cannot be of use: those of another mesh, and of others the oldest.
  /// For the thread that writes; readers, which come back with more of them, never free.
  void trim();

 private:
  /// Former states that nobody reads.
  class Shelf {
   public:
    /// Where there is no memory to note it, it is freed.
    void put(std::unique_ptr<OrganSnapshot> spare);
    /// The latest of the newest splits.
    std::unique_ptr<OrganSnapshot> take();
    /// Frees those of other meshes than `topology`'s, and what is more than two could use.
    void trim(const core::MeshTopology& topology);

   private:
    std::mutex mutex_;  // held for pointers' copies: who puts may be a query
    std::vector<std::unique_ptr<OrganSnapshot>> spares_;
  };

  const std::shared_ptr<Shelf> shelf_ = std::make_shared<Shelf>();  // its snapshots hold it too
  mutable std::mutex mutex_;
  std::shared_ptr<const OrganSnapshot> current_;
};

}  // namespace organ_collision::node
