#pragma once

#include "core/kernels/bounds.h"
#include "core/kernels/kernels.h"
#include "core/kernels/node_boxes.h"

// Packets of triangles and their boxes, for whichever vector unit includes it.
namespace organ_collision::core {
namespace {

/// Of as many as a node's packets can have.
using VertexPlaces = std::array<VertexPlace, std::size_t{3} * kLaneCount * kLaneCount>;

/// Asks for where some vertices are: another core may have written it.
inline void fetchAll(const PlainMesh& mesh, const VertexId* begin, const VertexId* end) {
  for (const VertexId* vertex = begin; vertex != end; ++vertex)
    __builtin_prefetch(mesh.positions + 3 * static_cast<std::size_t>(*vertex));
}

/// Rounds them to their places.
inline void place(const PlainMesh& mesh, const VertexId* begin, const VertexId* end,
                  VertexPlaces& places) {
  const std::array<double, 3>& centre = mesh.frame.centre;
  const double scale = mesh.frame.scale;
  VertexPlace* place = places.data();
#if defined(__AVX__)
  using Four __attribute__((vector_size(32))) = double;
  using Mask __attribute__((vector_size(32))) = long long;
  using Rounded __attribute__((vector_size(16))) = float;
  const Four middle = {centre[0], centre[1], centre[2], 0.0};
  for (const VertexId* vertex = begin; vertex != end; ++vertex, ++place) {
    const Four position = __builtin_ia32_maskloadpd256(  // of the fourth, memory may have none
        reinterpret_cast<const Four*>(mesh.positions + 3 * static_cast<std::size_t>(*vertex)),
        Mask{-1, -1, -1, 0});
    *reinterpret_cast<Rounded*>(place) =
        __builtin_convertvector(scale * (position - middle), Rounded);
  }
#else
  for (const VertexId* vertex = begin; vertex != end; ++vertex, ++place) {
    const auto coordinate = [&](std::size_t axis) {
      return static_cast<float>(
          scale * (mesh.positions[3 * static_cast<std::size_t>(*vertex) + axis] - centre[axis]));
    };
    *place = {coordinate(0), coordinate(1), coordinate(2)};
  }
#endif
}

/// What rounding makes of the square of a flat triangle's normal: this part of that of two edges.
/// The edges are off by 2*kPlaceRounding and shorter than 8.
constexpr float kFlat = 0x1p-36F;

/// What triangles add to their mesh's health, lane by lane.
struct LaneTally {
  Lanes<float> volume = {}, squared_edges = {};
  std::uint32_t flat = 0;

  NodeTally sum() const { return {sumOf(volume), sumOf(squared_edges), flat}; }
};

/// In frames nothing is shorter, as squares are not to underflow: that moves corners by less than
/// 2^-28, a part of kTiny.
constexpr float kShortest = 0x1p-29F;
/// A frame is taken in single precision where, from the base, no length is a smaller part of it:
/// otherwise what rounding makes of the normal could be seen in the axes' lengths.
constexpr float kSmallestPart = 0x1p-11F;

/// A unit vector perpendicular to another.
inline Vector<double> perpendicularTo(const Vector<double>& v) {
  const Vector<double> perpendicular = magnitudeOf(v.z) <= magnitudeOf(v.x)
                                           ? Vector<double>{-v.y, v.x, 0}
                                           : Vector<double>{0, -v.z, v.y};
  return 1 / rootOf(dot(perpendicular, perpendicular)) * perpendicular;
}

/// The frame of any triangle, also of one that is a point.
[[gnu::cold]] inline void placeFrame(const VertexPlaces& places, const PacketCorners& of_packet,
                                     std::uint32_t lane, TrianglePacket& packet) {
  constexpr double kLeast{kShortest};
  Vector<double> corners[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const VertexPlace& place = places[of_packet[i][lane] / sizeof(VertexPlace)];
    corners[i] = {double{place.x}, double{place.y}, double{place.z}};
  }
  std::size_t first = 0;  // of the longest edge
  Vector<double> base = corners[1] - corners[0];
  for (std::size_t i = 1; i < 3; ++i) {
    const Vector<double> edge = corners[(i + 1) % 3] - corners[i];
    if (dot(edge, edge) > dot(base, base)) {
      first = i;
      base = edge;
    }
  }
  const double length = rootOf(dot(base, base));
  const Vector<double> along = length > kLeast ? 1 / length * base : Vector<double>{1, 0, 0};
  const Vector<double> side = corners[(first + 2) % 3] - corners[first];
  const double before = dot(side, along);
  const Vector<double> altitude = side - before * along;
  const double height = rootOf(dot(altitude, altitude));
  const Vector<double> up = height > kLeast ? 1 / height * altitude : perpendicularTo(along);
  const auto put = [lane](const Vector<double>& v, LanePoints& points) {
    points[0][lane] = static_cast<float>(v.x);
    points[1][lane] = static_cast<float>(v.y);
    points[2][lane] = static_cast<float>(v.z);
  };
  const auto put_length = [lane](double x, LaneFloats& lengths) {
    lengths[lane] = static_cast<float>(x > kLeast ? x : kLeast);
  };
  put(along, packet.along);
  put(up, packet.up);
  put_length(before, packet.before);
  put_length(length - before, packet.beyond);
  put_length(height, packet.height);
}

/// The frames of triangles with these edges from a corner, mostly with the first edge as the base.
/// Corners are off by 12*u of the triangle's size: by 3*u along the base, 7*u by where the foot is,
/// 7*u by the height, as the axes are perpendicular to each other but for 3*u whatever rounding
/// makes of the normal. Returns, by bits, those that want placeFrame() instead: seldom one.
[[gnu::always_inline]] inline std::uint32_t placeFrames(const LaneVector<float>& ab,
                                                        const LaneVector<float>& ac,
                                                        const LaneVector<float>& normal,
                                                        const Lanes<float>& squared_normal,
                                                        TrianglePacket& packet) {
  const Lanes<float> one = Lanes<float>::all(1);
  const Lanes<float> length = root(dot(ab, ab));
  const Lanes<float> inverse = one / length;
  const LaneVector<float> along = inverse * ab;
  const Lanes<float> before = dot(ac, along);
  const Lanes<float> beyond = length - before;
  const Lanes<float> length_of_normal = root(squared_normal);
  const Lanes<float> height = inverse * length_of_normal;
  store(along, packet.along);
  store(one / length_of_normal * cross(normal, along), packet.up);
  before.store(packet.before.data());
  beyond.store(packet.beyond.data());
  height.store(packet.height.data());
  const Lanes<float> least =
      larger(Lanes<float>::all(kSmallestPart) * length, Lanes<float>::all(kShortest));
  // All of them: what is not a number is not either.
  const Truth<float> is_placed = (least <= before) & (least <= beyond) & (least <= height);
  return (!is_placed).bits();
}

/// All but the radius. Returns the triangles, in the unit frame.
[[gnu::always_inline]] inline LaneTriangles<float> fillOne(const VertexPlaces& places,
                                                           const PacketCorners& corners,
                                                           TrianglePacket& packet,
                                                           LaneTally& tally) {
  const LaneVector<float> a = gather(&places[0].x, corners[0]);
  const LaneVector<float> b = gather(&places[0].x, corners[1]);
  const LaneVector<float> c = gather(&places[0].x, corners[2]);
  const LaneVector<float> ab = b - a;
  const LaneVector<float> ac = c - a;
  store(a + Lanes<float>::all(1.0F / 3.0F) * (ab + ac), packet.centroid);

  const Vector<float> first = {a.x[0], a.y[0], a.z[0]};
  packet.origin = {first.x, first.y, first.z};
  const LaneVector<float> normal = cross(ab, ac);
  const Lanes<float> squared_normal = dot(normal, normal);
  for (std::uint32_t rest = placeFrames(ab, ac, normal, squared_normal, packet); rest != 0;
       rest &= rest - 1)
    placeFrame(places, corners, lowestBit(rest), packet);

  const Lanes<float> squared_edges = dot(ab, ab) + dot(ac, ac);
  const Truth<float> in_use = lanesInUse<float>(packet);
  const Truth<float> may_be_flat = squared_normal <= Lanes<float>::all(kFlat) * squared_edges;
  const Lanes<float> none{};
  tally.volume = tally.volume + select(in_use, dot(a, normal), none);
  tally.squared_edges = tally.squared_edges + select(in_use, squared_edges, none);
  tally.flat += static_cast<std::uint32_t>(__builtin_popcount((in_use & may_be_flat).bits()));
  return {a, ab, ac};
}

inline void fill(const PlainMesh& mesh, const PlainTree& tree, std::uint32_t begin,
                 std::uint32_t end) {
  constexpr std::uint32_t kAhead = 8;  // packets
  VertexPlaces places;
  const auto first = [&mesh](std::uint32_t number) {
    return mesh.vertices + mesh.first_vertices[number];
  };
  for (std::uint32_t number = begin; number < end; ++number) {
    if (number + 1 < end) fetchAll(mesh, first(number + 1), first(number + 2));
    place(mesh, first(number), first(number + 1), places);
    WideNode& node = tree.nodes[number];
    const std::uint32_t packet_count = node.lane_count - node.node_count;
    const PacketCorners* const corners = mesh.corners + node.first_packet;
    TrianglePacket* const packets = tree.packets + node.first_packet;
    const Turn turn = turnOf(node.axes);
    SetReaches reaches;
    LaneTally tally;
    for (std::uint32_t i = 0; i < packet_count; ++i) {
      __builtin_prefetch(packets + i + kAhead, 1);
      LaneTriangles<float> triangles = fillOne(places, corners[i], packets[i], tally);
      if (i == 0) node.origin = packets[i].origin;
      triangles.a = triangles.a - everywhere(vectorOf<float>(node.origin));
      const Reach reach = reachOfCorners(triangles, turn);
      packets[i].radius = radiusOf(reach);
      reaches.set(node.node_count + i, reach);
    }
    if (packet_count > 0) node.radius = storeBoxes(node, node.node_count, node.lane_count, reaches);
    tree.tallies[number] = tally.sum();
  }
}

}  // namespace
}  // namespace organ_collision::core
