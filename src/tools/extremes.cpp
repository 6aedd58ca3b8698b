#include "extremes.h"

#include <algorithm>
#include <cmath>

#include "io/primitive_mesh.h"
#include "organ_collision/core/box.h"
#include "reference/triangle_pairs.h"

namespace organ_collision::tools {
namespace {

using core::Box;
using core::Corners;
using core::Points;
using core::Sample;
using core::Triangle;
using core::TriangleId;
using core::TriangleKind;
using core::TriangleMesh;
using core::VertexId;
using Eigen::Vector3d;
using Random = Extreme::Random;
using Pair = std::pair<Triangle, Triangle>;

constexpr double kFarAway = 1e30;  // [m]
constexpr double kThin = 1e-12;    // height of a cap over its length

// ---- what is done to triangles and organs

template <typename Move>
Triangle moved(const Triangle& t, const Move& move) {
  return {move(t.a), move(t.b), move(t.c)};
}

template <typename Move>
TriangleMesh moved(const TriangleMesh& mesh, const Move& move) {
  Points points = mesh.positions();
  std::transform(points.begin(), points.end(), points.begin(), move);
  return {points, mesh.triangles()};
}

/// All that a class has, moved by a function of positions.
template <typename Move>
Extreme moved(const std::string& name, const Extreme& from, const Move& move) {
  return {name,
          [=](Random& random) {
            const Sample sample = from.sample(random);
            return Sample{move(sample.query), moved(sample.triangle, move)};
          },
          [=](Random& random) {
            const auto [first, second] = from.pair(random);
            return Pair{moved(first, move), moved(second, move)};
          },
          moved(from.organ, move), from.tip};
}

/// Every triangle in three, which meet where the weights say.
TriangleMesh split(const TriangleMesh& mesh, const Vector3d& weights) {
  Points points = mesh.positions();
  std::vector<Corners> triangles;
  for (const auto& [a, b, c] : mesh.triangles()) {
    const auto middle = static_cast<VertexId>(points.size());
    points.emplace_back(weights.x() * mesh.position(a) + weights.y() * mesh.position(b) +
                        weights.z() * mesh.position(c));
    triangles.insert(triangles.end(), {{a, b, middle}, {b, c, middle}, {c, a, middle}});
  }
  return {points, triangles};
}

/// Every triangle three times: twice with its own corners, once with copies of them.
TriangleMesh tripled(const TriangleMesh& mesh) {
  Points points = mesh.positions();
  points.insert(points.end(), mesh.positions().begin(), mesh.positions().end());
  const auto copy = [&mesh](VertexId corner) {
    return static_cast<VertexId>(index(corner) + mesh.positions().size());
  };
  std::vector<Corners> triangles;
  for (const auto& [a, b, c] : mesh.triangles()) {
    triangles.insert(triangles.end(), {{a, b, c}, {b, c, a}, {copy(a), copy(b), copy(c)}});
  }
  return {points, triangles};
}

// ---- organs

Corners corners(std::size_t a, std::size_t b, std::size_t c) {
  return {static_cast<VertexId>(a), static_cast<VertexId>(b), static_cast<VertexId>(c)};
}

/// Rings of corners between two poles, about 1 m from the origin: every ray from there leaves once.
TriangleMesh ball() {
  constexpr std::size_t kRings = 7;
  constexpr std::size_t kSectors = 9;
  Random random(1);
  Points points = {{0, 0, -1}, {0, 0, 1}};
  for (std::size_t ring = 0; ring < kRings; ++ring) {
    const double latitude = M_PI * (static_cast<double>(ring + 1) / (kRings + 1) - 0.5);
    for (std::size_t sector = 0; sector < kSectors; ++sector) {
      const double longitude = 2 * M_PI * static_cast<double>(sector) / kSectors;
      points.push_back(random.uniform(0.8, 1.2) * Vector3d(std::cos(latitude) * std::cos(longitude),
                                                           std::cos(latitude) * std::sin(longitude),
                                                           std::sin(latitude)));
    }
  }
  const auto corner = [](std::size_t ring, std::size_t sector) {
    return 2 + ring * kSectors + sector % kSectors;
  };
  std::vector<Corners> triangles;
  for (std::size_t s = 0; s < kSectors; ++s) {
    triangles.push_back(corners(0, corner(0, s + 1), corner(0, s)));
    triangles.push_back(corners(1, corner(kRings - 1, s), corner(kRings - 1, s + 1)));
    for (std::size_t r = 0; r + 1 < kRings; ++r) {
      triangles.push_back(corners(corner(r, s), corner(r, s + 1), corner(r + 1, s + 1)));
      triangles.push_back(corners(corner(r, s), corner(r + 1, s + 1), corner(r + 1, s)));
    }
  }
  return {points, triangles};
}

/// The box [-1, 1]^3.
TriangleMesh cube() { return io::boxMesh(Vector3d::Constant(2)); }

/// Tetrahedra at the powers of 8 from 2^-120 to 2^120 m, each an eighth as long as it is far.
TriangleMesh exponentialTetrahedra() {
  Points points;
  std::vector<Corners> triangles;
  for (int exponent = -120; exponent <= 120; exponent += 3) {
    const std::size_t first = points.size();
    const double x = std::ldexp(1.0, exponent);
    const double size = x / 8;
    points.insert(points.end(), {{x, 0, 0}, {x + size, 0, 0}, {x, size, 0}, {x, 0, size}});
    for (const auto& [a, b, c] : {std::array{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}})
      triangles.push_back(corners(first + a, first + b, first + c));
  }
  return {points, triangles};
}

const Points kFourPoints = {
    {0.3, -0.2, 0.1}, {1.1, 0.4, -0.5}, {-0.6, 0.9, 0.7}, {-0.5, -0.8, 0.2}};

// ---- tips

TriangleId anyTriangle(Random& random, const TriangleMesh& organ) {
  const auto count = static_cast<double>(organ.triangleCount());
  return static_cast<TriangleId>(random.uniform(0, count));
}

Vector3d sizeOf(const Points& points) {
  Box box;
  for (const Vector3d& point : points) box.add(point);
  return box.high - box.low;
}

/// Some sizes of the organ, or of one of its triangles, away from a triangle, down to a rounding
/// error.
Vector3d anywhere(Random& random, const TriangleMesh& organ) {
  const Triangle triangle = organ.triangle(anyTriangle(random, organ));
  const Vector3d size =
      sizeOf(random.oneIn(2) ? organ.positions() : Points{triangle.a, triangle.b, triangle.c});
  return random.pointOf(triangle) + random.magnitude(-17, 0.5) * size.cwiseProduct(random.inCube());
}

Vector3d onSurface(Random& random, const Triangle& t) {
  if (random.oneIn(3)) return t.a;
  if (random.oneIn(2)) return 0.5 * (t.b + t.c);
  return random.pointOf(t);
}

Vector3d farAway(Random& random) { return kFarAway * random.inCube(); }

/// Multiples of an eighth, up to 2 m from 0.
double eighth(Random& random) { return std::floor(random.uniform(-16, 17)) / 8; }

// ---- triangles

Extreme ofKind(const std::string& name, TriangleKind kind, const TriangleMesh& organ) {
  return {name, [kind](Random& random) { return random.sample(kind); },
          [kind](Random& random) { return core::anyPair(random, kind); }, organ, anywhere};
}

TriangleKind anyKind(Random& random) {
  constexpr auto kCount = static_cast<double>(core::kTriangleKinds.size());
  return core::kTriangleKinds[static_cast<std::size_t>(random.uniform(0, kCount))];
}

Triangle ofAnyKind(Random& random) { return random.triangle(anyKind(random)); }

Triangle exponential(Random& random) {
  const auto corner = [&random] {
    return Vector3d(std::exp2(std::floor(random.uniform(-100, 100))) * random.inCube());
  };
  return {corner(), corner(), corner()};
}

/// As far from every (t, t, t) with one corner as with the others, and as far with one edge.
Triangle turning(Random& random) {
  const double x = eighth(random);
  const double y = eighth(random);
  const double z = eighth(random);
  return {{x, y, z}, {y, z, x}, {z, x, y}};
}

// ---- classes

Extreme exponentiallySpaced() {
  return {"exponentially spaced",
          [](Random& random) {
            return Sample{exponential(random).a, exponential(random)};
          },
          [](Random& random) {
            return Pair{exponential(random), exponential(random)};
          },
          exponentialTetrahedra(), anywhere};
}

/// Triangles that are the same, share an edge, or lie one in the other's plane.
Extreme coincident() {
  return {"coincident, duplicated",
          [](Random& random) { return random.sample(TriangleKind::kLattice); },
          [](Random& random) {
            const Triangle t = ofAnyKind(random);
            if (random.oneIn(3)) return Pair{t, core::reordered(t, 4)};
            if (random.oneIn(2)) return Pair{t, {t.b, t.a, random.inCube()}};
            return Pair{t, {random.pointOf(t), random.pointOf(t), t.a}};
          },
          tripled(ball()), anywhere};
}

Extreme ties() {
  const auto mirrored = [](const Vector3d& x) { return Vector3d(x.x(), x.y(), -x.z()); };
  return {"equidistant ties",
          [](Random& random) {
            return Sample{Vector3d::Constant(eighth(random)), turning(random)};
          },
          [mirrored](Random& random) {
            return Pair{turning(random), moved(turning(random), mirrored)};
          },
          cube(),
          [](Random& random, const TriangleMesh&) -> Vector3d {
            const double x = eighth(random);
            const double y = random.oneIn(2) ? x : eighth(random);
            return core::reordered({{x, x, -y}, {x, y, x}, {-y, x, x}},
                                   static_cast<int>(random.uniform(0, 3)))
                .a;
          }};
}

Extreme touching() {
  return {"on vertices, edges, faces",
          [](Random& random) {
            const Triangle t = ofAnyKind(random);
            return Sample{onSurface(random, t), t};
          },
          [](Random& random) { return core::closePair(random, TriangleKind::kRandom); }, ball(),
          [](Random& random, const TriangleMesh& organ) {
            return onSurface(random, organ.triangle(anyTriangle(random, organ)));
          }};
}

Extreme farTips() {
  return {"1e30 m away",
          [](Random& random) {
            return Sample{farAway(random), ofAnyKind(random)};
          },
          [](Random& random) {
            const Vector3d away = farAway(random);
            return Pair{ofAnyKind(random), moved(ofAnyKind(random), [&away](const Vector3d& x) {
                          return Vector3d(x + away);
                        })};
          },
          ball(), [](Random& random, const TriangleMesh&) { return farAway(random); }};
}

Extreme scaledBy(double factor, const std::string& name, const Extreme& from) {
  return moved(name, from, [factor](const Vector3d& x) { return Vector3d(factor * x); });
}

Extreme offsetBy(int exponent) {
  const Vector3d offset = std::pow(10.0, exponent) * Vector3d(0.7, -1.0, 0.9);
  return moved("1e" + std::to_string(exponent) + " m from the origin",
               ofKind("", TriangleKind::kRandom, ball()),
               [offset](const Vector3d& x) { return Vector3d(10 * x + offset); });
}

}  // namespace

std::vector<Extreme> extremes() {
  const auto stretched = [](const Vector3d& factors) {
    return moved(ball(),
                 [&factors](const Vector3d& x) { return Vector3d(x.cwiseProduct(factors)); });
  };
  std::vector<Extreme> all = {
      ofKind("random", TriangleKind::kRandom, ball()),
      ofKind("needles", TriangleKind::kNeedle, stretched({1e-7, 1e-7, 1})),
      ofKind("caps", TriangleKind::kCap, split(ball(), {0.3, 0.7 - kThin, kThin})),
      ofKind("zero area", TriangleKind::kZeroArea, split(ball(), {1, 0, 0})),
      coincident(),
      ofKind("mixed scales", TriangleKind::kMixedScale, stretched({1e-6, 1, 1e6})),
  };
  for (const int exponent : {3, 6, 9, 12, 15}) all.push_back(offsetBy(exponent));
  all.push_back(scaledBy(1e-4, "0.1 mm in size", all.front()));
  const Extreme any = {"", [](Random& random) { return random.sample(anyKind(random)); },
                       [](Random& random) { return core::anyPair(random, anyKind(random)); },
                       ball(), anywhere};
  all.push_back(scaledBy(0x1p-300, "times 2^-300", any));
  all.push_back(scaledBy(0x1p+300, "times 2^300", any));
  all.push_back(exponentiallySpaced());
  all.push_back({"one triangle", {}, {}, {kFourPoints, {corners(0, 1, 2)}}, anywhere});
  all.push_back(
      {"two triangles", {}, {}, {kFourPoints, {corners(0, 1, 2), corners(0, 2, 3)}}, anywhere});
  all.push_back(ties());
  all.push_back(touching());
  all.push_back(farTips());
  return all;
}

}  // namespace organ_collision::tools
