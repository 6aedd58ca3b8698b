#include "node/vertex_moves.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace organ_collision::node {
namespace {

template <class Items>
void makeRoomIn(Items& items, std::size_t more) {
  const std::size_t wanted = items.size() + more;
  if (items.capacity() < wanted) items.reserve(std::max(wanted, 2 * items.capacity()));
}

}  // namespace

core::Points moved(core::Points positions, const VertexMoves& moves) {
  if (moves.whole()) return moves.positions;
  for (std::size_t i = 0; i < moves.vertices.size(); ++i)
    positions[core::index(moves.vertices[i])] = moves.positions[i];
  return positions;
}

double farthest(const VertexMoves& moves, const core::Points& positions) {
  double squared = 0.0;
  for (std::size_t i = 0; i < moves.positions.size(); ++i) {
    const std::size_t vertex = moves.whole() ? i : core::index(moves.vertices[i]);
    squared = std::max(squared, (moves.positions[i] - positions[vertex]).squaredNorm());
  }
  return std::sqrt(squared) * (1.0 + 0x1p-50);
}

void VertexSet::makeRoom(std::size_t more) { makeRoomIn(members_, more); }

bool VertexSet::insert(core::VertexId vertex) {
  if (contains(vertex)) return false;
  places_[core::index(vertex)] = static_cast<std::uint32_t>(members_.size());
  members_.push_back(vertex);
  return true;
}

void PendingMoves::requireFitting(const VertexMoves& moves) {
  const std::size_t vertex_count = named_.vertexCount();
  const std::size_t wanted = moves.vertices.empty() ? vertex_count : moves.vertices.size();
  if (moves.positions.size() != wanted) {
    throw std::invalid_argument(std::to_string(moves.positions.size()) + " positions given for " +
                                std::to_string(wanted) + " vertices");
  }
  named_.clear();
  for (const core::VertexId vertex : moves.vertices) {
    const std::size_t number = core::index(vertex);
    if (number >= vertex_count) {
      throw std::invalid_argument("index " + std::to_string(number) +
                                  " names no vertex: there are " + std::to_string(vertex_count));
    }
    if (!named_.insert(vertex))
      throw std::invalid_argument("index " + std::to_string(number) + " is given twice");
  }
  for (std::size_t i = 0; i < moves.positions.size(); ++i) {
    core::requireUsable(moves.positions[i], "vertex",
                        moves.vertices.empty() ? i : core::index(moves.vertices[i]));
  }
}

void PendingMoves::add(VertexMoves moves) {
  requireFitting(moves);
  if (moves.whole()) {
    waiting_ = std::move(moves);
  } else if (waiting_.whole()) {
    waiting_.positions = moved(std::move(waiting_.positions), moves);
  } else {
    const std::size_t most = moves.vertices.size();
    makeRoomIn(waiting_.vertices, most);  // first: nothing below throws
    makeRoomIn(waiting_.positions, most);
    waiting_set_.makeRoom(most);
    for (std::size_t i = 0; i < most; ++i) {
      const core::VertexId vertex = moves.vertices[i];
      if (waiting_set_.insert(vertex)) {
        waiting_.vertices.push_back(vertex);
        waiting_.positions.push_back(moves.positions[i]);
      } else {
        waiting_.positions[waiting_set_.place(vertex)] = moves.positions[i];
      }
    }
  }
}

VertexMoves PendingMoves::take() {
  waiting_set_.clear();
  return std::exchange(waiting_, {});
}

void MoveLog::record(std::uint32_t version, std::vector<core::VertexId> vertices) {
  const auto forget_oldest = [this] {
    reaches_back_to_ = entries_.front().version;
    logged_ -= entries_.front().vertices.size();
    entries_.pop_front();
  };
  const bool whole = vertices.empty();
  entries_.push_back({version, std::move(vertices)});
  logged_ += entries_.back().vertices.size();
  while (!entries_.empty() && (whole || logged_ > seen_.vertexCount())) forget_oldest();
}

VertexMoves MoveLog::since(std::uint32_t version, VertexMoves moves, const core::Points& latest) {
  if (moves.whole()) return moves;
  if (version < reaches_back_to_) return {{}, moved(latest, moves)};
  seen_.clear();
  for (const core::VertexId vertex : moves.vertices) seen_.insert(vertex);
  // From the newest on: of many versions, most often only the last is asked for.
  for (auto entry = entries_.rbegin(); entry != entries_.rend() && entry->version > version;
       ++entry) {
    for (const core::VertexId vertex : entry->vertices) {
      if (!seen_.insert(vertex)) continue;
      moves.vertices.push_back(vertex);
      moves.positions.push_back(latest[core::index(vertex)]);
    }
  }
  return moves;
}

}  // namespace organ_collision::node
