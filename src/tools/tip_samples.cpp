#include "tip_samples.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <random>
#include <sstream>
#include <stdexcept>

#include "organ_collision/core/nearest_triangle.h"
#include "organ_collision/core/sign.h"

namespace organ_collision::tools {
namespace {

constexpr std::size_t kTriesPerTip = 20;

std::vector<double> areas(const core::TriangleMesh& mesh) {
  std::vector<double> result;
  double sum = 0.0;
  for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
    const core::Triangle triangle = mesh.triangle(static_cast<core::TriangleId>(i));
    result.push_back(0.5 * (triangle.b - triangle.a).cross(triangle.c - triangle.a).norm());
    sum += result.back();
  }
  if (!(sum > 0.0) || !std::isfinite(sum)) {
    std::ostringstream message;
    message << "the mesh has no area to put tips beside that can be told: its triangles' sum to "
            << sum << " m^2";
    throw std::runtime_error(message.str());
  }
  return result;
}

/// A point of a triangle, every one as likely.
Eigen::Vector3d pointOn(const core::Triangle& triangle, double first, double second) {
  const double root = std::sqrt(first);
  return (1.0 - root) * triangle.a + root * (1.0 - second) * triangle.b +
         root * second * triangle.c;
}

std::vector<std::string> fields(const std::string& line) {
  std::vector<std::string> result;
  std::istringstream stream(line + ',');
  for (std::string field; std::getline(stream, field, ',');) result.push_back(field);
  return result;
}

/// Nothing if `field` is no number.
std::optional<double> number(const std::string& field) {
  char* end = nullptr;
  const double value = std::strtod(field.c_str(), &end);
  const bool is_number =
      end != field.c_str() &&
      field.find_first_not_of(" \t", static_cast<std::size_t>(end - field.c_str())) ==
          std::string::npos;
  return is_number ? std::optional(value) : std::nullopt;
}

constexpr const char* kByteOrderMark = "\xEF\xBB\xBF";  // as spreadsheets write it

bool isHeading(const std::string& line) {
  const std::vector<std::string> names = fields(line);
  return names.size() == 3 && std::none_of(names.begin(), names.end(), number);
}

/// Throws std::invalid_argument saying what is wrong with `line`.
Eigen::Vector3d tipOf(const std::string& line, std::size_t line_number) {
  const std::vector<std::string> coordinates = fields(line);
  if (coordinates.size() != 3) {
    throw std::invalid_argument("'" + line + "' has " + std::to_string(coordinates.size()) +
                                (coordinates.size() == 1 ? " field" : " fields") +
                                ", but x,y,z are wanted");
  }
  Eigen::Vector3d tip;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::optional<double> coordinate = number(coordinates[i]);
    if (!coordinate) throw std::invalid_argument("'" + coordinates[i] + "' is no number");
    tip[static_cast<Eigen::Index>(i)] = *coordinate;
  }
  core::requireUsable(tip, "tip in line", line_number);
  return tip;
}

}  // namespace

std::vector<Band> bands() {
  return {{"0-1 mm", 0.0, 0.001, false},
          {"1-5 mm", 0.001, 0.005, false},
          {"5-50 mm", 0.005, 0.05, false},
          {"far (50-200 mm)", 0.05, 0.2, false},
          {"inside", 0.0, 0.05, true}};
}

core::Points sampleTips(const core::CollisionMesh& organ, const Band& band, std::size_t count,
                        std::uint64_t seed) {
  if (band.inside && !organ.health().isSolid()) return {};
  const std::vector<double> weights = areas(organ.mesh());
  std::discrete_distribution<std::uint32_t> triangle(weights.begin(), weights.end());
  std::uniform_real_distribution<double> share(0.0, 1.0);
  std::uniform_real_distribution<double> length(band.low, band.high);
  std::mt19937_64 generator(seed);

  core::Points tips;
  for (std::size_t i = 0; i < kTriesPerTip * count && tips.size() < count; ++i) {
    const auto id = static_cast<core::TriangleId>(triangle(generator));
    const double first = share(generator);
    const double second = share(generator);
    const double side = share(generator) < 0.5 ? -1.0 : 1.0;
    const Eigen::Vector3d tip =
        pointOn(organ.mesh().triangle(id), first, second) +
        side * length(generator) * core::pseudonormal(organ, id, core::Feature::kFace);
    if (band.contains(core::nearestTriangle(organ, tip).distance)) tips.push_back(tip);
  }
  return tips;
}

core::Points readTips(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream || std::filesystem::is_directory(file)) {
    throw std::runtime_error(file.string() + ": cannot read this file");
  }
  core::Points tips;
  std::size_t line_number = 0;
  for (std::string line; std::getline(stream, line);) {
    ++line_number;
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line_number == 1 && line.rfind(kByteOrderMark, 0) == 0) line.erase(0, 3);
    if (line.empty() || (line_number == 1 && isHeading(line))) continue;
    try {
      tips.push_back(tipOf(line, line_number));
    } catch (const std::invalid_argument& error) {
      throw std::runtime_error(file.string() + ":" + std::to_string(line_number) + ": " +
                               error.what());
    }
  }
  if (stream.bad()) {
    throw std::runtime_error(file.string() + ": reading failed after " +
                             std::to_string(line_number) + " lines");
  }
  if (tips.empty()) throw std::runtime_error(file.string() + ": no tips, but x,y,z [m] are wanted");
  return tips;
}

}  // namespace organ_collision::tools
