#include "node/organ.h"

#include <malloc.h>

#include <chrono>
#include <cmath>
#include <exception>
#include <future>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "node/stopwatch.h"

namespace organ_collision::node {

/// A hierarchy that was built, and what the policies must know of it.
struct Organ::Build {
  explicit Build(core::TriangleMesh mesh)
      : organ(alone.execute([&mesh] { return core::CollisionMesh(std::move(mesh)); })) {
    cost = watch.elapsed();
    core::CollisionMesh copy = organ;  // that it is refitted leaves boxes less close
    const double copied = watch.elapsed();
    alone.execute([&] { copy.refit(organ.mesh().positions()); });
    refit_cost = watch.elapsed() - copied;
  }

  tbb::task_arena alone{1};  // the other processors are there for queries
  CostStopwatch watch;
  core::CollisionMesh organ;
  double cost;        // [s]
  double refit_cost;  // [s] of a full one
};

/// Splits that are made anew in the background. Until `done`, the background thread's alone.
struct Organ::Rebuild {
  Rebuild(std::shared_ptr<const OrganSnapshot> from, std::string why, std::uint64_t to_serve)
      : source(std::move(from)),
        reason(std::move(why)),
        serves(to_serve),
        done(finished.get_future()) {}

  void run() {
    try {
      const Stopwatch watch;
      const CostStopwatch cost_watch;
      organ = source->organ;
      organ->rebuild();
      duration = watch.elapsed();
      cost = cost_watch.elapsed();
      finished.set_value();
    } catch (...) {
      finished.set_exception(std::current_exception());
    }
  }

  std::shared_ptr<const OrganSnapshot> source;
  const std::string reason;
  const std::uint64_t serves;  // the last request that it serves
  std::optional<core::CollisionMesh> organ;
  double duration = 0.0;  // [s]
  double cost = 0.0;      // [s] of that on a processor
  std::promise<void> finished;
  const std::shared_future<void> done;
  std::exception_ptr failure;  // of it, or of swapping it in; under building_
};

Organ::Organ(std::string name, std::string frame, core::TriangleMesh mesh)
    : Organ(std::move(name), std::move(frame), Build(std::move(mesh))) {}

Organ::Organ(std::string name, std::string frame, Build loaded)
    : name_(std::move(name)),
      frame_(std::move(frame)),
      snapshots_({std::move(loaded.organ), 1, Action::kLoad, "loaded", loaded.cost}),
      pending_(snapshot()->organ.mesh().positions().size()),
      log_(snapshot()->organ.mesh().positions().size(), 1),
      refit_policy_(loaded.refit_cost),
      rebuild_policy_(loaded.cost),
      as_built_(snapshot()) {}

Organ::Counters Organ::counters() const {
  const std::lock_guard<std::mutex> lock(queue_mutex_);
  return counters_;
}

void Organ::requireFrame(const std::string& frame) const {
  if (frame == frame_) return;
  throw std::invalid_argument("frame_id is '" + frame + "', but the mesh of " + name_ + " is in '" +
                              frame_ + "'");
}

void Organ::countLostUpdates(std::uint64_t count) {
  const std::lock_guard<std::mutex> lock(queue_mutex_);
  counters_.updates_lost += count;
}

void Organ::enqueue(VertexMoves moves) {
  {
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    addToPending(std::move(moves));
  }
  signal_->raise();
}

/// REQUIRES: queue_mutex_ is held.
void Organ::addToPending(VertexMoves moves) {
  const bool merges = !pending_.empty();
  pending_.add(std::move(moves));
  if (merges) ++counters_.updates_merged;
}

/// With what was streamed in the meantime.
Organ::Applied Organ::applyWithPending(VertexMoves moves) {
  std::uint64_t streamed = 0;
  {
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    streamed = pending_.empty() ? 0 : 1;
    addToPending(std::move(moves));
    moves = pending_.take();
  }
  return applyOrCount(std::move(moves), "", streamed);
}

/// Of the moves, `streamed` updates are counted as lost where it throws.
Organ::Applied Organ::applyOrCount(VertexMoves moves, const std::string& origin,
                                   std::uint64_t streamed) {
  try {
    return applyMoves(std::move(moves), origin);
  } catch (const std::exception&) {  // memory, most likely
    countLostUpdates(streamed);
    throw;
  }
}

void Organ::requireVersion(std::uint32_t expected_version) const {
  const std::uint32_t version = snapshot()->version;
  if (expected_version == 0 || expected_version == version) return;
  throw std::invalid_argument("expected_version is " + std::to_string(expected_version) +
                              ", but the mesh of " + name_ + " is at version " +
                              std::to_string(version));
}

Organ::Applied Organ::update(VertexMoves moves, UpdateMode mode, std::uint32_t expected_version) {
  const Stopwatch watch;
  Lock building(building_);
  finishRebuild();
  applyPending();
  requireVersion(expected_version);
  Applied applied = {snapshot()->version, Action::kNone, "no vertex moved", 0.0};
  if (!moves.none()) applied = applyWithPending(std::move(moves));
  if (mode == UpdateMode::kAuto) rebuildIfDue(applied.reason);
  if (mode == UpdateMode::kRebuild) {
    rebuildAndWait(building);
    applied.action = Action::kRebuild;
    applied.reason = "asked for";
  }
  applied.duration = watch.elapsed();
  return applied;
}

Organ::Applied Organ::replace(core::TriangleMesh mesh, std::uint32_t expected_version) {
  const Stopwatch watch;
  requireVersion(expected_version);  // before anybody works in vain
  Build built(std::move(mesh));
  const Lock building(building_);
  applyPending();
  requireVersion(expected_version);
  const std::uint32_t version = snapshot()->version + 1;
  const std::size_t vertex_count = built.organ.mesh().positions().size();
  PendingMoves pending(vertex_count);
  MoveLog log(vertex_count, version);
  Applied applied = {version, Action::kRebuild, "new topology", watch.elapsed()};
  publishBuilt({std::move(built.organ), version, applied.action, applied.reason, applied.duration,
                snapshot()->hierarchy + 1},
               built.cost);
  // The new mesh is there, and nothing below needs memory.
  snapshots_.trim();  // of the former one nothing is needed here any more
#if defined(__GLIBC__)
  malloc_trim(0);  // which else keeps most of it, and of each topology more
#endif
  log_ = std::move(log);
  refit_policy_ = RefitPolicy(built.refit_cost);
  const std::lock_guard<std::mutex> lock(queue_mutex_);
  if (!pending_.empty()) ++counters_.updates_lost;  // it was meant for the former topology
  pending_ = std::move(pending);
  return applied;
}

bool Organ::work() {
  const Lock building(building_);
  const bool rebuilt = finishRebuild();
  const bool moved = applyPending();
  std::string told;
  rebuildIfDue(told);
  snapshots_.trim();  // of what a reader has let go since
  return rebuilt || moved;
}

bool Organ::applyPending() {
  VertexMoves moves;
  {
    const std::lock_guard<std::mutex> lock(queue_mutex_);
    moves = pending_.take();
  }
  if (moves.none()) return false;
  applyOrCount(std::move(moves), "streamed: ", 1);
  return true;
}

Organ::Applied Organ::applyMoves(VertexMoves moves, const std::string& origin) {
  const Stopwatch watch;
  const std::shared_ptr<const OrganSnapshot> now = snapshot();
  const double travel = now->travel + farthest(moves, now->organ.mesh().positions());
  const std::size_t count = moves.positions.size();
  std::vector<core::VertexId> vertices = moves.vertices;
  std::unique_ptr<OrganSnapshot> next = snapshots_.writable();
  const Refit refit = catchUp(*next, std::move(moves));
  next->version = now->version + 1;
  next->travel = std::nextafter(travel, std::numeric_limits<double>::infinity());
  next->last_action = refit.action;
  next->reason = origin + std::to_string(count) + " of " +
                 std::to_string(next->organ.mesh().positions().size()) + " vertices moved" +
                 refit.figures;
  next->last_duration = watch.elapsed();
  log_.record(next->version, std::move(vertices));
  Applied applied = {next->version, next->last_action, next->reason, next->last_duration};
  snapshots_.publish(std::move(next));  // nothing after it throws
  return applied;
}

/// Takes `state`, of whatever version, to the latest positions and from there by `moves`.
Organ::Refit Organ::catchUp(OrganSnapshot& state, VertexMoves moves) {
  const std::shared_ptr<const OrganSnapshot> now = snapshot();
  const core::Points& latest = now->organ.mesh().positions();
  const CostStopwatch watch;
  VertexMoves missed = log_.since(state.version, std::move(moves), latest);
  if (missed.none()) return {Action::kNone, ""};
  if (missed.whole()) {
    alone_.execute([&] { state.organ.refit(std::move(missed.positions)); });
    refit_policy_.recordFull(std::nullopt, watch.elapsed());
    return {Action::kRefit, ""};
  }
  const std::size_t count = missed.vertices.size();
  const std::string figures = ": " + refit_policy_.figures(count);
  if (refit_policy_.prefersPartial(count)) {
    alone_.execute([&] { state.organ.refit(missed.vertices, missed.positions); });
    refit_policy_.recordPartial(count, watch.elapsed());
    return {Action::kPartialRefit, figures};
  }
  alone_.execute([&] { state.organ.refit(moved(latest, missed)); });
  refit_policy_.recordFull(count, watch.elapsed());
  return {Action::kRefit, figures};
}

void Organ::publishBuilt(OrganSnapshot next, double cost) {
  as_built_ = snapshots_.publish(std::make_unique<OrganSnapshot>(std::move(next)));
  rebuild_policy_.recordRebuild(cost);
  rebuild_failure_.clear();
  cost_ratio_ = 1.0;
}

void Organ::account(const Eigen::Vector3d& tip, const core::Accuracy& accuracy) {
  if (questions_.add({tip, accuracy})) signal_->raise();
}

/// Once, where it was: refits draw boxes less closely than builds do, which is no wear.
void Organ::refitAsBuilt() {
  if (as_built_->last_action == Action::kRefit) return;
  auto refitted = std::make_shared<OrganSnapshot>(*as_built_);
  alone_.execute([&] { refitted->organ.refit(as_built_->organ.mesh().positions()); });
  refitted->last_action = Action::kRefit;
  as_built_ = std::move(refitted);
}

/// Adds to `told` what is done. That this fails undoes no update: builds() tells it.
void Organ::rebuildIfDue(std::string& told) {
  try {
    considerRebuild();
    if (rebuild_) told += "; rebuilding in the background: " + rebuild_->reason;
  } catch (const std::exception& error) {  // memory, most likely
    rebuild_failure_ = error.what();
  }
}

void Organ::considerRebuild() {
  const std::optional<RecentQuestions::Asked> asked = questions_.take();
  const std::shared_ptr<const OrganSnapshot> now = snapshot();
  if (!asked || now->version == as_built_->version) return;
  refitAsBuilt();
  const std::optional<Wear> wear = measureWear(asked->sample, now->organ, as_built_->organ);
  if (!wear) return;
  cost_ratio_ = wear->work_ratio;
  rebuild_policy_.recordQueries(asked->count, *wear);
  if (rebuild_policy_.isDue()) startRebuild(rebuild_policy_.figures());
}

/// Unless one is under way.
void Organ::startRebuild(const std::string& reason) {
  if (rebuild_) return;
  auto rebuild = std::make_shared<Rebuild>(snapshot(), reason, rebuilds_asked_);
  background_->run([rebuild, signal = signal_] {
    rebuild->run();
    signal->raise();
  });
  rebuild_ = std::move(rebuild);  // nobody waits for one that nobody makes
}

/// Swaps in a rebuild that is ready; false if none is, or if it failed, which is nobody's fault who
/// comes by.
bool Organ::finishRebuild() {
  using std::chrono::seconds;
  if (!rebuild_ || rebuild_->done.wait_for(seconds(0)) != std::future_status::ready) return false;
  const Stopwatch watch;
  const std::shared_ptr<Rebuild> rebuilt = std::exchange(rebuild_, nullptr);
  // Let go here: where queries let go of theirs, the background thread must not.
  const std::shared_ptr<const OrganSnapshot> source = std::move(rebuilt->source);
  try {
    rebuilt->done.get();
    const std::shared_ptr<const OrganSnapshot> now = snapshot();
    if (&source->organ.topology() != &now->organ.topology()) return false;  // replaced meanwhile
    OrganSnapshot next = {
        std::move(*rebuilt->organ), source->version, Action::kRebuild, rebuilt->reason, 0.0,
        now->hierarchy + 1};
    catchUp(next, {});
    next.version = now->version;
    next.last_duration = rebuilt->duration + watch.elapsed();
    publishBuilt(std::move(next), rebuilt->cost);
  } catch (const std::exception& error) {  // memory, most likely
    rebuilt->failure = std::current_exception();
    rebuild_failure_ = error.what();
    return false;
  }
  rebuilds_served_ = rebuilt->serves;
  return true;
}

/// Lets go of the lock while waiting. Throws what went wrong.
void Organ::rebuildAndWait(Lock& building) {
  const std::uint64_t request = ++rebuilds_asked_;
  while (rebuilds_served_ < request) {
    startRebuild("asked for");
    const std::shared_ptr<Rebuild> rebuild = rebuild_;
    building.unlock();
    rebuild->done.wait();
    building.lock();
    finishRebuild();
    if (rebuild->failure) std::rethrow_exception(rebuild->failure);
  }
}

Organ::Builds Organ::builds() const {
  const Lock building(building_);
  return {as_built_->hierarchy, as_built_->reason, rebuild_policy_.figures(), rebuild_failure_};
}

OrganSnapshots snapshotsOf(const Organs& organs) {
  OrganSnapshots snapshots;
  snapshots.reserve(organs.size());
  for (const auto& organ : organs) snapshots.push_back(organ->snapshot());
  return snapshots;
}

Organ& organNamed(const Organs& organs, const std::string& name) {
  if (name.empty() && organs.size() == 1) return *organs.front();
  std::string known;
  for (const auto& organ : organs) {
    if (organ->name() == name) return *organ;
    known += (known.empty() ? "" : ", ") + organ->name();
  }
  throw std::invalid_argument(
      (name.empty() ? "which organ? known: " : "there is no organ '" + name + "'; known: ") +
      known);
}

}  // namespace organ_collision::node
