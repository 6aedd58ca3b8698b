#include "node/markers.h"

#include <tf2_eigen/tf2_eigen.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <utility>
#include <variant>

#include "node/conversions.h"
#include "organ_collision/core/sign.h"

namespace organ_collision::node {
namespace {

using visualization_msgs::Marker;

constexpr double kEdgeWidth = 0.00012;    // [m]
constexpr double kLineWidth = 0.001;      // [m]
constexpr double kOutlineWidth = 0.0012;  // [m]
constexpr double kNormalLength = 0.008;   // [m]
constexpr double kTextHeight = 0.008;     // [m]
constexpr double kLift = 0.0003;          // [m] above the surface, so that it does not show through

std_msgs::ColorRGBA colour(double red, double green, double blue, double alpha = 1.0) {
  std_msgs::ColorRGBA result;
  result.r = static_cast<float>(red);
  result.g = static_cast<float>(green);
  result.b = static_cast<float>(blue);
  result.a = static_cast<float>(alpha);
  return result;
}

/// Darker after each six.
std_msgs::ColorRGBA instrumentColour(std::size_t instrument) {
  constexpr float kDarker = 0.6F;
  static const std::array<std_msgs::ColorRGBA, 6> kColours = {
      colour(1.0, 0.9, 0.0), colour(0.1, 1.0, 0.2), colour(0.2, 0.7, 1.0),
      colour(1.0, 0.5, 0.0), colour(0.9, 0.3, 1.0), colour(1.0, 1.0, 1.0)};
  std_msgs::ColorRGBA colour = kColours[instrument % kColours.size()];
  for (std::size_t i = kColours.size(); i <= instrument; i += kColours.size()) {
    for (float* const part : {&colour.r, &colour.g, &colour.b}) *part *= kDarker;
  }
  return colour;
}

Marker marker(const std::string& frame, const std::string& what, std::size_t id, int type,
              const std_msgs::ColorRGBA& colour) {
  Marker result;
  result.header.frame_id = frame;  // stamp zero: where the frame is now
  result.frame_locked = true;      // and where it goes
  result.ns = what;
  result.id = static_cast<int>(id);
  result.type = type;
  result.color = colour;
  result.pose.orientation.w = 1.0;
  return result;
}

std::array<geometry_msgs::Point, 3> liftedCorners(const core::CollisionMesh& mesh,
                                                  core::TriangleId triangle,
                                                  const Eigen::Vector3d& lift) {
  const core::Triangle corners = mesh.mesh().triangle(triangle);
  return {toPoint(corners.a + lift), toPoint(corners.b + lift), toPoint(corners.c + lift)};
}

/// Filled and outlined, in the organ's frame; the outline keeps small triangles in sight.
void addTriangle(visualization_msgs::MarkerArray& array, std::size_t id, const Organ& organ,
                 core::TriangleId triangle, const std_msgs::ColorRGBA& colour) {
  const std::shared_ptr<const OrganSnapshot> snapshot = organ.snapshot();
  const bool is_of_former_topology =
      core::index(triangle) >= snapshot->organ.mesh().triangleCount();
  if (is_of_former_topology) return;
  const Eigen::Vector3d normal =
      core::pseudonormal(snapshot->organ, triangle, core::Feature::kFace);
  Marker filled = marker(organ.frame(), "nearest_triangle", id, Marker::TRIANGLE_LIST, colour);
  filled.scale.x = filled.scale.y = filled.scale.z = 1.0;
  for (const auto& corner : liftedCorners(snapshot->organ, triangle, kLift * normal))
    filled.points.push_back(corner);
  Marker outline =
      marker(organ.frame(), "nearest_triangle_outline", id, Marker::LINE_STRIP, colour);
  outline.scale.x = kOutlineWidth;
  outline.points = filled.points;
  outline.points.push_back(outline.points.front());
  array.markers.push_back(filled);
  array.markers.push_back(outline);
}

void addLine(visualization_msgs::MarkerArray& array, const std::string& what, std::size_t id,
             const std::string& frame, const std::array<geometry_msgs::Point, 2>& ends,
             const std_msgs::ColorRGBA& colour) {
  Marker line = marker(frame, what, id, Marker::LINE_LIST, colour);
  line.scale.x = kLineWidth;
  line.points.assign(ends.begin(), ends.end());
  array.markers.push_back(line);
}

void addNormal(visualization_msgs::MarkerArray& array, std::size_t id, const std::string& frame,
               const NearestTriangle& nearest) {
  Marker arrow = marker(frame, "normal", id, Marker::ARROW, colour(0.95, 0.95, 0.95));
  arrow.scale.x = kLineWidth;        // of the shaft
  arrow.scale.y = 2.5 * kLineWidth;  // of the head
  geometry_msgs::Point end = nearest.point;
  end.x += kNormalLength * nearest.normal.x;
  end.y += kNormalLength * nearest.normal.y;
  end.z += kNormalLength * nearest.normal.z;
  arrow.points = {nearest.point, end};
  array.markers.push_back(arrow);
}

/// How many texts of the same instrument are below that of a pair.
std::size_t linesBelow(const std::vector<io::Pair>& pairs, std::size_t number) {
  const auto end = pairs.begin() + static_cast<std::ptrdiff_t>(number);
  return static_cast<std::size_t>(std::count_if(pairs.begin(), end, [&](const io::Pair& pair) {
    return pair.instrument == pairs[number].instrument;
  }));
}

/// Above a point, and so many lines of text there.
void addText(visualization_msgs::MarkerArray& array, const std::string& what, std::size_t id,
             const std::string& frame, const geometry_msgs::Point& point, std::size_t lines,
             const std::string& words, bool is_alarming) {
  Marker text = marker(frame, what, id, Marker::TEXT_VIEW_FACING,
                       is_alarming ? colour(1, 0.3, 0.2) : colour(1, 1, 1));
  text.scale.z = kTextHeight;
  text.pose.position = point;
  text.pose.position.z += (3.0 + 1.5 * static_cast<double>(lines)) * kTextHeight;
  text.text = words;
  array.markers.push_back(text);
}

/// Of a contact or a proximity.
std::string inWords(const std::string& who, double distance, bool colliding, std::uint8_t status) {
  std::array<char, 64> words{};
  std::snprintf(words.data(), words.size(), " %.1f mm%s%s", 1e3 * distance,
                colliding ? ", touching" : "", status == Contact::STALE ? ", stale" : "");
  return who + words.data();
}

/// By three, as a marker's triangles are.
std::vector<geometry_msgs::Point> cornersOfAll(const core::TriangleMesh& mesh) {
  std::vector<geometry_msgs::Point> points;
  points.reserve(3 * mesh.triangleCount());
  for (const core::Corners& corners : mesh.triangles()) {
    for (const core::VertexId corner : corners) points.push_back(toPoint(mesh.position(corner)));
  }
  return points;
}

/// Draws one instrument's shapes.
class ShapePainter {
 public:
  ShapePainter(const Instrument& instrument, const std_msgs::ColorRGBA& colour)
      : instrument_(instrument), colour_(colour) {
    colour_.a = static_cast<float>(kSeeThrough);
  }

  void operator()(const Eigen::Vector3d& point) { addBall(point, 0.0); }
  void operator()(const core::Sphere& sphere) { addBall(sphere.centre, sphere.radius); }
  void operator()(const core::Capsule& capsule) {
    addBall(capsule.start, capsule.radius);
    addBall(capsule.end, capsule.radius);
    const Eigen::Vector3d way = capsule.end - capsule.start;
    const Eigen::Vector3d middle = capsule.start + 0.5 * way;
    const double thickness = thicknessOf(capsule.radius);
    Marker& side = add(Marker::CYLINDER);
    side.scale = toVector({thickness, thickness, std::max(way.norm(), kThinnest)});
    side.pose = tf2::toMsg(
        Eigen::Isometry3d(Eigen::Translation3d(middle) *
                          Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), way)));
  }
  void operator()(const core::Triangle& triangle) {
    Marker& face = add(Marker::TRIANGLE_LIST);
    for (const Eigen::Vector3d& corner : core::cornersOf(triangle))
      face.points.push_back(toPoint(corner));
  }
  void operator()(const core::RigidMesh& mesh) {
    Marker& surface = add(Marker::TRIANGLE_LIST);
    surface.points = cornersOfAll(mesh.surface->mesh());
    surface.pose = tf2::toMsg(Eigen::Isometry3d(mesh.pose));
  }

  visualization_msgs::MarkerArray take() { return std::move(array_); }

 private:
  static constexpr double kSeeThrough = 0.4;  // of 1, which is opaque
  static constexpr double kThinnest = 0.001;  // [m]

  static double thicknessOf(double radius) { return std::max(2.0 * radius, kThinnest); }

  Marker& add(int type) {
    array_.markers.push_back(marker(instrument_.frame, "shape_of_" + instrument_.name,
                                    array_.markers.size(), type, colour_));
    Marker& added = array_.markers.back();
    added.scale = toVector({1, 1, 1});
    return added;
  }

  void addBall(const Eigen::Vector3d& centre, double radius) {
    const double thickness = thicknessOf(radius);
    Marker& ball = add(Marker::SPHERE);
    ball.scale = toVector({thickness, thickness, thickness});
    ball.pose.position = toPoint(centre);
  }

  const Instrument& instrument_;
  std_msgs::ColorRGBA colour_;
  visualization_msgs::MarkerArray array_;
};

Marker surfaceMarker(const Organ& organ, const core::TriangleMesh& mesh) {
  Marker surface = marker(organ.frame(), "surface_of_" + organ.name(), 0, Marker::TRIANGLE_LIST,
                          colour(0.55, 0.16, 0.12));
  surface.scale.x = surface.scale.y = surface.scale.z = 1.0;
  surface.points = cornersOfAll(mesh);
  return surface;
}

Marker edgesMarker(const Organ& organ, const core::CollisionMesh& mesh) {
  Marker edges = marker(organ.frame(), "edges_of_" + organ.name(), 0, Marker::LINE_LIST,
                        colour(0.15, 0.03, 0.03));
  edges.scale.x = kEdgeWidth;
  // Then each edge is drawn in one sense, by the triangle that has it in that sense.
  const bool has_both_senses = mesh.topology().closed() && mesh.topology().consistentlyWound();
  for (std::size_t i = 0; i < mesh.mesh().triangleCount(); ++i) {
    const auto id = static_cast<core::TriangleId>(i);
    const Eigen::Vector3d lift = 0.3 * kLift * core::pseudonormal(mesh, id, core::Feature::kFace);
    const auto corners = liftedCorners(mesh, id, lift);
    const core::Corners& vertices = mesh.mesh().corners(id);
    const auto weld = [&](std::size_t corner) { return mesh.topology().weld(vertices[corner]); };
    for (const std::size_t from : {0, 1, 2}) {
      const std::size_t to = (from + 1) % 3;
      if (weld(from) < weld(to) || !has_both_senses) {
        edges.points.push_back(corners[from]);
        edges.points.push_back(corners[to]);
      }
    }
  }
  return edges;
}

/// Unless drawn again.
void letGoAway(visualization_msgs::MarkerArray& array) {
  for (Marker& each : array.markers) each.lifetime = ros::Duration(0.5);
}

}  // namespace

visualization_msgs::MarkerArray noMarkers(const std::string& frame) {
  visualization_msgs::MarkerArray array;
  array.markers.push_back(marker(frame, "all", 0, Marker::CUBE, colour(1.0, 1.0, 1.0)));
  array.markers.back().action = Marker::DELETEALL;
  return array;
}

visualization_msgs::MarkerArray organMarkers(const Organ& organ) {
  const std::shared_ptr<const OrganSnapshot> snapshot = organ.snapshot();
  visualization_msgs::MarkerArray array;
  array.markers.push_back(surfaceMarker(organ, snapshot->organ.mesh()));
  array.markers.push_back(edgesMarker(organ, snapshot->organ));
  return array;
}

visualization_msgs::MarkerArray instrumentMarkers(const Instruments& instruments,
                                                  std::size_t number) {
  ShapePainter painter(instruments[number], instrumentColour(number));
  for (const core::Shape& shape : instruments[number].shapes) std::visit(painter, shape);
  return painter.take();
}

visualization_msgs::MarkerArray contactMarkers(const ContactArray& contacts, const io::Scene& scene,
                                               const Organs& organs) {
  visualization_msgs::MarkerArray array;
  for (std::size_t i = 0; i < contacts.contacts.size(); ++i) {
    const Contact& contact = contacts.contacts[i];
    const io::Pair& pair = scene.pairs[i];
    const std::string& frame = contacts.header.frame_id;
    if (!std::isfinite(contact.nearest.distance)) continue;
    const std_msgs::ColorRGBA colour = instrumentColour(pair.instrument);
    addTriangle(array, i, *organs[pair.organ],
                static_cast<core::TriangleId>(contact.nearest.triangle), colour);
    addLine(array, "tip_to_organ", i, frame, {contact.instrument_point, contact.nearest.point},
            colour);
    addNormal(array, i, frame, contact.nearest);
    const std::string who = organs.size() == 1
                                ? contact.instrument
                                : contact.instrument + " - " + organs[pair.organ]->name();
    addText(array, "distance", i, frame, contact.instrument_point, linesBelow(scene.pairs, i),
            inWords(who, contact.nearest.distance, contact.colliding, contact.status),
            contact.colliding || contact.status != Contact::OK);
  }
  letGoAway(array);
  return array;
}

visualization_msgs::MarkerArray proximityMarkers(const ProximityArray& proximities) {
  visualization_msgs::MarkerArray array;
  for (std::size_t i = 0; i < proximities.proximities.size(); ++i) {
    const Proximity& proximity = proximities.proximities[i];
    const std::string& frame = proximities.header.frame_id;
    if (!std::isfinite(proximity.distance)) continue;
    addLine(array, "proximity", i, frame, {proximity.point_on_first, proximity.point_on_second},
            colour(0.95, 0.95, 0.95));
    const Eigen::Vector3d middle =
        0.5 * (fromPoint(proximity.point_on_first) + fromPoint(proximity.point_on_second));
    addText(array, "proximity_distance", i, frame, toPoint(middle), 0,
            inWords(proximity.first + " - " + proximity.second, proximity.distance,
                    proximity.colliding, proximity.status),
            proximity.colliding || proximity.status != Contact::OK);
  }
  letGoAway(array);
  return array;
}

}  // namespace organ_collision::node
