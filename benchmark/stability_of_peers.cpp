// How far are the answers of other libraries from the truth, on the inputs of measure_stability?
// Usage: stability_of_peers [SAMPLES]   default: 10000 points in each class, a tenth of pairs, a
// hundredth of tips
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btTriangleShape.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkEpaPenetrationDepthSolver.h>
#include <BulletCollision/NarrowPhaseCollision/btGjkPairDetector.h>
#include <BulletCollision/NarrowPhaseCollision/btPointCollector.h>
#include <BulletCollision/NarrowPhaseCollision/btVoronoiSimplexSolver.h>
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <embree3/rtcore.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/geometry/shape/sphere.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "contenders/float_closest_point.h"
#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/triangle_distance.h"
#include "organ_collision/core/triangle_intersection.h"
#include "reference/triangle_pairs.h"
#include "tools/output.h"
#include "tools/stability.h"

namespace organ_collision {
namespace {

using core::Triangle;
using core::TriangleId;
using core::TriangleMesh;
using Eigen::Vector3d;

/// How far a point [m] is from an organ [m], without sign.
using Organ = std::function<double(const Vector3d&)>;

struct Peer {
  std::string name;
  std::function<Organ(const TriangleMesh&)> organ;
  std::function<double(const Triangle&, const Triangle&)> distance;  ///< [m] none: it has no such
  std::function<bool(const Triangle&, const Triangle&)> intersect;   ///< none: it has no such
};

TriangleMesh meshOf(const Triangle& t) {
  return {{t.a, t.b, t.c}, {{core::VertexId{0}, core::VertexId{1}, core::VertexId{2}}}};
}

/// Less than 0 says that two shapes meet.
double notNegative(double distance) { return distance < 0.0 ? 0.0 : distance; }

Peer ours() {
  return {"ours",
          [](const TriangleMesh& mesh) -> Organ {
            const auto organ = std::make_shared<core::CollisionMesh>(mesh);
            return [organ](const Vector3d& tip) {
              return std::abs(nearestTriangle(*organ, tip).distance);
            };
          },
          [](const Triangle& first, const Triangle& second) {
            return std::sqrt(closestPoints(first, second).on_second.squared_distance);
          },
          core::trianglesIntersect};
}

// ---- CGAL: the kernel that its manual recommends where predicates must be right

namespace with_cgal {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 toCgal(const Vector3d& point) { return {point.x(), point.y(), point.z()}; }
Kernel::Triangle_3 toCgal(const Triangle& t) { return {toCgal(t.a), toCgal(t.b), toCgal(t.c)}; }

/// The tree, with the triangles that it points into.
struct Structure {
  explicit Structure(const TriangleMesh& mesh) {
    for (std::size_t i = 0; i < mesh.triangleCount(); ++i)
      triangles.push_back(toCgal(mesh.triangle(static_cast<TriangleId>(i))));
    tree.insert(triangles.begin(), triangles.end());
    tree.build();
  }
  Triangles triangles;
  Tree tree;
};

Organ organ(const TriangleMesh& mesh) {
  const auto structure = std::make_shared<Structure>(mesh);
  return [structure](const Vector3d& tip) {
    return std::sqrt(structure->tree.squared_distance(toCgal(tip)));
  };
}

Peer peer() {
  return {"CGAL", organ,
          [](const Triangle& first, const Triangle& second) {
            return std::sqrt(CGAL::squared_distance(toCgal(first), toCgal(second)));
          },
          [](const Triangle& first, const Triangle& second) {
            return CGAL::do_intersect(toCgal(first), toCgal(second));
          }};
}

}  // namespace with_cgal

// ---- FCL: OBBRSS volumes, which it names for distances; a tip is a sphere of radius 0

namespace with_fcl {

using Model = fcl::BVHModel<fcl::OBBRSSd>;

std::shared_ptr<Model> modelOf(const TriangleMesh& mesh) {
  std::vector<fcl::Triangle> triangles;
  for (const core::Corners& corners : mesh.triangles())
    triangles.emplace_back(index(corners[0]), index(corners[1]), index(corners[2]));
  auto model = std::make_shared<Model>();
  model->beginModel();
  model->addSubModel(mesh.positions(), triangles);
  model->endModel();
  return model;
}

Organ organ(const TriangleMesh& mesh) {
  return [model = modelOf(mesh)](const Vector3d& tip) {
    const fcl::Sphered point(0.0);
    fcl::Transform3d pose = fcl::Transform3d::Identity();
    pose.translation() = tip;
    fcl::DistanceResultd result;
    return notNegative(fcl::distance(model.get(), fcl::Transform3d::Identity(), &point, pose,
                                     fcl::DistanceRequestd(), result));
  };
}

double distance(const Triangle& first, const Triangle& second) {
  const fcl::Transform3d pose = fcl::Transform3d::Identity();
  fcl::DistanceResultd result;
  return notNegative(fcl::distance(modelOf(meshOf(first)).get(), pose,
                                   modelOf(meshOf(second)).get(), pose, fcl::DistanceRequestd(),
                                   result));
}

bool intersect(const Triangle& first, const Triangle& second) {
  const fcl::Transform3d pose = fcl::Transform3d::Identity();
  fcl::CollisionResultd result;
  return fcl::collide(modelOf(meshOf(first)).get(), pose, modelOf(meshOf(second)).get(), pose,
                      fcl::CollisionRequestd(), result) > 0;
}

}  // namespace with_fcl

// ---- Bullet: GJK with the margins that its manual advises to keep, taken off the distance again

namespace with_bullet {

btVector3 toBullet(const Vector3d& point) {
  return {static_cast<btScalar>(point.x()), static_cast<btScalar>(point.y()),
          static_cast<btScalar>(point.z())};
}

btTriangleShape toBullet(const Triangle& t) {
  return {toBullet(t.a), toBullet(t.b), toBullet(t.c)};
}

double distance(const btConvexShape& first, const btVector3& place, const btConvexShape& second) {
  btVoronoiSimplexSolver simplex;
  btGjkEpaPenetrationDepthSolver depth;
  btGjkPairDetector detector(&first, &second, &simplex, &depth);
  btGjkPairDetector::ClosestPointInput input;
  input.m_transformA = btTransform(btQuaternion::getIdentity(), place);
  input.m_transformB.setIdentity();
  btPointCollector result;
  detector.getClosestPoints(input, result, nullptr);
  if (!result.m_hasResult) return std::numeric_limits<double>::quiet_NaN();
  return notNegative(result.m_distance + double{first.getMargin()} + second.getMargin());
}

Organ organ(const TriangleMesh& mesh) {
  return [mesh](const Vector3d& tip) {
    const btSphereShape point(CONVEX_DISTANCE_MARGIN);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
      const btTriangleShape triangle = toBullet(mesh.triangle(static_cast<TriangleId>(i)));
      const double found = distance(point, toBullet(tip), triangle);
      if (!(found >= least)) least = found;
      if (std::isnan(found)) break;
    }
    return least;
  };
}

}  // namespace with_bullet

// ---- Embree: a robust scene and the closest point of its own tutorial, in float

namespace with_embree {

using bench::in_float::toFloat;
using bench::in_float::Vector;

class Scene {
 public:
  explicit Scene(const TriangleMesh& mesh) {
    static const RTCDevice device = rtcNewDevice(nullptr);
    scene_ = rtcNewScene(device);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    positions_ = static_cast<Vector*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
                                                              RTC_FORMAT_FLOAT3, sizeof(Vector),
                                                              mesh.positions().size()));
    corners_ = static_cast<unsigned*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(unsigned), mesh.triangleCount()));
    for (std::size_t i = 0; i < mesh.positions().size(); ++i)
      positions_[i] = toFloat(mesh.positions()[i]);
    for (std::size_t i = 0; i < 3 * mesh.triangleCount(); ++i)
      corners_[i] = static_cast<unsigned>(mesh.triangles()[i / 3][i % 3]);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
  ~Scene() { rtcReleaseScene(scene_); }

  double distance(const Vector3d& tip) const {
    const Vector from = toFloat(tip);
    RTCPointQueryContext context;
    rtcInitPointQueryContext(&context);
    RTCPointQuery query{from.x, from.y, from.z, 0.0F, std::numeric_limits<float>::infinity()};
    Nearest nearest{this, std::numeric_limits<float>::infinity()};
    rtcPointQuery(scene_, &query, &context, measure, &nearest);
    return nearest.distance;
  }

 private:
  struct Nearest {
    const Scene* scene;
    float distance;
  };

  static bool measure(RTCPointQueryFunctionArguments* arguments) {
    Nearest& nearest = *static_cast<Nearest*>(arguments->userPtr);
    RTCPointQuery& query = *arguments->query;
    const Scene& scene = *nearest.scene;
    const unsigned* const corner = scene.corners_ + 3 * static_cast<std::size_t>(arguments->primID);
    const Vector tip{query.x, query.y, query.z};
    const Vector offset = closestPoint(tip, scene.positions_[corner[0]],
                                       scene.positions_[corner[1]], scene.positions_[corner[2]]) -
                          tip;
    const float distance = std::sqrt(dot(offset, offset));
    if (distance >= nearest.distance) return false;
    nearest.distance = distance;
    query.radius = distance;
    return true;
  }

  RTCScene scene_;
  Vector* positions_;
  unsigned* corners_;
};

Organ organ(const TriangleMesh& mesh) {
  const auto scene = std::make_shared<Scene>(mesh);
  return [scene](const Vector3d& tip) { return scene->distance(tip); };
}

}  // namespace with_embree

std::vector<Peer> peers() {
  return {ours(),
          with_cgal::peer(),
          {"FCL", with_fcl::organ, with_fcl::distance, with_fcl::intersect},
          {"Bullet",
           with_bullet::organ,
           [](const Triangle& first, const Triangle& second) {
             return with_bullet::distance(with_bullet::toBullet(first), btVector3(0, 0, 0),
                                          with_bullet::toBullet(second));
           },
           {}},
          {"Embree", with_embree::organ, {}, {}}};
}

// ---- measuring

/// What an action returns; NaN where it throws.
template <typename Action>
double answerOf(const Action& action) {
  try {
    return action();
  } catch (const std::exception&) {
    return std::numeric_limits<double>::quiet_NaN();
  }
}

void countError(tools::Tally& tally, double found, const core::exact::Real& truth, double extent) {
  ++tally.trials;
  if (std::isfinite(found)) {
    tally.worst = std::max(tally.worst, tools::errorOf(found, truth, extent));
  } else {
    ++tally.not_finite;
  }
}

enum Column { kPoint, kOrgan, kTriangles, kMeet };

/// What a peer made of a class.
struct Outcome {
  std::array<tools::Tally, 4> tallies;
  bool crashed = false;  ///< or took too long
};

void measurePoints(const tools::Extreme& extreme, const Peer& peer, std::size_t trials,
                   tools::Tally& tally) {
  tools::Extreme::Random random(1);
  for (std::size_t i = 0; extreme.sample && i < trials; ++i) {
    const core::Sample sample = extreme.sample(random);
    const auto& [tip, triangle] = sample;
    countError(tally, answerOf([&] { return peer.organ(meshOf(sample.triangle))(sample.query); }),
               core::exact::distance(tip, triangle), tools::extentOf(tip, triangle));
  }
}

void measureTips(const tools::Extreme& extreme, const Peer& peer, std::size_t trials,
                 tools::Tally& tally) {
  tools::Extreme::Random random(2);
  const Organ organ = peer.organ(extreme.organ);
  for (std::size_t i = 0; i < trials; ++i) {
    const Vector3d tip = extreme.tip(random, extreme.organ);
    const core::exact::Nearest nearest = core::exact::nearest(extreme.organ, tip);
    countError(tally, answerOf([&] { return organ(tip); }), nearest.distance,
               tools::extentOf(tip, extreme.organ.triangle(nearest.triangle)));
  }
}

void countMeeting(const Peer& peer, const Triangle& first, const Triangle& second, bool truth,
                  tools::Tally& tally) {
  ++tally.trials;
  const double meets = answerOf([&] { return peer.intersect(first, second) ? 1.0 : 0.0; });
  if (meets != (truth ? 1.0 : 0.0)) ++tally.wrong;
}

void measurePairs(const tools::Extreme& extreme, const Peer& peer, std::size_t trials,
                  Outcome& outcome) {
  tools::Extreme::Random random(3);
  for (std::size_t i = 0; extreme.pair && i < trials; ++i) {
    const auto pair = extreme.pair(random);
    const core::exact::Real truth = core::exact::distance(pair.first, pair.second);
    if (peer.distance) {
      countError(outcome.tallies[kTriangles],
                 answerOf([&] { return peer.distance(pair.first, pair.second); }), truth,
                 tools::extentOf(pair.first, pair.second));
    }
    if (peer.intersect)
      countMeeting(peer, pair.first, pair.second, truth == 0, outcome.tallies[kMeet]);
  }
}

/// The published cases in their 72 orders.
Outcome onPublishedCases(const Peer& peer) {
  Outcome outcome;
  for (const core::HardPair& pair : core::kHardPairs) {
    core::forEachOrder(pair.first, pair.second, [&](const Triangle& one, const Triangle& other) {
      if (peer.intersect)
        countMeeting(peer, one, other, pair.distance == 0, outcome.tallies[kMeet]);
    });
  }
  return outcome;
}

/// Runs `action` in a process of its own: libraries crash and hang.
template <typename Action>
Outcome inChild(const Action& action) {
  constexpr unsigned kPatience = 60;  // [s]
  int ends[2];
  if (pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = fork();
  if (child == 0) {
    alarm(kPatience);
    const Outcome outcome = action();
    _exit(write(ends[1], &outcome, sizeof outcome) == sizeof outcome ? 0 : 1);
  }
  close(ends[1]);
  Outcome outcome;
  const bool answered = read(ends[0], &outcome, sizeof outcome) == sizeof outcome;
  close(ends[0]);
  waitpid(child, nullptr, 0);
  if (!answered) outcome.crashed = true;
  return outcome;
}

/// What all peers made of one class.
struct Row {
  std::string name;
  std::vector<Outcome> outcomes;
};

Row measure(const tools::Extreme& extreme, const std::vector<Peer>& all,
            const tools::Trials& trials) {
  Row row{extreme.name, {}};
  for (const Peer& peer : all) {
    row.outcomes.push_back(inChild([&] {
      Outcome outcome;
      measurePoints(extreme, peer, trials.points, outcome.tallies[kPoint]);
      measureTips(extreme, peer, trials.tips, outcome.tallies[kOrgan]);
      measurePairs(extreme, peer, trials.pairs, outcome);
      return outcome;
    }));
  }
  return row;
}

// ---- the tables, in Markdown

using Cell = std::function<std::string(const tools::Tally&)>;

std::string errorCell(const tools::Tally& tally) {
  if (tally.trials == 0) return "-";
  const std::string worst =
      tally.worst < 100.0 ? tools::fixed(tally.worst, 2) : tools::significant(tally.worst, 2);
  return tally.not_finite == 0 ? worst : "NaN or inf";
}

std::string wrongCell(const tools::Tally& tally) {
  return tally.trials == 0 ? "-" : std::to_string(tally.wrong);
}

void printLine(const std::string& name, const std::vector<Outcome>& outcomes, Column column,
               const Cell& cell) {
  std::cout << "| " << name << " |";
  for (const Outcome& outcome : outcomes)
    std::cout << " " << (outcome.crashed ? "crash" : cell(outcome.tallies[column])) << " |";
  std::cout << "\n";
}

void print(const std::string& heading, const std::vector<Row>& rows, const std::vector<Peer>& all,
           Column column, const Cell& cell) {
  std::cout << "\n" << heading << "\n\n| |";
  for (const Peer& peer : all) std::cout << " " << peer.name << " |";
  std::cout << "\n|---|";
  for (std::size_t p = 0; p < all.size(); ++p) std::cout << "---|";
  std::cout << "\n";
  for (const Row& row : rows) {
    if (row.outcomes.front().tallies[column].trials > 0)
      printLine(row.name, row.outcomes, column, cell);
  }
}

}  // namespace
}  // namespace organ_collision

int main(int count, char** words) {
  using namespace organ_collision;
  CGAL::set_error_behaviour(CGAL::THROW_EXCEPTION);
  const tools::Trials trials(count > 1 ? std::stoul(words[1]) : 10'000);
  const std::vector<Peer> all = peers();
  std::vector<Row> rows;
  for (const tools::Extreme& extreme : tools::extremes()) {
    rows.push_back(measure(extreme, all, trials));
    std::cerr << "measured: " << extreme.name << std::endl;
  }
  std::vector<Outcome> published;
  for (const Peer& peer : all) published.push_back(inChild([&] { return onPublishedCases(peer); }));

  std::cout << "Of " << trials.points << " points and triangles, " << trials.tips
            << " tips and organs, " << trials.pairs << " pairs in each class\n";
  print("Point and triangle, worst error in u*extent", rows, all, kPoint, errorCell);
  print("Point and organ, worst error in u*extent", rows, all, kOrgan, errorCell);
  print("Two triangles, worst error in u*extent", rows, all, kTriangles, errorCell);
  print("Do two triangles meet, wrong answers", rows, all, kMeet, wrongCell);
  printLine("published cases in 72 orders each", published, kMeet, wrongCell);
}
