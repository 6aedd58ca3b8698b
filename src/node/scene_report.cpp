#include "node/scene_report.h"

#include <array>
#include <cstdio>
#include <string_view>

#include "organ_collision/io/message_text.h"

namespace organ_collision::node {
namespace {

using Of = io::LikePair::Of;

using Names = std::vector<std::string_view>;

/// Adds the other of a pair of two like ones.
void addOther(const io::LikePair& pair, std::size_t one, const std::string& first,
              const std::string& second, Names& names) {
  if (pair.first == one) names.emplace_back(second);
  if (pair.second == one) names.emplace_back(first);
}

std::string partnersOfInstrument(const io::Scene& scene, std::size_t instrument) {
  Names names;
  for (const io::Pair& pair : scene.pairs)
    if (pair.instrument == instrument) names.emplace_back(scene.organs[pair.organ].name);
  for (const io::LikePair& pair : scene.like_pairs) {
    if (pair.of == Of::kInstruments) {
      addOther(pair, instrument, scene.instruments[pair.first].name,
               scene.instruments[pair.second].name, names);
    }
  }
  return io::joined(names);
}

std::string cost(std::size_t bytes, double seconds) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.3f MB, built in %.4f s",
                1e-6 * static_cast<double>(bytes), seconds);
  return text.data();
}

std::string kindOf(const core::Shape& shape) {
  if (std::holds_alternative<Eigen::Vector3d>(shape)) return "point";
  if (std::holds_alternative<core::Triangle>(shape)) return "triangle";
  if (std::holds_alternative<core::Sphere>(shape)) return "sphere";
  if (std::holds_alternative<core::Capsule>(shape)) return "capsule";
  const auto& mesh = std::get<core::RigidMesh>(shape);
  return std::string(mesh.convex ? "convex mesh of " : "mesh of ") +
         std::to_string(mesh.surface->mesh().triangleCount()) + " triangles";
}

std::string reportOn(const Organ& organ, const std::string& partners) {
  const std::shared_ptr<const OrganSnapshot> snapshot = organ.snapshot();
  return organ.name() + ": hierarchy of " + std::to_string(snapshot->organ.mesh().triangleCount()) +
         " triangles for " + partners + ": " +
         cost(snapshot->organ.memory(), snapshot->last_duration);
}

std::string reportOn(const Instrument& instrument, const std::string& partners) {
  if (partners.empty()) return instrument.name + ": in no pair: nothing built";
  std::vector<std::string> kinds;
  std::size_t bytes = instrument.shapes.size() * sizeof(core::Shape);
  for (const core::Shape& shape : instrument.shapes) {
    kinds.push_back(kindOf(shape));
    if (const auto* mesh = std::get_if<core::RigidMesh>(&shape)) bytes += mesh->surface->memory();
  }
  return instrument.name + ": " + io::joined({kinds.begin(), kinds.end()}) + " for " + partners +
         ": " + cost(bytes, instrument.build_time);
}

}  // namespace

std::string partnersOfOrgan(const io::Scene& scene, std::size_t organ) {
  Names names;
  for (const io::Pair& pair : scene.pairs)
    if (pair.organ == organ) names.emplace_back(scene.instruments[pair.instrument].name);
  for (const io::LikePair& pair : scene.like_pairs) {
    if (pair.of == Of::kOrgans) {
      addOther(pair, organ, scene.organs[pair.first].name, scene.organs[pair.second].name, names);
    }
  }
  return names.empty() ? "no pair, but the services" : io::joined(names);
}

std::vector<std::string> report(const io::Scene& scene, const Instruments& instruments,
                                const Organs& organs) {
  std::vector<std::string> sentences;
  for (std::size_t i = 0; i < organs.size(); ++i)
    sentences.push_back(reportOn(*organs[i], partnersOfOrgan(scene, i)));
  for (std::size_t i = 0; i < instruments.size(); ++i)
    sentences.push_back(reportOn(instruments[i], partnersOfInstrument(scene, i)));
  return sentences;
}

}  // namespace organ_collision::node
