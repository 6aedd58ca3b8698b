#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "organ_collision/core/collision_mesh.h"
#include "organ_collision/core/nearest_triangle.h"

namespace organ_collision::node {

/// What last happened to a mesh; the numbers are those of the message MeshInfo.
enum class Action : std::uint8_t { kLoad, kRefit, kPartialRefit, kRebuild, kNone };

/// How the caller wants the hierarchy updated; the numbers are those of the service UpdateMesh.
enum class UpdateMode : std::uint8_t { kAuto, kRefit, kRebuild };

/// One state of an organ. Queries read it, nobody changes it.
struct OrganSnapshot {
  core::CollisionMesh organ;
  std::uint32_t version;  ///< accepted geometry, counted from 1
  Action last_action;
  std::string reason;    ///< of that action
  double last_duration;  ///< [s] that it took
};

/// New positions of some vertices.
struct VertexMoves {
  std::vector<std::uint32_t> vertices;  ///< empty: all, in order
  core::Points positions;               ///< [m] of each, in the organ's frame
};

/// An organ that deforms while it is asked. A query takes the snapshot of the moment and keeps it
/// as long as it needs; an update makes the next one beside it and swaps, so queries never wait and
/// never see half a mesh. Updates are refused whole (std::invalid_argument naming the reason): the
/// former mesh goes on answering.
class Organ {
 public:
  struct Counters {
    std::uint64_t updates_merged = 0;  ///< joined with a later one before they were applied
    std::uint64_t updates_lost = 0;    ///< refused
  };

  Organ(std::string name, std::string frame, core::TriangleMesh mesh);

  const std::string& name() const { return name_; }
  const std::string& frame() const { return frame_; }
  std::shared_ptr<const OrganSnapshot> snapshot() const;
  Counters counters() const;

  /// Moves vertices before it returns; none: only the hierarchy is updated, if `mode` says so.
  /// Whatever was enqueued before is applied before. `expected_version` 0 means any, else it must
  /// be the current one.
  std::shared_ptr<const OrganSnapshot> update(const VertexMoves& moves, UpdateMode mode,
                                              std::uint32_t expected_version);

  /// Takes another mesh, after a cut say, in the same order of events as update().
  std::shared_ptr<const OrganSnapshot> replace(core::TriangleMesh mesh,
                                               std::uint32_t expected_version);

  /// Adds to what waits for applyEnqueued(), vertex by vertex: later positions win, nothing else is
  /// lost. Does not wait for an update under way.
  void enqueue(const VertexMoves& moves);

  /// Counts an update that was refused before it was tried or by enqueue().
  void countLostUpdate();

  /// Refits to all that was enqueued; false if nothing was.
  bool applyEnqueued();

  /// Adds a query's work to the account from which costRatio() is made.
  void account(const OrganSnapshot& snapshot, const core::SearchWork& work);

  /// Mean work per query of late against that of the fresh hierarchy; 1 before any query of either.
  double costRatio() const;

 private:
  struct Account {
    std::uint64_t queries = 0;
    std::uint64_t work = 0;
  };

  bool applyEnqueuedWhileBuilding();
  core::Points accept(const VertexMoves& moves);
  void requireVersion(std::uint32_t expected_version) const;
  std::shared_ptr<const OrganSnapshot> publish(OrganSnapshot next);
  void openAccount(Action action);

  const std::string name_;
  const std::string frame_;

  std::mutex building_;  // held by whoever makes the next snapshot

  mutable std::mutex queue_mutex_;  // of the five below; never held while building
  core::Points latest_;             // positions with all that was accepted, applied or not
  bool enqueued_ = false;           // latest_ is ahead of the snapshot
  Counters counters_;

  mutable std::mutex snapshot_mutex_;  // held for a pointer's copy
  std::shared_ptr<const OrganSnapshot> snapshot_;

  mutable std::mutex account_mutex_;
  Account fresh_, last_,
      current_;  // while as built; in the last period with queries; since the last action
};

using Organs = std::vector<std::unique_ptr<Organ>>;  // in the scene's order

}  // namespace organ_collision::node
