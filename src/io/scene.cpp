#include "organ_collision/io/scene.h"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "field.h"

namespace organ_collision::io {
namespace {

constexpr const char* kNotSupported = " is not supported by this version";

/// Leaves `target` as it is, the default, if the map has no such key.
template <typename Target, typename Parse>
void readIfGiven(const Field& map, const char* key, Target& target, const Parse& parse) {
  if (const auto given = map.find(key)) target = std::invoke(parse, *given);
}

MeshFile parseMeshFile(const Field& organ) {
  MeshFile file{organ.at("mesh").text()};
  readIfGiven(organ, "scale", file.scale, &Field::aboveZero);
  return file;
}

Organ parseOrgan(const Field& field) {
  if (const auto shape = field.find("shape")) {
    shape->refuse(std::string("an organ's shape") + kNotSupported);
  }
  field.allowOnly({"name", "frame", "mesh", "link", "scale"});
  Organ organ{field.at("name").text(), field.at("frame").frame(), {}};
  const auto link = field.find("link");
  if (!link) {
    organ.geometry = parseMeshFile(field);
    return organ;
  }
  if (const auto mesh = field.find("mesh")) mesh->refuse("either mesh or link is wanted, not both");
  if (const auto scale = field.find("scale")) {
    scale->refuse("a link has its scale in robot_description");
  }
  organ.geometry = RobotLink{link->text()};
  return organ;
}

Eigen::Vector3d parsePoint(const Field& field) {
  const std::vector<Field> coordinates = field.items(3);
  return {coordinates[0].finite(), coordinates[1].finite(), coordinates[2].finite()};
}

core::Triangle parseCorners(const Field& field) {
  const std::vector<Field> corners = field.items(3);
  return {parsePoint(corners[0]), parsePoint(corners[1]), parsePoint(corners[2])};
}

core::Shape parseShape(const Field& instrument) {
  const auto corners = instrument.find("corners");
  const auto shape = instrument.find("shape");
  const std::string name = shape ? shape->text() : "point";
  if (name == "triangle") return parseCorners(instrument.at("corners"));
  for (const char* const later : {"sphere", "capsule", "mesh"}) {
    if (name == later) shape->refuse(name + kNotSupported + "; supported: point, triangle");
  }
  if (name != "point") shape->refuse("'" + name + "', but it must be point or triangle");
  if (corners) corners->refuse("only a shape: triangle has corners");
  return Eigen::Vector3d(0.0, 0.0, 0.0);
}

Instrument parseInstrument(const Field& field) {
  field.allowOnly({"name", "frame", "shape", "corners"});
  return {field.at("name").text(), field.at("frame").frame(), parseShape(field)};
}

/// Names are shared by instruments and organs, because pairs name both.
class NameTable {
 public:
  struct Entry {
    bool is_organ;
    std::size_t index;
  };

  void add(const Field& item, const std::string& name, Entry entry) {
    if (entries_.emplace(name, entry).second) return;
    item.at("name").refuse("'" + name + "' is the name of another organ or instrument");
  }
  Entry find(const Field& field) const {
    const std::string name = field.text();
    const auto found = entries_.find(name);
    if (found == entries_.end()) field.refuse("'" + name + "' is no organ or instrument");
    return found->second;
  }

 private:
  std::map<std::string, Entry> entries_;
};

std::vector<Organ> parseOrgans(const Field& field, NameTable& names) {
  std::vector<Organ> organs;
  for (const Field& item : field.items()) {
    organs.push_back(parseOrgan(item));
    names.add(item, organs.back().name, {true, organs.size() - 1});
  }
  if (organs.empty()) field.refuse("one organ or more is wanted");
  return organs;
}

std::vector<Instrument> parseInstruments(const Field& field, NameTable& names) {
  std::vector<Instrument> instruments;
  for (const Field& item : field.items()) {
    instruments.push_back(parseInstrument(item));
    names.add(item, instruments.back().name, {false, instruments.size() - 1});
  }
  return instruments;
}

Pair parsePair(const Field& field, const NameTable& names) {
  const std::vector<Field> both = field.items(2);
  const NameTable::Entry first = names.find(both[0]);
  const NameTable::Entry second = names.find(both[1]);
  if (first.is_organ != second.is_organ) {
    return first.is_organ ? Pair{second.index, first.index} : Pair{first.index, second.index};
  }
  if (first.index == second.index) field.refuse("it names '" + both[0].text() + "' twice");
  field.refuse(std::string(first.is_organ ? "a pair of organs" : "a pair of instruments") +
               kNotSupported);
}

std::vector<Pair> parsePairs(const Field& field, const NameTable& names) {
  std::vector<Pair> pairs;
  for (const Field& item : field.items()) {
    const Pair pair = parsePair(item, names);
    const auto is_same = [&](const Pair& other) {
      return other.instrument == pair.instrument && other.organ == pair.organ;
    };
    if (std::any_of(pairs.begin(), pairs.end(), is_same)) item.refuse("the pair is listed before");
    pairs.push_back(pair);
  }
  return pairs;
}

std::vector<Pair> allPairs(const Scene& scene) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < scene.instruments.size(); ++i) {
    for (std::size_t k = 0; k < scene.organs.size(); ++k) pairs.push_back({i, k});
  }
  return pairs;
}

core::Accuracy parseAccuracy(const Field& field) {
  field.allowOnly({"max_relative_error", "max_absolute_error", "max_leaves"});
  core::Accuracy accuracy;
  readIfGiven(field, "max_relative_error", accuracy.max_relative_error, &Field::notNegative);
  readIfGiven(field, "max_absolute_error", accuracy.max_absolute_error, &Field::notNegative);
  readIfGiven(field, "max_leaves", accuracy.max_leaves, &Field::count);
  return accuracy;
}

}  // namespace

Scene parseScene(const Value& value) {
  const Field field(value, "scene");
  field.allowOnly({"frame", "organs", "instruments", "pairs", "max_distance", "accuracy", "rate",
                   "stale_after", "mesh_root"});
  NameTable names;
  Scene scene;
  scene.organs = parseOrgans(field.at("organs"), names);
  readIfGiven(field, "instruments", scene.instruments,
              [&](const Field& given) { return parseInstruments(given, names); });
  scene.pairs = allPairs(scene);
  readIfGiven(field, "pairs", scene.pairs,
              [&](const Field& given) { return parsePairs(given, names); });
  scene.frame = scene.organs.front().frame;
  readIfGiven(field, "frame", scene.frame, &Field::frame);
  readIfGiven(field, "max_distance", scene.max_distance, &Field::aboveZero);
  readIfGiven(field, "accuracy", scene.accuracy, parseAccuracy);
  readIfGiven(field, "rate", scene.rate, &Field::aboveZero);
  readIfGiven(field, "stale_after", scene.stale_after, &Field::aboveZero);
  readIfGiven(field, "mesh_root", scene.mesh_root, &Field::text);
  return scene;
}

}  // namespace organ_collision::io
