#include "node/markers.h"

#include <gmock/gmock.h>

#include <array>
#include <limits>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "node/conversions.h"
#include "test_meshes.h"

namespace organ_collision::node {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::Field;
using testing::SizeIs;
using visualization_msgs::Marker;

geometry_msgs::Point point(double x, double y, double z) { return toPoint({x, y, z}); }

/// Two tips, each above a cube of its own.
class MarkersTest : public testing::Test {
 protected:
  MarkersTest() {
    scene_.pairs = {{0, 0}, {1, 1}};
    organs_.push_back(std::make_unique<Organ>("liver", "liver_frame", test::cube()));
    organs_.push_back(std::make_unique<Organ>("stomach", "stomach_frame", test::cube(2.0)));
    contacts_.header.frame_id = "world";
    contacts_.contacts = {above("left"), above("right")};
  }

  static Contact above(const std::string& instrument) {
    Contact contact;
    contact.instrument = instrument;
    contact.instrument_point = point(10.5, 0.5, 1.25);
    contact.nearest.point = point(10.5, 0.5, 1.0);
    contact.nearest.normal = toVector({0, 0.6, 0.8});
    contact.nearest.distance = 0.0125;
    contact.nearest.triangle = 2;  // (0, 0, 1), (1, 0, 1), (0, 1, 1) of a unit cube
    return contact;
  }

  std::vector<Marker> markers() const { return contactMarkers(contacts_, scene_, organs_).markers; }

  std::vector<Marker> markers(const std::string& what) const {
    std::vector<Marker> shown;
    for (const Marker& marker : markers()) {
      if (marker.ns == what) shown.push_back(marker);
    }
    return shown;
  }

  io::Scene scene_;
  Organs organs_;
  ContactArray contacts_;
};

TEST_F(MarkersTest, OfTwoInstrumentsDoNotReplaceEachOther) {
  std::set<std::pair<std::string, int>> names;
  for (const Marker& marker : markers()) names.emplace(marker.ns, marker.id);
  EXPECT_THAT(names, SizeIs(10));
  EXPECT_THAT(markers(), SizeIs(10));
  EXPECT_NE(markers("tip_to_organ").front().color, markers("tip_to_organ").back().color);
}

TEST_F(MarkersTest, FollowTheirFramesAndGoAwayWhenNobodyDrawsThemAnew) {
  for (const Marker& marker : markers()) {
    EXPECT_TRUE(marker.frame_locked);
    EXPECT_TRUE(marker.header.stamp.isZero());
    EXPECT_GT(marker.lifetime, ros::Duration(0.0));
    EXPECT_LT(marker.lifetime, ros::Duration(1.0));
  }
}

TEST_F(MarkersTest, JoinTheInstrumentAndTheOrganInTheFrameOfTheContacts) {
  const Marker line = markers("tip_to_organ").front();
  EXPECT_EQ(line.header.frame_id, "world");
  EXPECT_THAT(line.points, ElementsAre(point(10.5, 0.5, 1.25), point(10.5, 0.5, 1.0)));
  const Marker arrow = markers("normal").front();
  EXPECT_EQ(arrow.header.frame_id, "world");
  EXPECT_EQ(arrow.points[0], point(10.5, 0.5, 1.0));
  const Eigen::Vector3d along = fromPoint(arrow.points[1]) - fromPoint(arrow.points[0]);
  EXPECT_LE((along.normalized() - Eigen::Vector3d(0, 0.6, 0.8)).norm(), 1e-12);
}

TEST_F(MarkersTest, TellTheDistanceInMillimetresBesideTheInstrument) {
  contacts_.contacts[1].colliding = true;
  contacts_.contacts[1].status = Contact::STALE;
  contacts_.contacts[1].nearest.distance = -0.001;
  const auto texts = markers("distance");
  EXPECT_EQ(texts.front().text, "left - liver 12.5 mm");
  EXPECT_EQ(texts.front().pose.position.x, 10.5);
  EXPECT_GT(texts.front().pose.position.z, 1.25);
  EXPECT_EQ(texts.back().text, "right - stomach -1.0 mm, touching, stale");
  EXPECT_NE(texts.back().color, texts.front().color);
}

TEST_F(MarkersTest, WriteTextsOfOneInstrumentAboveEachOther) {
  scene_.pairs[1].instrument = scene_.pairs[0].instrument;
  contacts_.contacts[1].instrument_point = contacts_.contacts[0].instrument_point;
  const auto texts = markers("distance");
  EXPECT_GT(texts[1].pose.position.z - texts[0].pose.position.z, texts[0].scale.z);
}

TEST_F(MarkersTest, GiveEachOfEightInstrumentsAColourOfItsOwn) {
  const Instruments instruments(8, {"left", "left_tip", {core::Shape(Eigen::Vector3d(0, 0, 0))}});
  std::set<std::array<float, 3>> colours;
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const auto& colour = instrumentMarkers(instruments, i).markers.front().color;
    colours.insert({colour.r, colour.g, colour.b});
  }
  EXPECT_THAT(colours, SizeIs(8));
}

TEST_F(MarkersTest, ShowTheNearestTriangleInTheFrameOfItsOrgan) {
  const auto triangles = markers("nearest_triangle");
  ASSERT_THAT(triangles, SizeIs(2));
  EXPECT_EQ(triangles[0].header.frame_id, "liver_frame");
  EXPECT_EQ(triangles[1].header.frame_id, "stomach_frame");
  EXPECT_EQ(triangles[0].points[1].x, 1.0);
  EXPECT_EQ(triangles[1].points[1].x, 2.0);
  for (const geometry_msgs::Point& corner : triangles[0].points) {
    EXPECT_GT(corner.z, 1.0) << "else the surface hides it";
    EXPECT_LT(corner.z, 1.001);
  }
}

TEST_F(MarkersTest, ShowNothingWhereThereIsNoAnswer) {
  contacts_.contacts[0].nearest = noNearestTriangle(1.0);
  EXPECT_THAT(markers(), AllOf(SizeIs(5), Each(Field(&Marker::id, 1))));
}

TEST_F(MarkersTest, ShowNoTriangleThatTheMeshHasNoMore) {
  organs_[0]->replace({test::cube().positions(), {test::corners(4, 5, 6)}}, 0);
  EXPECT_THAT(markers("nearest_triangle"), ElementsAre(Field(&Marker::id, 1)));
  EXPECT_THAT(markers("nearest_triangle_outline"), ElementsAre(Field(&Marker::id, 1)));
  EXPECT_THAT(markers("tip_to_organ"), SizeIs(2));
}

core::Shapes oneOfEach() {
  const auto cube = std::make_shared<const core::CollisionMesh>(test::cube());
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(0, 0, -3);
  return {Eigen::Vector3d(1, 2, 3), core::Triangle{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
          core::Sphere{{4, 5, 6}, 0.25}, core::Capsule{{1, 0, 0}, {1, -4, 0}, 0.5},
          core::RigidMesh{cube, pose}};
}

TEST(InstrumentMarkers, ShowEveryShapeWhereItIs) {
  const Instruments instruments = {{"left", "left_tip", {}, 0.0},
                                   {"right", "right_tip", oneOfEach(), 0.0}};
  EXPECT_THAT(instrumentMarkers(instruments, 0).markers, SizeIs(0));
  const auto markers = instrumentMarkers(instruments, 1).markers;
  std::vector<int> types;
  for (std::size_t i = 0; i < markers.size(); ++i) {
    types.push_back(markers[i].type);
    EXPECT_EQ(markers[i].ns, "shape_of_right");
    EXPECT_EQ(markers[i].id, static_cast<int>(i));
    EXPECT_EQ(markers[i].header.frame_id, "right_tip");
    EXPECT_TRUE(markers[i].frame_locked);
    EXPECT_LT(markers[i].color.a, 1.0F) << "hides what is inside";
  }
  ASSERT_THAT(types,
              ElementsAre(Marker::SPHERE, Marker::TRIANGLE_LIST, Marker::SPHERE, Marker::SPHERE,
                          Marker::SPHERE, Marker::CYLINDER, Marker::TRIANGLE_LIST));
  EXPECT_EQ(markers[0].pose.position, point(1, 2, 3));
  EXPECT_GT(markers[0].scale.x, 0.0) << "rviz refuses what has no size";
  EXPECT_THAT(markers[1].points, ElementsAre(point(0, 0, 0), point(1, 0, 0), point(0, 1, 0)));
  EXPECT_EQ(markers[2].pose.position, point(4, 5, 6));
  EXPECT_EQ(markers[2].scale, toVector({0.5, 0.5, 0.5}));
  EXPECT_EQ(markers[3].pose.position, point(1, 0, 0));
  EXPECT_EQ(markers[4].pose.position, point(1, -4, 0));
  EXPECT_EQ(markers[5].pose.position, point(1, -2, 0));
  EXPECT_EQ(markers[5].scale, toVector({1, 1, 4}));
  const auto& turn = markers[5].pose.orientation;
  const Eigen::Vector3d axis =
      Eigen::Quaterniond(turn.w, turn.x, turn.y, turn.z) * Eigen::Vector3d::UnitZ();
  EXPECT_LE((axis - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12);
  EXPECT_THAT(markers[6].points, SizeIs(36));
  EXPECT_EQ(markers[6].pose.position, point(0, 0, -3));
}

TEST(ProximityMarkers, JoinTheNearestPointsWhereThereIsAnAnswer) {
  ProximityArray proximities;
  proximities.header.frame_id = "world";
  proximities.proximities.resize(2);
  proximities.proximities[0].distance = std::numeric_limits<double>::infinity();
  Proximity& proximity = proximities.proximities[1];
  proximity.first = "left";
  proximity.second = "right";
  proximity.distance = 0.0125;
  proximity.point_on_first = point(1, 0, 0);
  proximity.point_on_second = point(3, 0, 0);
  const auto markers = proximityMarkers(proximities).markers;
  ASSERT_THAT(markers, AllOf(SizeIs(2), Each(Field(&Marker::id, 1))));
  for (const Marker& marker : markers) {
    EXPECT_EQ(marker.header.frame_id, "world");
    EXPECT_GT(marker.lifetime, ros::Duration(0.0));
  }
  EXPECT_THAT(markers[0].points, ElementsAre(point(1, 0, 0), point(3, 0, 0)));
  EXPECT_EQ(markers[1].text, "left - right 12.5 mm");
  EXPECT_EQ(markers[1].pose.position.x, 2.0);
}

/// The edges that are drawn, without their sense, and how many lines that takes.
struct Edges {
  using End = std::pair<double, double>;
  std::set<std::set<End>> distinct;
  std::size_t lines;
};

Edges edgesOf(const core::TriangleMesh& mesh) {
  const auto markers = organMarkers(Organ("liver", "liver_frame", mesh)).markers;
  EXPECT_EQ(markers[0].points.size(), 3 * mesh.triangleCount());
  const auto& ends = markers[1].points;
  Edges edges = {{}, ends.size() / 2};
  for (std::size_t i = 0; i < ends.size(); i += 2)
    edges.distinct.insert(
        std::set<Edges::End>{{ends[i].x, ends[i].y}, {ends[i + 1].x, ends[i + 1].y}});
  return edges;
}

TEST(OrganMarkers, HaveEveryEdgeOfAnOpenMesh) {
  for (const core::TriangleMesh& grid : {test::grid(1, 1), test::turned(test::grid(1, 1))})
    EXPECT_THAT(edgesOf(grid).distinct, SizeIs(5));
}

/// The same triangles, none of which share a vertex.
core::TriangleMesh split(const core::TriangleMesh& mesh) {
  core::Points positions;
  std::vector<core::Corners> triangles;
  for (const core::Corners& corners : mesh.triangles()) {
    const std::size_t first = positions.size();
    for (const core::VertexId corner : corners) positions.push_back(mesh.position(corner));
    triangles.push_back(test::corners(first, first + 1, first + 2));
  }
  return {positions, triangles};
}

TEST(OrganMarkers, HaveEveryEdgeOfAClosedMeshOnce) {
  EXPECT_EQ(edgesOf(test::cube()).lines, 18U);
  EXPECT_EQ(edgesOf(split(test::cube())).lines, 18U);
}

TEST_F(MarkersTest, AlarmOfWhatTouchesAndOfWhatIsStale) {
  const auto calm = markers("distance").front().color;
  contacts_.contacts[0].colliding = true;
  contacts_.contacts[1].status = Contact::STALE;
  for (const Marker& text : markers("distance")) EXPECT_NE(text.color, calm) << text.text;
}

TEST_F(MarkersTest, NameTheOrganOnlyWhereThereAreSeveral) {
  organs_.pop_back();
  contacts_.contacts.pop_back();
  EXPECT_EQ(markers("distance").front().text, "left 12.5 mm");
}

TEST(ProximityMarkers, AlarmOfWhatTouchesAndOfWhatIsStale) {
  ProximityArray proximities;
  proximities.proximities.resize(3);
  proximities.proximities[1].colliding = true;
  proximities.proximities[2].status = Contact::STALE;
  const auto markers = proximityMarkers(proximities).markers;
  ASSERT_THAT(markers, SizeIs(6));
  EXPECT_NE(markers[3].color, markers[1].color);
  EXPECT_NE(markers[5].color, markers[1].color);
}

}  // namespace
}  // namespace organ_collision::node
