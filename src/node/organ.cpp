#include "node/organ.h"

#include <algorithm>
#include <chrono>
#include <stdexcept>
#include <utility>

namespace organ_collision::node {
namespace {

class Stopwatch {
 public:
  /// [s]
  double elapsed() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void requireFitting(const VertexMoves& moves, std::size_t vertex_count) {
  const std::size_t wanted = moves.vertices.empty() ? vertex_count : moves.vertices.size();
  if (moves.positions.size() != wanted) {
    throw std::invalid_argument(std::to_string(moves.positions.size()) + " positions given for " +
                                std::to_string(wanted) + " vertices");
  }
  std::vector<bool> named(vertex_count, false);
  for (const std::uint32_t vertex : moves.vertices) {
    if (vertex >= vertex_count) {
      throw std::invalid_argument("index " + std::to_string(vertex) +
                                  " names no vertex: there are " + std::to_string(vertex_count));
    }
    if (named[vertex])
      throw std::invalid_argument("index " + std::to_string(vertex) + " is given twice");
    named[vertex] = true;
  }
  for (std::size_t i = 0; i < moves.positions.size(); ++i) {
    core::requireUsable(moves.positions[i], "vertex",
                        moves.vertices.empty() ? i : moves.vertices[i]);
  }
}

/// REQUIRES: the moves fit.
void apply(const VertexMoves& moves, core::Points& positions) {
  if (moves.vertices.empty()) {
    positions = moves.positions;
    return;
  }
  for (std::size_t i = 0; i < moves.vertices.size(); ++i)
    positions[moves.vertices[i]] = moves.positions[i];
}

}  // namespace

Organ::Organ(std::string name, std::string frame, core::TriangleMesh mesh)
    : name_(std::move(name)), frame_(std::move(frame)), latest_(mesh.positions()) {
  const Stopwatch watch;
  OrganSnapshot loaded = {core::CollisionMesh(std::move(mesh)), 1, Action::kLoad, "loaded", 0.0};
  loaded.last_duration = watch.elapsed();
  publish(std::move(loaded));
}

std::shared_ptr<const OrganSnapshot> Organ::snapshot() const {
  const std::lock_guard<std::mutex> lock(snapshot_mutex_);
  return snapshot_;
}

Organ::Counters Organ::counters() const {
  const std::lock_guard<std::mutex> lock(queue_mutex_);
  return counters_;
}

std::shared_ptr<const OrganSnapshot> Organ::publish(OrganSnapshot next) {
  openAccount(next.last_action);
  auto published = std::make_shared<const OrganSnapshot>(std::move(next));
  std::shared_ptr<const OrganSnapshot> former = published;
  const std::lock_guard<std::mutex> lock(snapshot_mutex_);
  snapshot_.swap(former);  // if nobody reads it, it is freed after the lock
  return published;
}

void Organ::requireVersion(std::uint32_t expected_version) const {
  const std::uint32_t version = snapshot()->version;
  if (expected_version == 0 || expected_version == version) return;
  throw std::invalid_argument("expected_version is " + std::to_string(expected_version) +
                              ", but the mesh of " + name_ + " is at version " +
                              std::to_string(version));
}

std::shared_ptr<const OrganSnapshot> Organ::update(const VertexMoves& moves, UpdateMode mode,
                                                   std::uint32_t expected_version) {
  const std::lock_guard<std::mutex> building(building_);
  applyEnqueuedWhileBuilding();
  requireVersion(expected_version);
  const Stopwatch watch;
  OrganSnapshot next = *snapshot();
  const bool moved = !moves.positions.empty();
  if (moved) {
    next.organ.refit(accept(moves));
    ++next.version;
  }
  if (mode == UpdateMode::kRebuild) {
    next.organ.rebuild();
    next.last_action = Action::kRebuild;
    next.reason = "asked for";
  } else {
    next.last_action = moved ? Action::kRefit : Action::kNone;
    next.reason =
        moved ? std::to_string(moves.positions.size()) + " vertices moved" : "no vertex moved";
  }
  next.last_duration = watch.elapsed();
  if (next.last_action == Action::kNone) {
    return std::make_shared<const OrganSnapshot>(std::move(next));
  }
  return publish(std::move(next));
}

std::shared_ptr<const OrganSnapshot> Organ::replace(core::TriangleMesh mesh,
                                                    std::uint32_t expected_version) {
  const std::lock_guard<std::mutex> building(building_);
  applyEnqueuedWhileBuilding();
  requireVersion(expected_version);
  const Stopwatch watch;
  const std::uint32_t version = snapshot()->version + 1;
  core::Points positions = mesh.positions();
  OrganSnapshot next = {core::CollisionMesh(std::move(mesh)), version, Action::kRebuild,
                        "new topology", 0.0};
  next.last_duration = watch.elapsed();
  {
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    latest_ = std::move(positions);
    if (enqueued_) ++counters_.updates_lost;  // it was meant for the former topology
    enqueued_ = false;
  }
  return publish(std::move(next));
}

core::Points Organ::accept(const VertexMoves& moves) {
  const std::lock_guard<std::mutex> lock(queue_mutex_);
  requireFitting(moves, latest_.size());
  apply(moves, latest_);
  enqueued_ = false;  // what came meanwhile is in latest_ too
  return latest_;
}

void Organ::enqueue(const VertexMoves& moves) {
  const std::lock_guard<std::mutex> lock(queue_mutex_);
  requireFitting(moves, latest_.size());
  apply(moves, latest_);
  if (enqueued_) ++counters_.updates_merged;
  enqueued_ = true;
}

void Organ::countLostUpdate() {
  const std::lock_guard<std::mutex> lock(queue_mutex_);
  ++counters_.updates_lost;
}

bool Organ::applyEnqueued() {
  const std::lock_guard<std::mutex> building(building_);
  return applyEnqueuedWhileBuilding();
}

bool Organ::applyEnqueuedWhileBuilding() {
  const Stopwatch watch;
  core::Points positions;
  {
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    if (!enqueued_) return false;
    positions = latest_;
    enqueued_ = false;
  }
  OrganSnapshot next = *snapshot();
  next.organ.refit(std::move(positions));
  ++next.version;
  next.last_action = Action::kRefit;
  next.reason = "streamed";
  next.last_duration = watch.elapsed();
  publish(std::move(next));
  return true;
}

void Organ::account(const OrganSnapshot& snapshot, const core::SearchWork& work) {
  const bool as_built =
      snapshot.last_action == Action::kLoad || snapshot.last_action == Action::kRebuild;
  const std::lock_guard<std::mutex> lock(account_mutex_);
  for (Account* account : {&current_, as_built ? &fresh_ : nullptr}) {
    if (account == nullptr) continue;
    ++account->queries;
    account->work += work.bounds + work.triangles;
  }
}

void Organ::openAccount(Action action) {
  const std::lock_guard<std::mutex> lock(account_mutex_);
  if (current_.queries > 0) last_ = current_;
  current_ = {};
  if (action == Action::kLoad || action == Action::kRebuild) fresh_ = last_ = {};
}

double Organ::costRatio() const {
  const std::lock_guard<std::mutex> lock(account_mutex_);
  const Account& late = current_.queries > 0 ? current_ : last_;
  if (late.queries == 0 || fresh_.queries == 0) return 1.0;
  const auto mean = [](const Account& account) {
    return static_cast<double>(account.work) / static_cast<double>(account.queries);
  };
  return mean(late) / mean(fresh_);
}

}  // namespace organ_collision::node
