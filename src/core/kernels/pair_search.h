#pragma once

#include <array>
#include <cstdint>

#include "organ_collision/core/wide_node.h"

namespace organ_collision::core {

/// A set of one surface and one of another that wait to be looked at.
struct WaitingPair {
  float bound;
  std::uint32_t first, second;
};

/// The packets of two surfaces that may hold what is nearest while they move.
struct FollowedPairs {
  static constexpr std::uint32_t kMost = 512;
  alignas(64) std::array<float, kMost> bounds = {};  ///< at least so far from each other
  std::array<std::uint32_t, kMost> first, second;    ///< packets
  std::uint32_t count = 0;
  double clear;  ///< at least so far from each other are all others
};

/// What a search sees of a surface.
struct SearchedTree {
  const WideNode* nodes;
  const TrianglePacket* packets;
};

/// Row by row: x -> linear * x + offset.
struct AffineMap {
  std::array<std::array<double, 3>, 3> linear;
  std::array<double, 3> offset;
};

/// One search for the nearest triangles of two surfaces: what it is given, what it knows, what it
/// has found; see Search. Lengths in the second's unit frame.
struct PairSearch {
  SearchedTree first, second;
  AffineMap second_from_first, first_from_second;  ///< between the unit frames
  double least_scale, largest_scale;               ///< by which lengths of the first grow
  double rounding;           ///< of a corner of the first, moved, and of exact distances
  std::uint32_t pairs_left;  ///< that may be looked at
  WaitingPair* stack;        ///< room for 63 to a level of either tree, and 1
  double share, allowance;   ///< what is farther than best * share or best - allowance is left out

  /// Measures two triangles exactly, and lowers `best` if they are the nearest so far.
  void (*measure)(PairSearch& search, std::uint32_t leaf_of_first, std::uint32_t leaf_of_second);
  double best;                 ///< the nearest two are not farther apart
  std::array<double, 3> axis;  ///< between the nearest two measured: other pairs lie so, too

  double slack;             ///< pairs up to this much farther than the best are followed, too
  FollowedPairs* followed;  ///< where to put the packets looked at, or null

  double unopened;  ///< what was not looked at is not nearer; infinite if it cannot be nearest
  std::uint32_t bounds, triangles;  ///< pairs of boxes and of triangles looked at
};

}  // namespace organ_collision::core
