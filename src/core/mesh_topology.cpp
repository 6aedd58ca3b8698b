#include "organ_collision/core/mesh_topology.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <numeric>
#include <random>
#include <utility>

#include "core/for_each.h"

namespace organ_collision::core {
namespace {

constexpr std::size_t kWeldsPerTask = 1024;
constexpr MeshTopology::Weld kNoWeld = std::numeric_limits<MeshTopology::Weld>::max();

/// Equal for equal positions: minus zero is zero. Another one in each process, so that no mesh can
/// be made all of whose positions have the same.
std::uint64_t hash(const Eigen::Vector3d& position) {
  static const std::uint64_t kSeed = std::random_device()();
  std::uint64_t mixed = kSeed;
  for (const double coordinate : position + Eigen::Vector3d::Zero()) {
    std::uint64_t bits = 0;
    std::memcpy(&bits, &coordinate, sizeof(bits));
    mixed = (mixed ^ bits ^ (bits >> 32)) * 0x9E3779B97F4A7C15;
    mixed ^= mixed >> 32;
  }
  return mixed;
}

std::vector<bool> usedVertices(const TriangleMesh& mesh) {
  std::vector<bool> used(mesh.positions().size(), mesh.usesAllVertices());
  if (mesh.usesAllVertices()) return used;
  for (const Corners& corners : mesh.triangles())
    for (const VertexId corner : corners) used[index(corner)] = true;
  return used;
}

}  // namespace

MeshTopology::MeshTopology(const TriangleMesh& mesh) {
  weldVertices(mesh);
  listTriangles(mesh);
  listParts(mesh, inspect(mesh));
}

/// By a table of the welds so far, at most half full, each at or after the place of its hash.
/// Vertices without a triangle are welded to nothing: they move where they like.
void MeshTopology::weldVertices(const TriangleMesh& mesh) {
  const Points& positions = mesh.positions();
  const std::vector<bool> used = usedVertices(mesh);
  std::size_t size = 1;
  while (size < 2 * positions.size()) size *= 2;
  std::vector<Weld> table(size, kNoWeld);
  welds_.reserve(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    std::size_t place = hash(positions[i]) & (size - 1);
    while (table[place] != kNoWeld &&
           positions[index(representatives_[table[place]])] != positions[i])
      place = (place + 1) & (size - 1);
    if (table[place] == kNoWeld || !used[i]) {
      if (used[i]) table[place] = static_cast<Weld>(representatives_.size());
      welds_.push_back(static_cast<Weld>(representatives_.size()));
      representatives_.push_back(static_cast<VertexId>(i));
    } else {
      welds_.push_back(table[place]);
    }
  }
  if (representatives_.size() == positions.size()) welds_ = {};
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

struct MeshTopology::Findings {
  bool closed = true;
  bool consistently_wound = true;
  std::size_t duplicate_triangles = 0;
};

/// Each edge and each triangle is looked at where its lowest weld is, unless there is nothing to
/// be found around that. Tells of each weld whether its triangles are a closed fan.
class MeshTopology::Inspector {
 public:
  Inspector(const MeshTopology& topology, const TriangleMesh& mesh, ClosedFans& closed_fans)
      : topology_(topology), mesh_(mesh), closed_fans_(closed_fans) {}

  void inspect(Weld weld, Findings& findings) {
    closed_fans_[weld] = isClosedFan(weld) ? 1 : 0;
    if (closed_fans_[weld] != 0) return;
    edges_.clear();
    opposite_sides_.clear();
    const TriangleId* last = nullptr;
    for (const TriangleId& triangle : topology_.trianglesAt(weld)) {
      // One with two corners here comes twice.
      if (last == nullptr || *last != triangle) add(triangle, weld);
      last = &triangle;
    }
    std::sort(edges_.begin(), edges_.end());
    for (auto edge = edges_.begin(); edge != edges_.end();) {
      std::size_t uses = 0;
      int balance = 0;
      for (const std::uint64_t end = *edge >> 1U; edge != edges_.end() && *edge >> 1U == end;
           ++edge) {
        ++uses;
        balance += (*edge & 1U) != 0 ? 1 : -1;
      }
      findings.closed = findings.closed && uses % 2 == 0;
      findings.consistently_wound = findings.consistently_wound && std::abs(balance) <= 1;
    }
    std::sort(opposite_sides_.begin(), opposite_sides_.end());
    const auto different = std::unique(opposite_sides_.begin(), opposite_sides_.end());
    findings.duplicate_triangles += static_cast<std::size_t>(opposite_sides_.end() - different);
  }

 private:
  static constexpr std::uint32_t kMany = 32;     // triangles around a vertex
  static constexpr std::uint32_t kPlaces = 256;  // in which few corners meet

  /// Whether the triangles here go on one where another ends, all in one turn of three or more. It
  /// may be false of very many.
  bool isClosedFan(Weld weld) {
    const TriangleRange triangles = topology_.trianglesAt(weld);
    if (triangles.end() - triangles.begin() > kMany) return false;
    std::array<Weld, kMany> from;  // their other corners
    std::array<Weld, kMany> to;
    std::uint32_t count = 0;
    for (const TriangleId& triangle : triangles) {
      const std::array<Weld, 3> welds = weldsOf(triangle);
      const std::size_t here = (welds[1] == weld ? 1U : 0U) + (welds[2] == weld ? 2U : 0U);
      if (here == 3) return false;
      from[count] = welds[(here + 1) % 3];
      to[count] = welds[(here + 2) % 3];
      places_[from[count] % kPlaces] = count;
      ++count;
    }
    if (count == 0) return true;
    const auto starting_at = [&](Weld end) {
      const std::uint32_t place = places_[end % kPlaces];
      if (place < count && from[place] == end) return place;
      // Another has taken its place, or there is none.
      const auto* const found = std::find(from.cbegin(), from.cbegin() + count, end);
      return static_cast<std::uint32_t>(found - from.cbegin());
    };
    // Where one turn leads depends on where it starts alone. If it is back at the first after
    // `count` of them, not sooner, all were passed, so no two start at the same corner; and of more
    // than two none is another's back.
    std::uint32_t turns = 0;
    std::uint32_t at = 0;
    do {
      at = starting_at(to[at]);
      if (at == count) return false;
      ++turns;
    } while (at != 0 && turns < count);
    return at == 0 && turns == count && count > 2;
  }

  std::array<Weld, 3> weldsOf(TriangleId triangle) const {
    const auto& [a, b, c] = mesh_.corners(triangle);
    return {topology_.weld(a), topology_.weld(b), topology_.weld(c)};
  }

  void add(TriangleId triangle, Weld weld) {
    const std::array<Weld, 3> welds = weldsOf(triangle);
    for (const std::size_t i : {0, 1, 2}) {
      const Weld from = welds[i];
      const Weld to = welds[(i + 1) % 3];
      if (from == weld && weld < to) edges_.push_back(std::uint64_t{to} << 1U | 1U);
      if (to == weld && weld < from) edges_.push_back(std::uint64_t{from} << 1U);
    }
    // Without branches, as none could be foreseen.
    const auto [low, high] = std::minmax(welds[0], welds[1]);
    const Weld middle = std::max(low, std::min(high, welds[2]));
    if (std::min(low, welds[2]) == weld)
      opposite_sides_.push_back(std::uint64_t{middle} << 32U | std::max(high, welds[2]));
  }

  const MeshTopology& topology_;
  const TriangleMesh& mesh_;
  ClosedFans& closed_fans_;
  std::array<std::uint32_t, kPlaces> places_{};  // where a corner may be found
  std::vector<std::uint64_t> edges_;  // twice their other end; one more if they run towards it
  std::vector<std::uint64_t> opposite_sides_;  // both ends
};

MeshTopology::ClosedFans MeshTopology::inspect(const TriangleMesh& mesh) {
  ClosedFans closed_fans(representatives_.size());
  OwnContext context;
  const Findings findings = tbb::parallel_reduce(
      tbb::blocked_range<Weld>(0, static_cast<Weld>(representatives_.size()), kWeldsPerTask),
      Findings(),
      [&](const auto& some, Findings findings_so_far) {
        Inspector inspector(*this, mesh, closed_fans);
        for (Weld weld = some.begin(); weld < some.end(); ++weld)
          inspector.inspect(weld, findings_so_far);
        return findings_so_far;
      },
      [](const Findings& first, const Findings& second) {
        return Findings{first.closed && second.closed,
                        first.consistently_wound && second.consistently_wound,
                        first.duplicate_triangles + second.duplicate_triangles};
      },
      context);
  closed_ = findings.closed;
  consistently_wound_ = findings.consistently_wound;
  duplicate_triangles_ = findings.duplicate_triangles;
  return closed_fans;
}

/// Which triangles hang together: those of each closed fan do. A set is told by a closed fan that
/// is in it, or else by a triangle, whose numbers come after those of all welds.
class MeshTopology::Joiner {
 public:
  Joiner(const MeshTopology& topology, const TriangleMesh& mesh, const ClosedFans& closed_fans)
      : topology_(topology),
        mesh_(mesh),
        closed_fans_(closed_fans),
        others_(othersThan(closed_fans)),
        sets_(closed_fans.size() + (others_.empty() ? 0 : mesh.triangleCount())) {
    for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
      const auto& [a, b, c] = mesh.triangles()[i];
      const Weld set = setOf(static_cast<TriangleId>(i));
      const auto fan_at = [&](VertexId corner) { return isFan(corner) ? weld(corner) : set; };
      sets_.join(fan_at(a), fan_at(b), fan_at(c));
    }
  }

  bool allAreFans() const { return others_.empty(); }

  /// Those of two triangles.
  void joinAcrossEdges() {
    std::vector<std::pair<Weld, Weld>> edges;  // by their other end; and what is there
    for (const Weld here : others_) {
      edges.clear();
      for (const TriangleId triangle : topology_.trianglesAt(here))
        for (const VertexId corner : mesh_.corners(triangle))
          if (weld(corner) > here && !isFan(corner))
            edges.emplace_back(weld(corner), setOf(triangle));
      std::sort(edges.begin(), edges.end());
      for (std::size_t begin = 0, end = 0; begin < edges.size(); begin = end) {
        while (end < edges.size() && edges[end].first == edges[begin].first) ++end;
        if (end - begin == 2) sets_.join(edges[begin].second, edges[begin + 1].second);
      }
    }
  }

  void joinAtVertices() {
    for (const Weld here : others_)
      for (const TriangleId triangle : topology_.trianglesAt(here))
        sets_.join(here, setOf(triangle));
  }

  /// The lowest number of what hangs together with it.
  Weld lowest(Weld weld) { return sets_.lowest(weld); }
  Weld lowest(TriangleId triangle) { return sets_.lowest(setOf(triangle)); }

 private:
  /// Sets of numbers. Each leads to a lower one of its set, or is the lowest: R. Tarjan,
  /// "Efficiency of a good but not linear set union algorithm" (1975), with the way halved.
  class DisjointSets {
   public:
    using Number = std::uint32_t;

    explicit DisjointSets(std::size_t size) : leads_to_(size) {
      std::iota(leads_to_.begin(), leads_to_.end(), Number{0});
    }

    Number lowest(Number number) {
      while (leads_to_[number] != number) number = leads_to_[number] = leads_to_[leads_to_[number]];
      return number;
    }
    void join(Number a, Number b, Number c) {
      a = lowest(a);
      b = lowest(b);
      c = lowest(c);
      if (a != b || a != c) leads_to_[a] = leads_to_[b] = leads_to_[c] = std::min({a, b, c});
    }
    void join(Number a, Number b) { join(a, b, b); }

   private:
    std::vector<Number> leads_to_;
  };

  static std::vector<Weld> othersThan(const ClosedFans& closed_fans) {
    std::vector<Weld> others;
    for (Weld weld = 0; weld < closed_fans.size(); ++weld)
      if (closed_fans[weld] == 0) others.push_back(weld);
    return others;
  }
  Weld weld(VertexId corner) const { return topology_.weld(corner); }
  bool isFan(VertexId corner) const { return closed_fans_[weld(corner)] != 0; }
  Weld setOf(TriangleId triangle) const {
    for (const VertexId corner : mesh_.corners(triangle))
      if (isFan(corner)) return weld(corner);
    return static_cast<Weld>(closed_fans_.size() + index(triangle));
  }

  const MeshTopology& topology_;
  const TriangleMesh& mesh_;
  const ClosedFans& closed_fans_;
  const std::vector<Weld> others_;  // that are no closed fans
  DisjointSets sets_;
};

void MeshTopology::listParts(const TriangleMesh& mesh, const ClosedFans& closed_fans) {
  Joiner joiner(*this, mesh, closed_fans);
  if (closed_ && consistently_wound_ && !joiner.allAreFans()) {
    joiner.joinAcrossEdges();
    pieces_.resize(mesh.triangleCount());
    for (std::size_t i = 0; i < pieces_.size(); ++i)
      pieces_[i] = joiner.lowest(static_cast<TriangleId>(i));
  }
  joiner.joinAtVertices();
  for (Weld weld = 0; weld < representatives_.size(); ++weld)
    if (joiner.lowest(weld) == weld && offsets_[weld] != offsets_[weld + 1])
      parts_.push_back(representatives_[weld]);
  const bool is_one_part = closed_ && consistently_wound_ && parts_.size() == 1;
  one_piece_ =
      is_one_part && std::all_of(pieces_.begin(), pieces_.end(),
                                 [this](std::uint32_t piece) { return piece == pieces_.front(); });
  if (one_piece_ || !is_one_part) pieces_ = {};
}

bool MeshTopology::isOf(std::uint32_t piece, Weld weld) const {
  const TriangleRange around = trianglesAt(weld);
  return std::all_of(around.begin(), around.end(),
                     [&](TriangleId triangle) { return pieces_[index(triangle)] == piece; });
}

bool MeshTopology::isOf(std::uint32_t piece, const Corners& corners) const {
  return std::all_of(corners.begin(), corners.end(),
                     [&](VertexId corner) { return isOf(piece, weld(corner)); });
}

/// The piece that reaches farthest along x: beyond it there is nothing, and so on all of its outer
/// side.
std::optional<MeshTopology::Outermost> MeshTopology::outermost(const TriangleMesh& mesh) const {
  if (pieces_.empty()) return std::nullopt;
  const auto at = [&](Weld weld) -> const Eigen::Vector3d& {
    return mesh.position(representatives_[weld]);
  };
  Weld farthest = weld(mesh.triangles().front()[0]);
  for (Weld weld = 0; weld < representatives_.size(); ++weld)
    if (offsets_[weld] != offsets_[weld + 1] && at(weld).x() > at(farthest).x()) farthest = weld;
  const std::uint32_t piece = pieces_[index(*trianglesAt(farthest).begin())];
  if (!isOf(piece, farthest)) return std::nullopt;
  // The angle-weighted normal there points away from the piece or, if that is inverted, into it.
  constexpr double kClear = 0x1p-20;
  double along = 0.0;
  for (const TriangleId id : trianglesAt(farthest)) {
    const Corners& corners = mesh.corners(id);
    const std::size_t here =
        (weld(corners[1]) == farthest ? 1U : 0U) + (weld(corners[2]) == farthest ? 2U : 0U);
    const Eigen::Vector3d to_next = mesh.position(corners[(here + 1) % 3]) - at(farthest);
    const Eigen::Vector3d to_last = mesh.position(corners[(here + 2) % 3]) - at(farthest);
    const Eigen::Vector3d across = to_next.cross(to_last);
    const double angle = std::atan2(across.stableNorm(), to_next.dot(to_last));
    along += angle * across.stableNormalized().x();
  }
  if (!(std::abs(along) > kClear)) return std::nullopt;
  return Outermost{piece, along < 0.0};
}

std::size_t MeshTopology::memory() const {
  return pieces_.capacity() * sizeof(std::uint32_t) + parts_.capacity() * sizeof(VertexId) +
         welds_.capacity() * sizeof(Weld) + representatives_.capacity() * sizeof(VertexId) +
         offsets_.capacity() * sizeof(std::uint32_t) +
         triangles_at_.capacity() * sizeof(TriangleId);
}

}  // namespace organ_collision::core
