#include "node/snapshots.h"

#include <algorithm>
#include <iterator>
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
  spares_.push_back(std::move(spare));
}

std::unique_ptr<OrganSnapshot> Snapshots::Shelf::take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (spares_.empty()) return nullptr;
  std::sort(spares_.begin(), spares_.end(), isOlder);
  std::unique_ptr<OrganSnapshot> latest = std::move(spares_.back());
  spares_.pop_back();
  return latest;
}

void Snapshots::Shelf::trim() {
  std::vector<std::unique_ptr<OrganSnapshot>> too_many;  // freed after the lock
  const std::lock_guard<std::mutex> lock(mutex_);
  if (spares_.size() <= kSpares) return;
  std::sort(spares_.begin(), spares_.end(), isOlder);
  const auto kept = spares_.end() - kSpares;
  std::move(spares_.begin(), kept, std::back_inserter(too_many));
  spares_.erase(spares_.begin(), kept);
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
  // That of another mesh would keep its memory, however large that was.
  if (!spare || &spare->organ.topology() != &now->organ.topology())
    return std::make_unique<OrganSnapshot>(*now);
  if (spare->hierarchy != now->hierarchy) *spare = *now;  // into the memory that it has
  return spare;
}

std::shared_ptr<const OrganSnapshot> Snapshots::publish(std::unique_ptr<OrganSnapshot> next) {
  const auto put_back = [shelf = shelf_](OrganSnapshot* former) {
    shelf->put(std::unique_ptr<OrganSnapshot>(former));
  };
  std::shared_ptr<const OrganSnapshot> published(
      std::shared_ptr<OrganSnapshot>(next.release(), put_back));
  std::shared_ptr<const OrganSnapshot> former = published;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    current_.swap(former);
  }
  former.reset();
  shelf_->trim();
  return published;
}

}  // namespace organ_collision::node
