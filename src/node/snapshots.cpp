#include "node/snapshots.h"

#include <algorithm>
#include <new>
#include <tuple>
#include <utility>

namespace organ_collision::node {
namespace {

constexpr std::size_t kSpares = 2;  // one is written while a reader lingers on another

bool isOlder(const std::unique_ptr<OrganSnapshot>& first,
             const std::unique_ptr<OrganSnapshot>& second) {
  return std::tie(first->hierarchy, first->version) < std::tie(second->hierarchy, second->version);
}

}  // namespace

void Snapshots::Shelf::put(std::unique_ptr<OrganSnapshot> spare) {
  const std::lock_guard<std::mutex> lock(mutex_);
  try {
    spares_.push_back(std::move(spare));
  } catch (const std::bad_alloc&) {  // freed when the lock is let go
  }
}

std::unique_ptr<OrganSnapshot> Snapshots::Shelf::take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (spares_.empty()) return nullptr;
  std::sort(spares_.begin(), spares_.end(), isOlder);
  std::unique_ptr<OrganSnapshot> latest = std::move(spares_.back());
  spares_.pop_back();
  return latest;
}

void Snapshots::Shelf::trim(const core::MeshTopology& topology) {
  while (true) {
    std::unique_ptr<OrganSnapshot> useless;  // freed after the lock
    const std::lock_guard<std::mutex> lock(mutex_);
    auto found = std::find_if(spares_.begin(), spares_.end(), [&topology](const auto& spare) {
      return &spare->organ.topology() != &topology;
    });
    if (found == spares_.end() && spares_.size() > kSpares)
      found = std::min_element(spares_.begin(), spares_.end(), isOlder);
    if (found == spares_.end()) return;
    useless = std::move(*found);
    spares_.erase(found);
  }
}

Snapshots::Snapshots(OrganSnapshot first) {
  publish(std::make_unique<OrganSnapshot>(std::move(first)));
}

std::shared_ptr<const OrganSnapshot> Snapshots::current() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return current_;
}

std::unique_ptr<OrganSnapshot> Snapshots::writable() {
  const std::shared_ptr<const OrganSnapshot> now = current();
  std::unique_ptr<OrganSnapshot> spare = shelf_->take();
  // That of another mesh, which a reader has just let go, would keep its memory.
  if (!spare || &spare->organ.topology() != &now->organ.topology())
    return std::make_unique<OrganSnapshot>(*now);
  if (spare->hierarchy != now->hierarchy) *spare = *now;  // into the memory that it has
  return spare;
}

std::shared_ptr<const OrganSnapshot> Snapshots::publish(std::unique_ptr<OrganSnapshot> next) {
  struct Returning {
    std::shared_ptr<Shelf> shelf;
    std::unique_ptr<OrganSnapshot> state;
    explicit Returning(std::shared_ptr<Shelf> to) : shelf(std::move(to)) {}
    ~Returning() { shelf->put(std::move(state)); }
    Returning(const Returning&) = delete;
    Returning& operator=(const Returning&) = delete;
  };
  const auto returning = std::make_shared<Returning>(shelf_);  // first: nothing below throws
  returning->state = std::move(next);
  std::shared_ptr<const OrganSnapshot> published(returning, returning->state.get());
  std::shared_ptr<const OrganSnapshot> former = published;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    current_.swap(former);
  }
  former.reset();
  trim();
  return published;
}

void Snapshots::trim() { shelf_->trim(current()->organ.topology()); }

}  // namespace organ_collision::node
