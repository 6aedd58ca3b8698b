#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

#include "organ_collision/core/ids.h"
#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::node {

/// New positions of some vertices of an organ.
struct VertexMoves {
  std::vector<core::VertexId> vertices;  ///< empty: all, in order
  core::Points positions;                ///< [m] of each, in the organ's frame

  bool none() const { return vertices.empty() && positions.empty(); }
  bool whole() const { return vertices.empty() && !positions.empty(); }
};

/// `positions` after the moves. REQUIRES: the moves fit.
core::Points moved(core::Points positions, const VertexMoves& moves);

/// The farthest that a vertex is moved from `positions` [m], rounded up. REQUIRES: the moves fit.
double farthest(const VertexMoves& moves, const core::Points& positions);

/// Some vertices, in the order in which they came. All takes constant time, clear() too. Source: P.
/// Briggs and L. Torczon, "An efficient representation for sparse sets" (1993).
class VertexSet {
 public:
  /// Of vertices 0 to vertex_count - 1.
  explicit VertexSet(std::size_t vertex_count) : places_(vertex_count, 0) {}

  std::size_t vertexCount() const { return places_.size(); }
  bool contains(core::VertexId vertex) const {
    const std::uint32_t place = places_[core::index(vertex)];
    return place < members_.size() && members_[place] == vertex;
  }
  /// REQUIRES: contains(vertex).
  std::size_t place(core::VertexId vertex) const { return places_[core::index(vertex)]; }
  /// Room for so many more: then as many insert() do not throw.
  void makeRoom(std::size_t more);
  /// False if it is in already.
  bool insert(core::VertexId vertex);
  void clear() { members_.clear(); }

 private:
  std::vector<std::uint32_t> places_;  // of each vertex in members_; of any other, anything
  std::vector<core::VertexId> members_;
};

/// Moves that wait, merged per vertex: a later position takes an earlier one's place, and nothing
/// else is lost.
class PendingMoves {
 public:
  explicit PendingMoves(std::size_t vertex_count)
      : waiting_set_(vertex_count), named_(vertex_count) {}

  bool empty() const { return waiting_.none(); }

  /// Throws std::invalid_argument naming what does not fit, and changes nothing: not as many
  /// positions as vertices, a vertex that is not there or is named twice, a position that is not
  /// usable. Or throws std::bad_alloc, and changes nothing. Costs what the moves hold, whatever the
  /// organ's size.
  void add(VertexMoves moves);

  /// All that waits; then nothing waits.
  VertexMoves take();

 private:
  void requireFitting(const VertexMoves& moves);

  VertexMoves waiting_;
  VertexSet waiting_set_;  // the vertices of waiting_, in step, unless it is whole
  VertexSet named_;        // those of the moves that are looked at
};

/// Which vertices moved in the latest versions, so that an older state can catch up.
class MoveLog {
 public:
  /// Begins at `version`.
  MoveLog(std::size_t vertex_count, std::uint32_t version)
      : reaches_back_to_(version), seen_(vertex_count) {}

  /// Moves of these vertices (empty: of all) led to `version`, or would have, had there been
  /// memory. REQUIRES: not earlier than all before.
  void record(std::uint32_t version, std::vector<core::VertexId> vertices);

  /// What takes a state of `version` to the latest one, at `latest`, and from there by `moves`.
  /// Whole if the log does not reach back so far: it keeps as many moves as there are vertices.
  VertexMoves since(std::uint32_t version, VertexMoves moves, const core::Points& latest);

 private:
  struct Entry {
    std::uint32_t version;
    std::vector<core::VertexId> vertices;
  };

  std::deque<Entry> entries_;
  std::size_t logged_ = 0;         // vertices in all entries
  std::uint32_t reaches_back_to_;  // the oldest version that can catch up
  VertexSet seen_;
};

}  // namespace organ_collision::node
