#include "organ_collision/io/scene.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "temporary_folder.h"

namespace organ_collision::io {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Map organ(const std::string& name) {
  return {{"name", name}, {"frame", name + "_frame"}, {"mesh", "package://p/" + name + ".obj"}};
}

Map instrument(const std::string& name) { return {{"name", name}, {"frame", name + "_tip"}}; }

Map scene() {
  return {{"organs", List{organ("liver"), organ("stomach")}},
          {"instruments", List{instrument("left"), instrument("right")}}};
}

/// `map` with `key` set to `value`.
Map with(Map map, const std::string& key, Value value) {
  map[key] = std::move(value);
  return map;
}

Map without(Map map, const std::string& key) {
  map.erase(key);
  return map;
}

Map withOrgan(const Map& organ) { return with(scene(), "organs", List{organ}); }
Map withInstrument(const Map& instrument) { return with(scene(), "instruments", List{instrument}); }
Map withPairs(List pairs) { return with(scene(), "pairs", std::move(pairs)); }

List pair(const char* first, const char* second) {
  return {std::string(first), std::string(second)};
}

std::string refusal(const Value& value) {
  try {
    parseScene(value);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

std::vector<std::pair<std::size_t, std::size_t>> indices(const Scene& scene) {
  std::vector<std::pair<std::size_t, std::size_t>> all;
  for (const Pair& pair : scene.pairs) all.emplace_back(pair.instrument, pair.organ);
  return all;
}

Eigen::Vector3d pointOf(const Instrument& instrument) {
  return std::get<Eigen::Vector3d>(std::get<core::Shape>(instrument.geometry));
}

const List kCorners = {List{0, 0.001, 0}, List{0.0, -0.001, 0.0}, List{0.0, 0.0, 0.004}};

TEST(Scene, FillsInTheDefaults) {
  const Scene parsed = parseScene(scene());
  EXPECT_EQ(parsed.frame, "liver_frame");
  ASSERT_EQ(parsed.organs.size(), 2u);
  EXPECT_EQ(parsed.organs[1].name, "stomach");
  EXPECT_EQ(parsed.organs[1].frame, "stomach_frame");
  const auto& file = std::get<MeshFile>(parsed.organs[1].geometry);
  EXPECT_EQ(file.url, "package://p/stomach.obj");
  EXPECT_EQ(file.scale, 1.0);
  ASSERT_EQ(parsed.instruments.size(), 2u);
  EXPECT_EQ(parsed.instruments[0].name, "left");
  EXPECT_EQ(parsed.instruments[0].frame, "left_tip");
  EXPECT_EQ(pointOf(parsed.instruments[0]), Eigen::Vector3d::Zero());
  EXPECT_THAT(indices(parsed),
              ElementsAre(std::pair(0, 0), std::pair(0, 1), std::pair(1, 0), std::pair(1, 1)));
  EXPECT_EQ(parsed.max_distance, kInfinity);
  EXPECT_EQ(parsed.accuracy.max_relative_error, 0.0);
  EXPECT_EQ(parsed.accuracy.max_absolute_error, 0.0);
  EXPECT_EQ(parsed.accuracy.max_leaves, 0u);
  EXPECT_EQ(parsed.rate, 1000.0);
  EXPECT_EQ(parsed.stale_after, 0.1);
  EXPECT_FALSE(parsed.mesh_root);
}

TEST(Scene, TakesEveryKey) {
  Map full = scene();
  full["organs"] = List{with(organ("liver"), "scale", 0.001),
                        Map{{"name", "wall"}, {"frame", "wall"}, {"link", "abdomen"}}};
  full["instruments"] =
      List{with(instrument("left"), "shape", "point"),
           with(with(instrument("right"), "shape", "triangle"), "corners", kCorners)};
  full["frame"] = "world";
  full["pairs"] = List{pair("right", "liver"), pair("wall", "left")};
  full["max_distance"] = 0.05;
  full["accuracy"] =
      Map{{"max_relative_error", 0.1}, {"max_absolute_error", 1e-4}, {"max_leaves", 8}};
  full["rate"] = 500;
  full["stale_after"] = 1;
  full["mesh_root"] = "/srv/meshes";

  const Scene parsed = parseScene(full);
  EXPECT_EQ(parsed.frame, "world");
  EXPECT_EQ(std::get<MeshFile>(parsed.organs[0].geometry).scale, 0.001);
  EXPECT_EQ(std::get<RobotLink>(parsed.organs[1].geometry).name, "abdomen");
  EXPECT_EQ(pointOf(parsed.instruments[0]), Eigen::Vector3d::Zero());
  const auto& triangle =
      std::get<core::Triangle>(std::get<core::Shape>(parsed.instruments[1].geometry));
  EXPECT_EQ(triangle.a, Eigen::Vector3d(0, 0.001, 0));
  EXPECT_EQ(triangle.b, Eigen::Vector3d(0, -0.001, 0));
  EXPECT_EQ(triangle.c, Eigen::Vector3d(0, 0, 0.004));
  EXPECT_THAT(indices(parsed), ElementsAre(std::pair(1, 0), std::pair(0, 1)));
  EXPECT_EQ(parsed.max_distance, 0.05);
  EXPECT_EQ(parsed.accuracy.max_relative_error, 0.1);
  EXPECT_EQ(parsed.accuracy.max_absolute_error, 1e-4);
  EXPECT_EQ(parsed.accuracy.max_leaves, 8u);
  EXPECT_EQ(parsed.rate, 500.0);
  EXPECT_EQ(parsed.stale_after, 1.0);
  EXPECT_EQ(parsed.mesh_root, "/srv/meshes");
}

TEST(Scene, MayHaveNoInstrument) {
  const Scene parsed = parseScene(without(scene(), "instruments"));
  EXPECT_TRUE(parsed.instruments.empty());
  EXPECT_TRUE(parsed.pairs.empty());
}

TEST(Scene, AnEmptyListOfPairsMeansNone) { EXPECT_TRUE(parseScene(withPairs({})).pairs.empty()); }

TEST(Scene, RefusesUnknownKeysAtEachLevel) {
  EXPECT_EQ(refusal(with(scene(), "organ", List{})),
            "scene.organ: unknown key; known: frame, organs, instruments, pairs, max_distance, "
            "accuracy, rate, stale_after, mesh_root");
  EXPECT_EQ(refusal(withOrgan(with(without(organ("liver"), "mesh"), "mseh", "liver.obj"))),
            "scene.organs[0].mseh: unknown key; known: name, frame, mesh, link, scale");
  EXPECT_EQ(refusal(withInstrument(with(instrument("left"), "size", 0.005))),
            "scene.instruments[0].size: unknown key; known: name, frame, shape, corners, ends, "
            "radius, mesh, scale, link, convex");
  EXPECT_EQ(refusal(with(scene(), "accuracy", Map{{"epsilon", 0.1}})),
            "scene.accuracy.epsilon: unknown key; known: max_relative_error, max_absolute_error, "
            "max_leaves");
}

TEST(Scene, RefusesWhatIsMissing) {
  EXPECT_EQ(refusal(without(scene(), "organs")), "scene.organs: is missing");
  EXPECT_EQ(refusal(with(scene(), "organs", List{})), "scene.organs: one organ or more is wanted");
  for (const char* const key : {"name", "frame", "mesh"}) {
    EXPECT_EQ(refusal(withOrgan(without(organ("liver"), key))),
              std::string("scene.organs[0].") + key + ": is missing");
  }
  for (const char* const key : {"name", "frame"}) {
    EXPECT_EQ(refusal(withInstrument(without(instrument("left"), key))),
              std::string("scene.instruments[0].") + key + ": is missing");
  }
}

TEST(Scene, RefusesWrongTypes) {
  EXPECT_EQ(refusal(Value()), "scene: null, but it must be a map");
  EXPECT_EQ(refusal(List{}), "scene: a list of 0, but it must be a map");
  EXPECT_EQ(refusal(with(scene(), "organs", Map{})), "scene.organs: a map, but it must be a list");
  EXPECT_EQ(refusal(with(scene(), "organs", List{"liver"})),
            "scene.organs[0]: 'liver', but it must be a map");
  EXPECT_EQ(refusal(withOrgan(with(organ("liver"), "name", 7))),
            "scene.organs[0].name: 7, but it must be a text");
  EXPECT_EQ(refusal(withOrgan(with(organ("liver"), "scale", "big"))),
            "scene.organs[0].scale: 'big', but it must be a finite number above 0");
  EXPECT_EQ(refusal(with(scene(), "rate", true)),
            "scene.rate: true, but it must be a finite number above 0");
  EXPECT_EQ(refusal(with(scene(), "rate", -0.12345678901)),
            "scene.rate: -0.12345678901, but it must be a finite number above 0");
  EXPECT_EQ(
      refusal(with(scene(), "accuracy", Map{{"max_leaves", 1.5}})),
      "scene.accuracy.max_leaves: 1.5, but it must be an integer without a point, 0 or above");
  EXPECT_EQ(refusal(withInstrument(with(instrument("left"), "shape", Map{}))),
            "scene.instruments[0].shape: a map, but it must be a text");
}

TEST(Scene, RefusesNumbersOutOfRange) {
  EXPECT_EQ(
      refusal(with(scene(), "organs", List{organ("liver"), with(organ("stomach"), "scale", -2)})),
      "scene.organs[1].scale: -2, but it must be a finite number above 0");
  for (const double number : {0.0, -1.0, kNan, kInfinity}) {
    EXPECT_THAT(refusal(withOrgan(with(organ("liver"), "scale", number))),
                HasSubstr("[0].scale: "));
    for (const char* const key : {"max_distance", "rate", "stale_after"}) {
      EXPECT_THAT(refusal(with(scene(), key, number)),
                  HasSubstr("but it must be a finite number above 0"))
          << key << " " << number;
    }
  }
  for (const auto& [key, most] : Map{{"max_relative_error", 10}, {"max_absolute_error", 1}}) {
    const auto refused = [&, name = key](const Value& number) {
      return refusal(with(scene(), "accuracy", Map{{name, number}}));
    };
    for (const double number : {-1e-300, kNan, kInfinity, 10.001}) {
      EXPECT_THAT(refused(number), HasSubstr("but it must be a number from 0 to " +
                                             std::to_string(std::get<int>(most))));
    }
    EXPECT_EQ(refused(0), "accepted");
    EXPECT_EQ(refused(most), "accepted");
  }
  EXPECT_EQ(refusal(with(scene(), "accuracy", Map{{"max_leaves", -1}})),
            "scene.accuracy.max_leaves: -1, but it must be an integer without a point, 0 or above");
}

TEST(Scene, TellsHowANumberIsWrittenThatCameAsAText) {
  EXPECT_EQ(refusal(withOrgan(with(organ("liver"), "scale", "1e-3"))),
            "scene.organs[0].scale: '1e-3', but it must be a finite number above 0, written like "
            "0.001 or 1.0e-3");
  EXPECT_EQ(refusal(withOrgan(with(organ("liver"), "scale", "1e-3 m"))),
            "scene.organs[0].scale: '1e-3 m', but it must be a finite number above 0");
}

TEST(Scene, RefusesEmptyTextsAndFramesWithASlash) {
  EXPECT_EQ(refusal(withOrgan(with(organ("liver"), "name", ""))),
            "scene.organs[0].name: '', but it must be a text that is not empty");
  EXPECT_EQ(refusal(with(scene(), "mesh_root", "")),
            "scene.mesh_root: '', but it must be a text that is not empty");
  EXPECT_EQ(refusal(with(scene(), "frame", "/world")),
            "scene.frame: '/world', but it must be a tf frame, which does not begin with '/'");
}

TEST(Scene, RefusesAnOrganWithTwoGeometries) {
  EXPECT_EQ(refusal(withOrgan(with(organ("liver"), "link", "abdomen"))),
            "scene.organs[0].mesh: either mesh or link is wanted, not both");
  const Map linked = with(without(organ("liver"), "mesh"), "link", "abdomen");
  EXPECT_EQ(refusal(withOrgan(linked)), "accepted");
  EXPECT_EQ(refusal(withOrgan(with(linked, "scale", 2))),
            "scene.organs[0].scale: a link has its scale in robot_description");
}

TEST(Scene, RefusesANameThatIsTaken) {
  EXPECT_EQ(refusal(with(scene(), "organs", List{organ("liver"), organ("liver")})),
            "scene.organs[1].name: 'liver' is the name of another organ or instrument");
  EXPECT_EQ(refusal(with(scene(), "instruments", List{instrument("stomach")})),
            "scene.instruments[0].name: 'stomach' is the name of another organ or instrument");
}

TEST(Scene, RefusesPairsThatMeanNothing) {
  EXPECT_EQ(refusal(withPairs({Value(pair("left", "spleen"))})),
            "scene.pairs[0][1]: 'spleen' is no organ or instrument; known: left, liver, right, "
            "stomach");
  EXPECT_EQ(refusal(withPairs({pair("left", "liver"), pair("left", "left")})),
            "scene.pairs[1]: it names 'left' twice");
  EXPECT_EQ(refusal(withPairs({pair("left", "liver"), pair("liver", "left")})),
            "scene.pairs[1]: 'liver' and 'left' are listed before");
  EXPECT_EQ(refusal(withPairs({Value(List{"left"})})),
            "scene.pairs[0]: a list of 1, but it must be a list of 2");
  EXPECT_EQ(refusal(withPairs({Value(List{"left", "liver", "stomach"})})),
            "scene.pairs[0]: a list of 3, but it must be a list of 2");
  EXPECT_EQ(refusal(withPairs({"left"})), "scene.pairs[0]: 'left', but it must be a list of 2");
}

TEST(Scene, RefusesShapesThatThereAreNot) {
  EXPECT_EQ(refusal(withOrgan(with(organ("liver"), "shape", "sphere"))),
            "scene.organs[0].shape: an organ is a mesh: its vertices and triangles are what "
            "answers name");
  for (const std::string shape : {"sphree", "link"}) {
    EXPECT_EQ(refusal(withInstrument(with(instrument("left"), "shape", shape))),
              "scene.instruments[0].shape: '" + shape +
                  "', but it must be one of point, triangle, sphere, capsule, mesh");
  }
}

TEST(Scene, TakesEveryShape) {
  const List ends = {List{0.1, 0, 0.3}, List{0.0, 0.0, -0.2}};
  const Map sphere = with(with(instrument("a"), "shape", "sphere"), "radius", 0.003);
  const Map capsule =
      with(with(with(instrument("b"), "shape", "capsule"), "radius", 0.004), "ends", ends);
  Map jaw = with(with(instrument("c"), "shape", "mesh"), "mesh", "jaw.stl");
  jaw = with(with(jaw, "scale", 0.001), "convex", true);
  const Map arm = with(instrument("d"), "link", "forearm");
  const Scene parsed = parseScene(with(scene(), "instruments", List{sphere, capsule, jaw, arm}));
  const auto shape = [&](std::size_t i) {
    return std::get<core::Shape>(parsed.instruments[i].geometry);
  };
  EXPECT_EQ(std::get<core::Sphere>(shape(0)).radius, 0.003);
  EXPECT_EQ(std::get<core::Sphere>(shape(0)).centre, Eigen::Vector3d::Zero());
  EXPECT_EQ(std::get<core::Capsule>(shape(1)).radius, 0.004);
  EXPECT_EQ(std::get<core::Capsule>(shape(1)).start, Eigen::Vector3d(0.1, 0, 0.3));
  EXPECT_EQ(std::get<core::Capsule>(shape(1)).end, Eigen::Vector3d(0, 0, -0.2));
  EXPECT_EQ(std::get<MeshFile>(parsed.instruments[2].geometry).url, "jaw.stl");
  EXPECT_EQ(std::get<MeshFile>(parsed.instruments[2].geometry).scale, 0.001);
  EXPECT_TRUE(parsed.instruments[2].convex);
  EXPECT_EQ(std::get<RobotLink>(parsed.instruments[3].geometry).name, "forearm");
  EXPECT_FALSE(parsed.instruments[3].convex);
}

TEST(Scene, RefusesAShapeWithoutSize) {
  const auto refused = [](Map shape) {
    shape["name"] = shape["frame"] = "left";
    return refusal(withInstrument(shape));
  };
  const std::string path = "scene.instruments[0].";
  const List ends = {List{0, 0, 0}, List{0, 0, 1}};
  EXPECT_EQ(refused({{"shape", "sphere"}}), path + "radius: is missing");
  EXPECT_EQ(refused({{"shape", "capsule"}, {"ends", ends}}), path + "radius: is missing");
  EXPECT_EQ(refused({{"shape", "capsule"}, {"radius", 1}}), path + "ends: is missing");
  EXPECT_EQ(refused({{"shape", "capsule"}, {"radius", 1}, {"ends", List{ends[0]}}}),
            path + "ends: a list of 1, but it must be a list of 2");
  EXPECT_EQ(refused({{"shape", "mesh"}}), path + "mesh: is missing");
  for (const double coordinate : {kNan, kInfinity, -1e150}) {
    EXPECT_THAT(
        refused(
            {{"shape", "capsule"}, {"radius", 1}, {"ends", List{ends[0], List{0, coordinate, 1}}}}),
        HasSubstr(path + "ends[1][1]: "));
  }
  for (const double radius : {0.0, -0.003, kNan, kInfinity, 1e150}) {
    EXPECT_THAT(refused({{"shape", "sphere"}, {"radius", radius}}), HasSubstr(path + "radius: "));
    EXPECT_THAT(refused({{"shape", "capsule"}, {"radius", radius}, {"ends", ends}}),
                HasSubstr(", but it must be a number above 0 and below 1e+150"));
  }
}

TEST(Scene, RefusesAKeyThatBelongsToAnotherShape) {
  EXPECT_EQ(refusal(withInstrument(with(instrument("left"), "radius", 0.003))),
            "scene.instruments[0].radius: without a shape it is a point, which has none; a sphere "
            "has");
  EXPECT_EQ(refusal(withInstrument(with(with(instrument("left"), "shape", "sphere"), "mesh", "a"))),
            "scene.instruments[0].mesh: a sphere has none; a mesh has");
  EXPECT_EQ(refusal(withInstrument(with(with(instrument("left"), "shape", "point"), "link", "a"))),
            "scene.instruments[0].shape: either shape or link is wanted, not both");
  EXPECT_EQ(refusal(withInstrument(with(with(instrument("left"), "link", "a"), "scale", 1))),
            "scene.instruments[0].scale: a link has none; a mesh has");
  EXPECT_EQ(refusal(withInstrument(with(with(instrument("left"), "link", "a"), "convex", 1))),
            "scene.instruments[0].convex: 1, but it must be true or false, without quotes");
}

TEST(Scene, TakesPairsOfInstrumentsAndOfOrgansInTheirOrder) {
  const Scene parsed = parseScene(
      withPairs({pair("right", "left"), pair("left", "liver"), pair("liver", "stomach")}));
  ASSERT_EQ(parsed.like_pairs.size(), 2U);
  EXPECT_EQ(parsed.like_pairs[0].of, LikePair::Of::kInstruments);
  EXPECT_EQ(parsed.like_pairs[0].first, 1U);
  EXPECT_EQ(parsed.like_pairs[0].second, 0U);
  EXPECT_EQ(parsed.like_pairs[1].of, LikePair::Of::kOrgans);
  EXPECT_EQ(parsed.like_pairs[1].second, 1U);
  EXPECT_THAT(indices(parsed), ElementsAre(std::pair(0, 0)));
  EXPECT_TRUE(parseScene(scene()).like_pairs.empty());
  EXPECT_EQ(refusal(withPairs({pair("left", "right"), pair("right", "left")})),
            "scene.pairs[1]: 'right' and 'left' are listed before");
}

TEST(Scene, RefusesATriangleWithoutItsCornersAndCornersWithoutATriangle) {
  const Map triangle = with(instrument("left"), "shape", "triangle");
  EXPECT_EQ(refusal(withInstrument(triangle)), "scene.instruments[0].corners: is missing");
  EXPECT_EQ(refusal(withInstrument(with(instrument("left"), "corners", kCorners))),
            "scene.instruments[0].corners: without a shape it is a point, which has none; a "
            "triangle has");
  EXPECT_EQ(refusal(withInstrument(with(triangle, "corners", List{kCorners[0], kCorners[1]}))),
            "scene.instruments[0].corners: a list of 2, but it must be a list of 3");
  EXPECT_EQ(
      refusal(withInstrument(
          with(triangle, "corners", List{kCorners[0], kCorners[1], List{0, kNan, 0}}))),
      "scene.instruments[0].corners[2][1]: nan, but it must be a finite number of a magnitude "
      "below 1e+150");
}

}  // namespace
}  // namespace organ_collision::io
