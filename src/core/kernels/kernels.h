#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/kernels/descent.h"
#include "core/kernels/pair_search.h"
#include "core/kernels/search.h"
#include "organ_collision/core/farthest_pair.h"
#include "organ_collision/core/ids.h"
#include "organ_collision/core/wide_node.h"

// The door to what is translated once for each vector unit: the other headers of this folder, by
// kernels_*.cpp. Only plain data goes through (search.h, pair_search.h, descent.h): no code that is
// translated for one unit may be called by code for another. So all code behind it has internal
// linkage, and of std it uses types and std::array's access.
namespace organ_collision::core {

/// How closely a node's boxes are drawn: around boxes that lie some levels below, which takes the
/// same time for every node, or around all the corners there.
enum class Fit : std::uint8_t { kBoxes, kCorners };

/// UnitFrame as plain data.
struct PlainUnitFrame {
  std::array<double, 3> centre;
  double scale;
};

/// Where the triangles of nodes' packets are.
struct PlainMesh {
  const double* positions;  ///< of the vertices [m]
  PlainUnitFrame frame;
  const VertexId* vertices;             ///< of one node after another
  const std::uint32_t* first_vertices;  ///< of each node and, one more, their end
  const PacketCorners* corners;         ///< of the packets
};

/// What is to be filled, then enclosed.
struct PlainTree {
  WideNode* nodes;
  NodeSplits* node_splits;
  const Poles* poles;  ///< of the nodes' splits, by their slots
  TrianglePacket* packets;
  NodeTally* tallies;  ///< of the nodes' packets
  const NodePart* parts;
  const std::uint32_t* first_parts;  ///< of each node and, one more, their end
};

/// One of some points, by its place among them.
struct FarPoint {
  std::size_t index;
  double squared_distance;
};

/// Triangles by their centroids, one coordinate of all of them after another.
struct PlainTriangles {
  double *x, *y, *z;
  TriangleId* ids;
};

/// How the hierarchy splits up to eight points.
struct FewSplits {
  struct Split {
    std::array<std::uint32_t, 2> poles;
    std::uint32_t first_size;  ///< points that go with the first
  };
  std::array<Split, kLaneCount - 1> splits;  ///< parents first, then all of the first pole's side
  std::array<std::uint32_t, kLaneCount> order;  ///< of the leaves
  std::uint32_t levels;                         ///< of splits
};

/// The box of points [m].
struct PlainBox {
  std::array<double, 3> low, high;
  bool finite;  ///< all coordinates are
};

struct Kernels {
  /// Walks through the tree until nothing that waits matters, or no leaf is left to look at.
  void (*walk)(Search& search);
  /// Looks at what of the front may be nearest now; false where there is no room for all of it.
  bool (*follow)(Search& search);
  /// Goes down by the splits to a leaf; false where rounding could decide one of them wrongly.
  bool (*descend)(Descent& descent);
  /// Walks through two trees at once.
  void (*walkPairs)(PairSearch& search);
  /// Looks at the pairs that are followed, after the surfaces have moved by at most `step`.
  void (*followPairs)(PairSearch& search, double step);
  /// REQUIRES: there is a point.
  PlainBox (*boxOf)(const double* points, std::size_t count);
  /// Takes over where the triangles of some nodes' packets are, and places the boxes around these
  /// and the origins of nodes that have packets. The tallies count triangles that may be flat
  /// within rounding.
  void (*fill)(const PlainMesh& mesh, const PlainTree& tree, std::uint32_t begin,
               std::uint32_t end);
  /// Places the other origins and boxes, and the splits, of nodes, the last first. REQUIRES: their
  /// packets and all below are filled, all nodes below enclosed.
  void (*enclose)(const PlainTree& tree, std::uint32_t begin, std::uint32_t end, Fit fit);
  /// What a set costs in up to 1, 2, ... 8 lanes: divided among its children, of which each takes
  /// one or more, or whole, in one lane, as a packet or as a node whose children share eight.
  void (*weigh)(const LaneFloats& of_one, const LaneFloats& of_other, float as_packet, float weight,
                LaneFloats& costs);
  /// The first of those that are farthest from a point. REQUIRES: eight points or more.
  FarPoint (*farthestFrom)(const PointColumns& points, std::size_t count,
                           const std::array<double, 3>& point);
  /// Whether some point is at least so far from one. REQUIRES: eight points or more.
  bool (*reach)(const PointColumns& points, std::size_t count, const std::array<double, 3>& point,
                double least);
  /// As farthestPair(). REQUIRES: eight points or more.
  FarthestPair (*farthestOfAllPairs)(const PointColumns& points, std::size_t count);
  /// Lists those whose power with respect to the ball on the diameter that is given (the squared
  /// distance from its middle less the squared radius) is at least `least`; returns how many. The
  /// power errs by at most 16 u of the points' squared distance.
  /// REQUIRES: eight points or more; room for all of them.
  std::size_t (*listByPower)(const PointColumns& points, std::size_t count,
                             const std::array<double, 3>& first,
                             const std::array<double, 3>& second, double least,
                             std::uint32_t* found);
  /// Lists those whose squared distance from the farthest corner of a box is at least `least`;
  /// returns how many. No point of the box is farther, in computed arithmetic too.
  /// REQUIRES: eight points or more; room for all of them.
  std::size_t (*listFarFrom)(const PointColumns& points, std::size_t count,
                             const std::array<double, 3>& low, const std::array<double, 3>& high,
                             double least, std::uint32_t* found);
  /// Of `count` triangles, puts those that are nearer to the first place than to the second in
  /// front, and the others where `spare` tells, both in their order; returns how many are in front.
  /// REQUIRES: eight triangles or more; from `spare` on, room for all of them.
  std::size_t (*separate)(const PlainTriangles& triangles, std::size_t count, std::size_t spare,
                          const std::array<double, 3>& first, const std::array<double, 3>& second);
  /// Splits points all the way down. Those that stay together keep their order; if they coincide,
  /// they are halved. REQUIRES: two to eight points.
  void (*splitFew)(const PointColumns& points, std::uint32_t count, FewSplits& few);
};

extern const Kernels kBaselineKernels;
extern const Kernels kAvx2Kernels;
extern const Kernels kAvx512Kernels;

/// Of at least one point, on all cores.
PlainBox boxOfPoints(const double* points, std::size_t count);

/// Those of vectorUnit(). All of them give the same answers, bit for bit.
const Kernels& kernels();

}  // namespace organ_collision::core
