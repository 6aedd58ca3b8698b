#pragma once

#include <array>
#include <cstdint>

#include "organ_collision/core/ids.h"
#include "organ_collision/core/wide_node.h"

namespace organ_collision::core {

/// Beyond this many sizes of the organ, single precision tells its parts no longer apart.
constexpr double kFar = 8.0;

constexpr VertexId kNoVertex{~0U};
constexpr std::uint32_t kNoLeaf = ~0U;

/// A node on the way down to the first packet, and what it holds besides.
struct alignas(32) PassedNode {
  LaneFloats squares;  ///< of the lanes' bounds; infinite where it went on
  const WideNode* node;
};

/// Room for the sets that wait while a tree is searched: as many as it has, and kLaneCount more.
struct FrontierRoom {
  PassedNode* passed;  ///< one to a level
  std::uint32_t* nodes;
  std::uint32_t* packets;
  float* squares;  ///< of the packets' bounds
};

/// The packets that may hold what is nearest to a tip while it moves. Bounds are kept as they were
/// plus the drift of their time, so that less the drift of today they still hold.
struct Followed {
  static constexpr std::uint32_t kMost = 64;
  alignas(64) std::array<float, kMost> bounds = {};  ///< of the packets' triangles, the least
  alignas(64) std::array<LaneFloats, kMost> lanes;   ///< of each triangle
  /// The drift up to which each triangle surely ties at tied_vertex; below zero if that is not
  /// known.
  alignas(64) std::array<LaneFloats, kMost> tied_until;
  std::array<std::uint32_t, kMost> packets;
  std::uint32_t count = 0;
  std::uint32_t nearest = kNoLeaf;   ///< of the last query, also of one that followed nothing
  VertexId tied_vertex = kNoVertex;  ///< of `nearest`, for which tied_until holds; or for none
  double clear;                      ///< of all else, the least
  double drift;  ///< so far at most have tip and mesh moved towards each other since the walk
};

/// One search: what it is given, what it knows, what it has found. Lengths in the unit frame.
struct Search {
  const WideNode* nodes;
  const TrianglePacket* packets;
  const Corners* leaf_corners;  ///< of their triangles, by leaf
  bool fetches;  ///< they are so many that it is worth while to fetch early what will be read
  std::array<std::array<double, 3>, 3> corners;  ///< of the tip: the first; the first two; all
  std::uint32_t corner_count = 0;
  double farthest = 0.0;      ///< of the corners' coordinates, the largest magnitude
  std::uint32_t leaves_left;  ///< that may be looked at
  bool sparing;  ///< leaves are few: of a packet only those are looked at whose own boxes matter
  FrontierRoom room;
  bool dives = true;        ///< to find something near first, as nothing is known that is
  double share, allowance;  ///< what is farther than best * share or best - allowance is left out

  /// Measures a triangle exactly, and lowers `best` if it is the nearest so far. Returns its
  /// distance, or 0 where it matters no more.
  double (*measure)(Search& search, std::uint32_t leaf);
  /// How far the tip may move while a triangle is known not to be nearer than the nearest vertex so
  /// far, which it has too, nor to come before the triangle named for it; negative if it is not.
  double (*roomOfTie)(const Search& search, std::uint32_t leaf);
  double best;              ///< the nearest triangle is not farther
  std::uint32_t best_leaf;  ///< of the nearest that was measured: of several the first
  VertexId best_vertex;     ///< the nearest point of that, if it is one

  double slack = 0.0;            ///< sets up to this much farther than the best are followed, too
  Followed* followed = nullptr;  ///< where to put the packets looked at, or null

  double unopened;  ///< what was not looked at is not nearer; infinite if it cannot be nearest
  std::uint32_t bounds = 0, triangles = 0;  ///< boxes and triangles looked at
};

}  // namespace organ_collision::core
