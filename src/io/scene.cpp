#include "organ_collision/io/scene.h"

#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "field.h"
#include "organ_collision/io/message_text.h"

namespace organ_collision::io {
namespace {

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
    shape->refuse("an organ is a mesh: its vertices and triangles are what answers name");
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
  return {coordinates[0].coordinate(), coordinates[1].coordinate(), coordinates[2].coordinate()};
}

core::Triangle parseCorners(const Field& field) {
  const std::vector<Field> corners = field.items(3);
  return {parsePoint(corners[0]), parsePoint(corners[1]), parsePoint(corners[2])};
}

using Geometry = decltype(Instrument::geometry);

Geometry parsePointShape(const Field& /*instrument*/) {
  return core::Shape(Eigen::Vector3d(0.0, 0.0, 0.0));
}

Geometry parseTriangle(const Field& instrument) {
  return core::Shape(parseCorners(instrument.at("corners")));
}

Geometry parseSphere(const Field& instrument) {
  return core::Shape(core::Sphere{{0.0, 0.0, 0.0}, instrument.at("radius").length()});
}

Geometry parseCapsule(const Field& instrument) {
  const std::vector<Field> ends = instrument.at("ends").items(2);
  return core::Shape(
      core::Capsule{parsePoint(ends[0]), parsePoint(ends[1]), instrument.at("radius").length()});
}

Geometry parseMesh(const Field& instrument) { return parseMeshFile(instrument); }

Geometry parseLink(const Field& instrument) { return RobotLink{instrument.at("link").text()}; }

/// A kind of geometry, and the keys that it has and others may not.
struct Kind {
  const char* name;
  std::vector<std::string_view> keys;
  Geometry (*parse)(const Field& instrument);
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> kKinds = {{"point", {}, parsePointShape},
                                           {"triangle", {"corners"}, parseTriangle},
                                           {"sphere", {"radius"}, parseSphere},
                                           {"capsule", {"ends", "radius"}, parseCapsule},
                                           {"mesh", {"mesh", "scale", "convex"}, parseMesh},
                                           {"link", {"link", "convex"}, parseLink}};
  return kKinds;
}

bool has(const Kind& kind, std::string_view key) {
  return std::find(kind.keys.begin(), kind.keys.end(), key) != kind.keys.end();
}

const Kind& kindOf(const Field& instrument) {
  const auto shape = instrument.find("shape");
  const auto link = instrument.find("link");
  if (shape && link) shape->refuse("either shape or link is wanted, not both");
  const std::string name = link ? "link" : shape ? shape->text() : "point";
  std::vector<std::string_view> known;
  for (const Kind& kind : kinds()) {
    if (kind.name == name && (link || name != "link")) return kind;
    if (std::string_view(kind.name) != "link") known.emplace_back(kind.name);
  }
  shape->refuse("'" + name + "', but it must be one of " + joined(known));
}

void refuseKeysOfOthers(const Field& instrument, const Kind& kind) {
  for (const Kind& other : kinds()) {
    for (const std::string_view key : other.keys) {
      const auto field = instrument.find(std::string(key));
      if (field && !has(kind, key)) {
        const std::string is_none =
            instrument.find("shape") || instrument.find("link")
                ? std::string("a ") + kind.name + " has none"
                : "without a shape it is a " + std::string(kind.name) + ", which has none";
        field->refuse(is_none + "; a " + other.name + " has");
      }
    }
  }
}

Instrument parseInstrument(const Field& field) {
  field.allowOnly(
      {"name", "frame", "shape", "corners", "ends", "radius", "mesh", "scale", "link", "convex"});
  const Kind& kind = kindOf(field);
  refuseKeysOfOthers(field, kind);
  Instrument instrument{field.at("name").text(), field.at("frame").frame(), kind.parse(field)};
  readIfGiven(field, "convex", instrument.convex, &Field::yesOrNo);
  return instrument;
}

/// Names are shared by instruments and organs, because pairs name both.
class NameTable {
 public:
  struct Entry {
    bool is_organ;
    std::size_t index;
    bool operator==(const Entry& other) const {
      return is_organ == other.is_organ && index == other.index;
    }
  };

  void add(const Field& item, const std::string& name, Entry entry) {
    if (entries_.emplace(name, entry).second) return;
    item.at("name").refuse("'" + name + "' is the name of another organ or instrument");
  }
  Entry find(const Field& field) const {
    const std::string name = field.text();
    const auto found = entries_.find(name);
    if (found == entries_.end()) {
      std::vector<std::string_view> known;
      for (const auto& entry : entries_) known.emplace_back(entry.first);
      field.refuse("'" + name + "' is no organ or instrument; known: " + joined(known));
    }
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

/// The two that a pair names, once and in any order.
using NamedPair = std::pair<NameTable::Entry, NameTable::Entry>;

NamedPair parsePair(const Field& field, const NameTable& names) {
  const std::vector<Field> both = field.items(2);
  const NamedPair pair = {names.find(both[0]), names.find(both[1])};
  if (pair.first == pair.second) field.refuse("it names '" + both[0].text() + "' twice");
  return pair;
}

void addPair(const NamedPair& pair, Scene& scene) {
  const auto& [first, second] = pair;
  if (first.is_organ == second.is_organ) {
    const auto of = first.is_organ ? LikePair::Of::kOrgans : LikePair::Of::kInstruments;
    scene.like_pairs.push_back({of, first.index, second.index});
  } else {
    const auto& [instrument, organ] = first.is_organ ? NamedPair{second, first} : pair;
    scene.pairs.push_back({instrument.index, organ.index});
  }
}

void parsePairs(const Field& field, const NameTable& names, Scene& scene) {
  std::vector<NamedPair> known;
  for (const Field& item : field.items()) {
    const NamedPair pair = parsePair(item, names);
    const auto is_same = [&](const NamedPair& other) {
      return other == pair || other == NamedPair{pair.second, pair.first};
    };
    if (std::any_of(known.begin(), known.end(), is_same)) {
      const std::vector<Field> both = item.items(2);
      item.refuse("'" + both[0].text() + "' and '" + both[1].text() + "' are listed before");
    }
    known.push_back(pair);
    addPair(pair, scene);
  }
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
  const auto up_to = [](double most) {
    return [most](const Field& number) { return number.upTo(most); };
  };
  readIfGiven(field, "max_relative_error", accuracy.max_relative_error,
              up_to(kLargestRelativeError));
  readIfGiven(field, "max_absolute_error", accuracy.max_absolute_error,
              up_to(kLargestAbsoluteError));
  readIfGiven(field, "max_leaves", accuracy.max_leaves, &Field::count);
  return accuracy;
}

}  // namespace

Scene parseScene(const Value& value) {
  const Field field(value, "scene");
  field.allowOnly({kSceneKeys.begin(), kSceneKeys.end()});
  NameTable names;
  Scene scene;
  scene.organs = parseOrgans(field.at("organs"), names);
  readIfGiven(field, "instruments", scene.instruments,
              [&](const Field& given) { return parseInstruments(given, names); });
  if (const auto pairs = field.find("pairs")) {
    parsePairs(*pairs, names, scene);
  } else {
    scene.pairs = allPairs(scene);
  }
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
