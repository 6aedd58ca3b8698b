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

/// A node on the way down to the first packet.
struct alignas(32) PassedNode {
  LaneFloats squares;  ///< of the bounds of its sets; infinite where it went on
  std::uint32_t node;
};

/// Room for the sets that wait while a tree is searched: as many as it has, and kLaneCount more.
struct FrontierRoom {
  PassedNode* passed;  ///< one to a level
  std::uint32_t* nodes;
  std::uint32_t* packets;
  float* squares;  ///< of the packets' bounds
};

/// A node or a packet that was opened. Of what is in each lane a lower bound is kept, which a tip
/// that moves by `m` changes by direction . m at least: between a tip and a convex body lies a
/// plane that keeps them apart.
struct alignas(32) KeptSets {
  LanePoints direction;   ///< not longer than 1, towards the tip
  LaneFloats bound;       ///< with the tip where the front's origin is; infinite: opened, too
  LaneFloats tied_until;  ///< of a packet's triangles: up to which approach each surely ties
                          ///< at Front::tied_vertex; below zero if that is not known
  std::uint32_t opened;   ///< a node, or kPacketBit and a packet
  std::uint32_t within;   ///< lanes that are within reach now, by bits
  std::uint32_t next;     ///< kept set of which some are, in the front; or kNone
  static constexpr std::uint32_t kNone = ~0U;
};

/// What a tracker keeps of a search for the next: all sets of the tree that were reached but not
/// opened, which together hold all triangles, each with a bound that still holds when tip and mesh
/// have moved.
struct Front {
  static constexpr std::uint32_t kMost = 128;
  std::array<KeptSets, kMost> kept;
  std::uint32_t count = 0;           ///< 0: there is no front
  std::uint32_t nearest = kNoLeaf;   ///< of the last query, also of one that kept no front
  VertexId tied_vertex = kNoVertex;  ///< of `nearest`, for which tied_until holds; or for none
  double drift = 0.0;                ///< since the walk: how far the mesh has moved at most
  double approach = 0.0;  ///< and how far tip and mesh have moved towards each other at most
  std::array<std::array<float, 3>, 3> shift = {};  ///< of the tip's corners
};

/// One search: what it is given, what it knows, what it has found. Lengths in the unit frame.
struct Search {
  const WideNode* nodes;
  const NodeSplits* splits;  ///< of the nodes
  const TrianglePacket* packets;
  const Corners* leaf_corners;  ///< of their triangles, by leaf
  const double* positions;      ///< of their vertices, three numbers each, as the mesh has them
  bool fetches;  ///< they are so many that it is worth while to fetch early what will be read
  std::array<std::array<double, 3>, 3> corners;  ///< of the tip: the first; the first two; all
  std::uint32_t corner_count = 0;
  double farthest = 0.0;      ///< of the corners' coordinates, the largest magnitude
  std::uint32_t leaves_left;  ///< that may be looked at
  bool sparing;  ///< leaves are few: of a packet only those are looked at whose own boxes matter
  const FrontierRoom* room;
  bool dives = true;        ///< to find something near first, as nothing is known that is
  bool is_exact;            ///< `share` is 1, `allowance` 0, and leaves are not counted
  double share, allowance;  ///< what is farther than best * share or best - allowance is left out

  /// Measures a triangle exactly, and lowers `best` if it is the nearest so far.
  void (*measure)(Search& search, std::uint32_t leaf);
  /// How far the tip may move while a triangle is known not to be nearer than the nearest vertex so
  /// far, which it has too, nor to come before the triangle named for it; negative if it is not.
  /// REQUIRES: there is a nearest vertex.
  double (*roomOfTie)(const Search& search, std::uint32_t leaf);
  double best;              ///< the nearest triangle is not farther
  std::uint32_t best_leaf;  ///< of the nearest that was measured: of several the first
  VertexId best_vertex;     ///< the nearest point of that, if it is one

  Front* front = nullptr;  ///< to be kept for the next, or null

  double unopened;  ///< what was not looked at is not nearer; infinite if it cannot be nearest
  std::uint32_t bounds = 0, triangles = 0;  ///< boxes and triangles looked at
};

}  // namespace organ_collision::core
