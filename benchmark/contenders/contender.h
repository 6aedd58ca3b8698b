#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "organ_collision/core/closest_point.h"
#include "organ_collision/core/triangle_mesh.h"
#include "tools/output.h"

// Whoever answers how far points are from an organ: this library at its settings, and its peers.
// Tips, organs and distances are in one frame and in one unit, the diagonal of the organ's box.
namespace organ_collision::bench {

/// What is asked for.
enum class Task : std::uint8_t {
  kPoints,  ///< tips that have nothing to do with each other, one after another
  kPath,    ///< the tips of a moving instrument, in order: the previous answer is known
  kBatch    ///< all tips at once: all cores may work
};

/// What an answer to all tips cost; the same on every machine.
struct Work {
  std::uint64_t bounds = 0, triangles = 0;
};

/// One who answers for an organ as it is.
class Contender {
 public:
  virtual ~Contender() = default;
  /// Replaces `distances` by the unsigned distance of each tip. Timed, unlike measure().
  virtual void answer(const core::Points& tips, std::vector<double>& distances) = 0;
  /// The same of the last answer, by one who answers with triangles alone and leaves `distances`
  /// be.
  virtual void measure(const core::Points& /*tips*/, std::vector<double>& /*distances*/) {}
  /// Of the last answer; nothing from one who does not count.
  virtual std::optional<Work> work() const { return std::nullopt; }
};

/// One who answers for an organ that moves.
class Follower {
 public:
  virtual ~Follower() = default;
  /// Takes down where the vertices go, in the form that follow() wants. Not timed.
  virtual void prepare(const core::Points& /*positions*/) {}
  /// Takes the organ there.
  virtual void follow() {}
  /// Who answers for the organ as it is now.
  virtual Contender& contender() = 0;
  /// [bytes] of the hierarchy without the mesh; nothing from one who does not tell.
  virtual std::optional<std::size_t> hierarchyMemory() const { return std::nullopt; }
};

/// How far an answer may be from the truth: rounding of distances of some diagonals in double
/// (u = 1.1e-16) or in float (u = 6e-8), with room for who rounds often on the way.
constexpr double kDoubleTolerance = 1e-12;
constexpr double kFloatTolerance = 2e-6;

/// The larger of two errors; NaN is the largest.
inline double worse(double first, double second) {
  return std::isnan(first) || second <= first ? first : second;
}

/// Throws std::runtime_error naming `who` if an error is larger than allowed: who is wrong is not
/// timed.
inline void requireRight(const std::string& who, double error, std::optional<double> tolerance) {
  if (!tolerance || error <= *tolerance) return;
  throw std::runtime_error(who + ": an answer is wrong by " + tools::significant(error) +
                           " of the diagonal");
}

/// A contender in a comparison of queries.
struct Entrant {
  std::string name;
  std::vector<Task> tasks;
  /// Of its answers; nothing: it promises none, its error is only told.
  std::optional<double> tolerance;
  std::size_t most_tips;  ///< that it is asked: who is slow is not asked all
  std::shared_ptr<Contender> contender;
  double rounding = kDoubleTolerance;  ///< of its answers, though they be none of the nearest
};

/// What a follower can follow.
enum class Follows : std::uint8_t { kNothing, kAllVertices, kSomeVertices };

/// A follower in a comparison of updates.
struct Method {
  std::string name;
  std::optional<double> tolerance;  ///< as an entrant's
  Follows follows;
  std::size_t most_triangles;  ///< of the organs that it is tried on
  /// Builds all that it needs. The vertices of `moved` will move; empty: all.
  std::function<std::unique_ptr<Follower>(const core::TriangleMesh& mesh,
                                          const std::vector<core::VertexId>& moved)>
      build;
};

/// Measures one triangle for each tip.
inline void measureEach(const core::TriangleMesh& mesh,
                        const std::vector<core::TriangleId>& triangles, const core::Points& tips,
                        std::vector<double>& distances) {
  distances.clear();
  for (std::size_t i = 0; i < tips.size(); ++i) {
    distances.push_back(std::sqrt(
        core::closestPointOnTriangle(tips[i], mesh.triangle(triangles.at(i))).squared_distance));
  }
}

/// No limit to the tips or triangles of an entrant or a method.
constexpr std::size_t kAll = std::numeric_limits<std::size_t>::max();

/// Those who enter for `mesh`, which must outlive them; nobody where the organ is too large for
/// them.
std::vector<Entrant> libraryEntrants(const core::TriangleMesh& mesh);
std::vector<Entrant> embreeEntrants(const core::TriangleMesh& mesh);
std::vector<Entrant> cgalEntrants(const core::TriangleMesh& mesh);
std::vector<Entrant> fclEntrants(const core::TriangleMesh& mesh);
std::vector<Entrant> nanoflannEntrants(const core::TriangleMesh& mesh);
std::vector<Entrant> paperEntrants(const core::TriangleMesh& mesh);

std::vector<Method> libraryMethods();
std::vector<Method> embreeMethods();
std::vector<Method> cgalMethods();
std::vector<Method> fclMethods();
std::vector<Method> bulletMethods();

/// [bytes] that Embree has taken, small blocks from malloc, large ones from the system.
std::size_t embreeMemory();

}  // namespace organ_collision::bench
