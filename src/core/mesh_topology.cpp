#include "organ_collision/core/mesh_topology.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <numeric>
#include <tuple>

namespace organ_collision::core {

MeshTopology::MeshTopology(const TriangleMesh& mesh) {
  weldVertices(mesh);
  listTriangles(mesh);
  inspectEdges(mesh);
  countDuplicates(mesh);
}

void MeshTopology::weldVertices(const TriangleMesh& mesh) {
  const Points& positions = mesh.positions();
  std::vector<std::uint32_t> order(positions.size());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&positions](std::uint32_t i, std::uint32_t j) {
    const Eigen::Vector3d& p = positions[i];
    const Eigen::Vector3d& q = positions[j];
    return std::make_tuple(p.x(), p.y(), p.z(), i) < std::make_tuple(q.x(), q.y(), q.z(), j);
  });
  welds_.resize(positions.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    if (i == 0 || positions[order[i]] != positions[order[i - 1]]) {
      representatives_.push_back(static_cast<VertexId>(order[i]));
    }
    welds_[order[i]] = static_cast<Weld>(representatives_.size() - 1);
  }
}

void MeshTopology::listTriangles(const TriangleMesh& mesh) {
  offsets_.assign(representatives_.size() + 1, 0);
  for (const Corners& corners : mesh.triangles()) {
    for (const VertexId corner : corners) ++offsets_[weld(corner) + 1];
  }
  std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());
  triangles_at_.resize(3 * mesh.triangleCount());
  std::vector<std::uint32_t> next(offsets_.begin(), offsets_.end() - 1);
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    for (const VertexId corner : mesh.triangles()[i])
      triangles_at_[next[weld(corner)]++] = static_cast<TriangleId>(i);
  }
}

void MeshTopology::inspectEdges(const TriangleMesh& mesh) {
  struct Edge {
    Weld low, high;
    int sense;  // +1 from low to high
  };
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangleCount());
  for (const Corners& corners : mesh.triangles()) {
    for (const std::size_t i : {0, 1, 2}) {
      const Weld from = weld(corners[i]);
      const Weld to = weld(corners[(i + 1) % 3]);
      if (from != to) edges.push_back({std::min(from, to), std::max(from, to), from < to ? 1 : -1});
    }
  }
  const auto ends = [](const Edge& edge) { return std::tie(edge.low, edge.high); };
  std::sort(edges.begin(), edges.end(),
            [&ends](const Edge& a, const Edge& b) { return ends(a) < ends(b); });
  for (std::size_t i = 0; i < edges.size();) {
    std::size_t uses = 0;
    int balance = 0;
    for (const std::size_t first = i; i < edges.size() && ends(edges[i]) == ends(edges[first]);
         ++i) {
      ++uses;
      balance += edges[i].sense;
    }
    closed_ = closed_ && uses % 2 == 0;
    consistently_wound_ = consistently_wound_ && std::abs(balance) <= 1;
  }
}

void MeshTopology::countDuplicates(const TriangleMesh& mesh) {
  std::vector<std::array<Weld, 3>> triples;
  triples.reserve(mesh.triangleCount());
  for (const Corners& corners : mesh.triangles()) {
    triples.push_back({weld(corners[0]), weld(corners[1]), weld(corners[2])});
    std::sort(triples.back().begin(), triples.back().end());
  }
  std::sort(triples.begin(), triples.end());
  duplicate_triangles_ =
      static_cast<std::size_t>(triples.end() - std::unique(triples.begin(), triples.end()));
}

std::size_t MeshTopology::memory() const {
  return welds_.capacity() * sizeof(Weld) + representatives_.capacity() * sizeof(VertexId) +
         offsets_.capacity() * sizeof(std::uint32_t) +
         triangles_at_.capacity() * sizeof(TriangleId);
}

}  // namespace organ_collision::core
