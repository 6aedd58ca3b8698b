#pragma once

#include <functional>
#include <string>

#include "organ_collision/core/triangle_mesh.h"

// How this library and its peers answer on the inputs of measure_stability.
namespace organ_collision::bench {

/// How far a point [m] is from an organ [m], without sign.
using Organ = std::function<double(const Eigen::Vector3d&)>;

struct Peer {
  std::string name;
  std::function<Organ(const core::TriangleMesh&)> organ;
  /// [m] none: it has no such
  std::function<double(const core::Triangle&, const core::Triangle&)> distance;
  std::function<bool(const core::Triangle&, const core::Triangle&)> intersect;  ///< none: likewise
};

Peer libraryPeer();
Peer cgalPeer();
Peer fclPeer();
Peer bulletPeer();
Peer embreePeer();

/// A mesh of one triangle.
inline core::TriangleMesh meshOf(const core::Triangle& t) {
  return {{t.a, t.b, t.c}, {{core::VertexId{0}, core::VertexId{1}, core::VertexId{2}}}};
}

/// Less than 0 says that two shapes meet.
inline double notNegative(double distance) { return distance < 0.0 ? 0.0 : distance; }

}  // namespace organ_collision::bench
