#pragma once

#include <tbb/task_arena.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "node/background_thread.h"
#include "node/signal.h"
#include "node/snapshots.h"
#include "node/update_policy.h"
#include "node/vertex_moves.h"
#include "node/wear.h"
#include "organ_collision/core/collision_mesh.h"
#include "organ_collision/core/nearest_triangle.h"

namespace organ_collision::node {

/// How the caller wants the hierarchy updated; the numbers are those of the service UpdateMesh.
enum class UpdateMode : std::uint8_t { kAuto, kRefit, kRebuild };

/// An organ that deforms while it is asked. A query takes the snapshot of the moment and keeps it
/// as long as it needs; an update makes the next one beside it and swaps, so queries never wait and
/// never see half a mesh. Splits are made anew on a thread in the background, from a snapshot too;
/// what moves meanwhile is caught up with before the swap. Updates are refused whole
/// (std::invalid_argument naming the reason): the former mesh goes on answering.
class Organ {
 public:
  struct Counters {
    std::uint64_t updates_merged = 0;  ///< joined with a later one before they were applied
    std::uint64_t updates_lost = 0;    ///< refused, dropped by a queue, overtaken by a topology
  };

  /// What an update did.
  struct Applied {
    std::uint32_t version;  ///< of the geometry that it led to
    Action action;
    std::string reason;  ///< why so
    double duration;     ///< [s]
  };

  Organ(std::string name, std::string frame, core::TriangleMesh mesh);

  const std::string& name() const { return name_; }
  const std::string& frame() const { return frame_; }
  /// Throws std::invalid_argument naming both unless the mesh is in that frame.
  void requireFrame(const std::string& frame) const;
  std::shared_ptr<const OrganSnapshot> snapshot() const { return snapshots_.current(); }
  Counters counters() const;

  /// Moves vertices, all or the few, by a partial or full refit, whichever is cheaper; none: only
  /// the hierarchy is updated, if `mode` says so. kRebuild returns when the splits have been made
  /// anew after the moves; no query waits for that. Every snapshot taken after it returns has
  /// what it did, and whatever was enqueued before it was called. `expected_version` 0 means any,
  /// else it must be the current one. Throws what kept it from making the splits it was asked for;
  /// then the moves stay.
  Applied update(VertexMoves moves, UpdateMode mode, std::uint32_t expected_version);

  /// Takes another mesh, after a cut say. Its hierarchy is built before anybody has to wait for it.
  Applied replace(core::TriangleMesh mesh, std::uint32_t expected_version);

  /// Adds to what waits for work(), vertex by vertex: later positions win, nothing else is lost.
  /// Does not wait for an update under way.
  void enqueue(VertexMoves moves);

  /// Counts updates that a queue dropped, or that were refused before they were tried or by
  /// enqueue().
  void countLostUpdates(std::uint64_t count);

  /// Does what waits: moves enqueued, a rebuild that is ready or due. True if that changed what
  /// snapshot() tells.
  bool work();

  /// Raised from now on whenever there is something for work(). REQUIRES: no other thread uses the
  /// organ yet.
  void setSignal(std::shared_ptr<Signal> signal) { signal_ = std::move(signal); }

  /// Counts a query that was answered, for the decision when to rebuild; `tip` [m] is what was
  /// nearest to the organ, in its frame.
  void account(const Eigen::Vector3d& tip, const core::Accuracy& accuracy);

  /// Work per query of late against that of the hierarchy as it was built; 1 before it was
  /// measured.
  double costRatio() const { return cost_ratio_; }

  /// The splits: how often they were made, why the last time, what speaks for doing it again, and
  /// why that could not be done in the background; empty where it could.
  struct Builds {
    std::uint64_t count;
    std::string reason;
    std::string figures;
    std::string failure;
  };
  Builds builds() const;

 private:
  struct Build;
  struct Rebuild;
  struct Refit {
    Action action;
    std::string figures;  // why this and not another
  };
  using Lock = std::unique_lock<std::mutex>;

  Organ(std::string name, std::string frame, Build loaded);

  void requireVersion(std::uint32_t expected_version) const;
  void addToPending(VertexMoves moves);
  Applied applyWithPending(VertexMoves moves);
  bool applyPending();
  Applied applyOrCount(VertexMoves moves, const std::string& origin, std::uint64_t streamed);
  Applied applyMoves(VertexMoves moves, const std::string& origin);
  Refit catchUp(OrganSnapshot& state, VertexMoves moves);
  void publishBuilt(OrganSnapshot next, double cost);
  void refitAsBuilt();
  void rebuildIfDue(std::string& told);
  void considerRebuild();
  void startRebuild(const std::string& reason);
  bool finishRebuild();
  void rebuildAndWait(Lock& building);

  const std::string name_;
  const std::string frame_;
  const std::shared_ptr<BackgroundThread> background_ = BackgroundThread::shared();
  std::shared_ptr<Signal> signal_ = std::make_shared<Signal>();

  Snapshots snapshots_;
  RecentQuestions questions_;
  std::atomic<double> cost_ratio_{1.0};

  mutable std::mutex queue_mutex_;  // of the two below; never held while building
  PendingMoves pending_;
  Counters counters_;

  mutable std::mutex building_;  // of all below; held by whoever makes the next snapshot
  MoveLog log_;
  tbb::task_arena alone_{1};  // refits: the other processors are there for queries
  RefitPolicy refit_policy_;
  RebuildPolicy rebuild_policy_;
  std::shared_ptr<const OrganSnapshot> as_built_;  // the first one with the current splits, or,
                                                   // once wear was measured, that one refitted
  std::shared_ptr<Rebuild> rebuild_;               // under way, or ready
  std::string rebuild_failure_;                    // of the last one, if it failed
  std::uint64_t rebuilds_asked_ = 0;
  std::uint64_t rebuilds_served_ = 0;  // of those asked for, in order
};

using Organs = std::vector<std::unique_ptr<Organ>>;  // in the scene's order

/// Of each organ, so that all that is answered at once is of one version.
using OrganSnapshots = std::vector<std::shared_ptr<const OrganSnapshot>>;
OrganSnapshots snapshotsOf(const Organs& organs);

/// The only organ needs no name. Throws std::invalid_argument naming those that there are.
Organ& organNamed(const Organs& organs, const std::string& name);

}  // namespace organ_collision::node
