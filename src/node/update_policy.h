#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

// What mode AUTO decides, from recorded figures alone: no clock, no mesh, no constant cost.
namespace organ_collision::node {

/// Chooses between a partial refit and a full one by what both have cost on this organ so far.
/// Partial ones are kept apart by the power of two that their vertices come to: the fewer there
/// are, the more ancestors each has for itself. A size not yet tried is tried; one that lost is
/// tried again after a while, in case that its figure was disturbed or the moves have changed.
class RefitPolicy {
 public:
  /// `full` [s]: what a full refit cost.
  explicit RefitPolicy(double full) : full_(full) {}

  bool prefersPartial(std::size_t moved) const;
  /// What prefersPartial() goes by, for people.
  std::string figures(std::size_t moved) const;

  void recordPartial(std::size_t moved, double duration);  ///< [s]
  /// `moved`: the vertices of the moves for which it was chosen; nothing if all moved anyway.
  void recordFull(std::optional<std::size_t> moved, double duration);  ///< [s]

 private:
  struct Partial {
    static constexpr unsigned kPatience = 64;  // full ones
    bool isDueAgain() const { return passed_over >= kPatience; }

    std::optional<double> per_vertex;  // [s] the last time
    unsigned passed_over = 0;          // times that full was chosen since
  };

  static constexpr std::size_t kSizes = 32;
  static std::size_t sizeOf(std::size_t moved);

  double full_;  // [s] the least: it is always the same work
  std::array<Partial, kSizes> partial_;
};

/// How much worse than as it was built a hierarchy answers, on a sample of the latest questions.
struct Wear {
  double work_ratio = 1.0;   ///< bounds and triangles measured, now against as built
  double newly_wrong = 0.0;  ///< share of answers beyond the accuracy asked for, now less as built
  double query_duration = 0.0;  ///< [s] of a question now
  double exact_duration = 0.0;  ///< [s] of the same, asked for the exact answer
};

/// Decides when to rebuild: as soon as queries have lost as much time to the wear as a rebuild
/// costs. Whatever comes after, that is about twice, at most, what the best choice in hindsight
/// would have cost (the ski rental problem: A. Karlin et al., "Competitive snoopy caching", 1988).
/// An answer that has become wrong, which greedy search and small budgets let happen, counts as the
/// exact search that would mend it.
class RebuildPolicy {
 public:
  /// `cost` [s] of building the hierarchy.
  explicit RebuildPolicy(double cost) : cost_(cost) {}

  /// So many queries were asked of a hierarchy as worn as this.
  void recordQueries(std::uint64_t queries, const Wear& wear);
  /// The hierarchy is new; that took so long [s].
  void recordRebuild(double cost);

  bool isDue() const { return lost_ > cost_; }
  double lost() const { return lost_; }  ///< [s] by queries since the last build
  double cost() const { return cost_; }  ///< [s] of a rebuild
  /// What isDue() goes by, for people.
  std::string figures() const;

 private:
  double cost_;
  double lost_ = 0.0;
  Wear last_;
};

}  // namespace organ_collision::node
