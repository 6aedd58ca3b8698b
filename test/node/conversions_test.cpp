#include "node/conversions.h"

#include <gmock/gmock.h>

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "node/cube_organ.h"
#include "node/moves.h"

namespace organ_collision::node {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::vector<double> coordinates(const geometry_msgs::Point& point) {
  return {point.x, point.y, point.z};
}

std::vector<double> coordinates(const geometry_msgs::Vector3& vector) {
  return {vector.x, vector.y, vector.z};
}

TEST(Conversions, OfAnAnswerMovePointAndNormalButNoLength) {
  const core::CollisionMesh mesh(test::cube());
  const core::NearestTriangle nearest = core::nearestTriangle(mesh, Vector3d(0.25, 0.5, 3));
  Isometry3d pose(Eigen::Translation3d(10, 20, 30));
  pose.linear() << 0, -1, 0, 1, 0, 0, 0, 0, 1;  // a quarter turn about z
  const NearestTriangle message = toMessage(nearest, pose);
  EXPECT_THAT(coordinates(message.point), ElementsAre(9.5, 20.25, 31));
  EXPECT_THAT(coordinates(message.normal), ElementsAre(0, 0, 1));
  EXPECT_EQ(message.distance, 2.0);
  EXPECT_EQ(message.triangle, static_cast<std::uint32_t>(nearest.triangle));
  const auto turned =
      toMessage(core::nearestTriangle(mesh, Vector3d(3, 0.25, 0.5)), Isometry3d(pose.linear()));
  EXPECT_THAT(coordinates(turned.normal), ElementsAre(0, 1, 0));
}

TEST(Conversions, OfAFeatureDoNotTellCornersAndEdgesApart) {
  core::NearestTriangle nearest{};
  const auto feature = [&nearest](core::Feature of) {
    nearest.closest.feature = of;
    return toMessage(nearest, Isometry3d::Identity()).feature;
  };
  using core::Feature;
  for (const Feature corner : {Feature::kVertexA, Feature::kVertexB, Feature::kVertexC})
    EXPECT_EQ(feature(corner), NearestTriangle::VERTEX);
  for (const Feature edge : {Feature::kEdgeAB, Feature::kEdgeBC, Feature::kEdgeCA})
    EXPECT_EQ(feature(edge), NearestTriangle::EDGE);
  EXPECT_EQ(feature(Feature::kFace), NearestTriangle::FACE);
}

TEST(Conversions, OfAProximityTellFirstFromSecond) {
  core::Proximity proximity{{1, 2, 3}, {4, 5, 6}, {0, 0, 1}, -0.5, -0.75, -0.25,
                            true,      false,     {},        {},   {}};
  proximity.triangle_of_second = core::TriangleId{7};
  const Proximity message = toMessage(proximity);
  EXPECT_THAT(coordinates(message.point_on_first), ElementsAre(1, 2, 3));
  EXPECT_THAT(coordinates(message.point_on_second), ElementsAre(4, 5, 6));
  EXPECT_THAT(coordinates(message.normal), ElementsAre(0, 0, 1));
  EXPECT_EQ(message.distance, -0.5);
  EXPECT_EQ(message.lower_bound, -0.75);
  EXPECT_EQ(message.upper_bound, -0.25);
  EXPECT_TRUE(message.colliding);
  EXPECT_FALSE(message.colliding_certain);
  EXPECT_EQ(message.triangle_of_first, -1) << "not a mesh";
  EXPECT_EQ(message.triangle_of_second, 7);
}

TEST(Conversions, OfAnAccuracyRefuseWhatIsNone) {
  Accuracy accuracy;
  accuracy.max_relative_error = 0.5;
  accuracy.max_absolute_error = 0.25;
  accuracy.max_leaves = 3;
  EXPECT_EQ(fromMessage(accuracy).max_relative_error, 0.5);
  EXPECT_EQ(fromMessage(accuracy).max_absolute_error, 0.25);
  EXPECT_EQ(fromMessage(accuracy).max_leaves, 3);
  accuracy.max_absolute_error = -1.0;
  EXPECT_THROW(fromMessage(accuracy), std::invalid_argument);
}

TEST(Conversions, OfMovesKeepEachVertexBesideItsPosition) {
  MeshUpdate update;
  update.indices = {5, 2};
  update.positions = {1, 2, 3, 4, 5, 6};
  const VertexMoves moves = movesFrom(update);
  EXPECT_THAT(moves.vertices, ElementsAre(core::VertexId{5}, core::VertexId{2}));
  EXPECT_THAT(moves.positions, ElementsAre(Vector3d(1, 2, 3), Vector3d(4, 5, 6)));
}

TEST(Conversions, OfMovesRefuseHalfAVertex) {
  MeshUpdate update;
  update.positions = {1, 2, 3, 4};
  EXPECT_THAT([&] { movesFrom(update); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("positions holds 4 numbers")));
}

TEST(Conversions, OfMovesRefuseIndicesWithoutPositions) {
  UpdateMesh::Request request;
  request.indices = {1, 2};
  EXPECT_THAT([&] { movesFrom(request); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("2 indices given without positions")));
}

TEST(Conversions, OfPositionsRefuseWhatRvizCannotShow) {
  UpdateMesh::Request request;
  request.positions = {1, 2, 3, 4, -3.5e38, 6};
  EXPECT_THAT([&] { movesFrom(request); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("positions[4] is -3.5e+38")));
  request.positions[4] = 3.4e38;
  EXPECT_THAT(movesFrom(request).positions, ElementsAre(Vector3d(1, 2, 3), Vector3d(4, 3.4e38, 6)));
}

TEST(Conversions, OfATopologyRefuseThatItHasNoPositions) {
  UpdateMesh::Request request;
  request.triangles.resize(1);
  EXPECT_THAT([&] { meshFrom(request); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("there are none")));
}

TEST(Conversions, OfAMeshThereAndBackChangeNothing) {
  const core::TriangleMesh cube = test::cube();
  const shape_msgs::Mesh message = toMessage(cube);
  UpdateMesh::Request request;
  request.triangles = message.triangles;
  for (const geometry_msgs::Point& vertex : message.vertices) {
    for (const double coordinate : coordinates(vertex)) request.positions.push_back(coordinate);
  }
  const core::TriangleMesh back = meshFrom(request);
  EXPECT_EQ(back.positions(), cube.positions());
  EXPECT_EQ(back.triangles(), cube.triangles());
  request.indices = {0};
  EXPECT_THROW(meshFrom(request), std::invalid_argument);
}

TEST(Conversions, OfAnOrganTellItsHealthAndItsBox) {
  const MeshInfo info = toMessage(cube());
  EXPECT_EQ(info.organ, "liver");
  EXPECT_EQ(info.header.frame_id, "liver_frame");
  EXPECT_EQ(info.mesh_version, 1);
  EXPECT_EQ(info.vertices, 8);
  EXPECT_EQ(info.triangles, 12);
  EXPECT_TRUE(info.closed);
  EXPECT_TRUE(info.consistently_wound);
  EXPECT_FALSE(info.inverted);
  EXPECT_THAT(coordinates(info.min), ElementsAre(0, 0, 0));
  EXPECT_THAT(coordinates(info.max), ElementsAre(1, 1, 1));
  EXPECT_EQ(info.last_action, MeshInfo::LOAD);
  EXPECT_EQ(info.cost_ratio, 1.0);
  EXPECT_GT(info.memory, 0);
}

TEST(Conversions, OfAnOrganTellEachFaultOfItsMesh) {
  const auto told = [](core::TriangleMesh mesh) {
    return toMessage(Organ("liver", "liver", std::move(mesh)));
  };
  EXPECT_TRUE(told(test::turned(test::cube())).inverted);
  const MeshInfo open = told(test::grid(1, 1));
  EXPECT_FALSE(open.closed);
  EXPECT_TRUE(open.consistently_wound);
  std::vector<core::Corners> triangles = test::cube().triangles();
  std::swap(triangles[0][0], triangles[0][1]);
  const MeshInfo unwound = told({test::cube().positions(), triangles});
  EXPECT_TRUE(unwound.closed);
  EXPECT_FALSE(unwound.consistently_wound);
  triangles.insert(triangles.end(), {triangles[3], triangles[3], test::corners(0, 0, 7)});
  const MeshInfo repeated = told({test::cube().positions(), triangles});
  EXPECT_EQ(repeated.degenerate_triangles, 1);
  EXPECT_EQ(repeated.duplicate_triangles, 2);
}

TEST(Conversions, OfAnOrganTellWhatBecameOfItsUpdates) {
  Organ organ = cube();
  for (const double z : {2.0, 3.0, 4.0}) organ.enqueue(test::movesOf({7}, {{1, 1, z}}));
  organ.countLostUpdates(1);
  organ.work();
  const MeshInfo info = toMessage(organ);
  EXPECT_EQ(info.updates_merged, 2);
  EXPECT_EQ(info.updates_lost, 1);
  EXPECT_EQ(info.mesh_version, 2);
  EXPECT_EQ(info.last_action, MeshInfo::PARTIAL_REFIT);
  EXPECT_THAT(info.reason, HasSubstr("streamed: 1 of 8 vertices moved"));
  EXPECT_THAT(coordinates(info.max), ElementsAre(1, 1, 4));
}

TEST(Conversions, OfAnOrganTellItsWear) {
  Organ organ("liver", "liver", test::blob(4));
  organ.update({{}, crushed(test::blob(4).positions())}, UpdateMode::kRefit, 0);
  for (int i = 0; i < 1024; ++i) organ.account({0, 0.02, 0.2}, {});
  organ.work();
  EXPECT_NE(organ.costRatio(), 1.0);
  EXPECT_EQ(toMessage(organ).cost_ratio, organ.costRatio());
}

TEST(Conversions, OfParametersKeepTheirKinds) {
  XmlRpc::XmlRpcValue parameter;
  parameter["yes"] = true;
  parameter["count"] = 3;
  parameter["length"] = 0.5;
  parameter["name"] = "liver";
  parameter["list"][0] = 1;
  parameter["list"][1] = "two";
  const char date[] = "20261123T12:00:00";
  std::string xml = std::string("<value><dateTime.iso8601>") + date + "</dateTime.iso8601></value>";
  int offset = 0;
  parameter["date"].fromXml(xml, &offset);
  const io::Map map = std::get<io::Map>(fromParameter(parameter));
  EXPECT_EQ(map.at("yes"), io::Value(true));
  EXPECT_EQ(map.at("count"), io::Value(3));
  EXPECT_EQ(map.at("length"), io::Value(0.5));
  EXPECT_EQ(map.at("name"), io::Value(std::string("liver")));
  EXPECT_EQ(map.at("list"), io::Value(io::List{1, std::string("two")}));
  EXPECT_EQ(map.at("date"), io::Value()) << "of no kind that a scene has";
}

}  // namespace
}  // namespace organ_collision::node
