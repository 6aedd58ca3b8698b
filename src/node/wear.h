#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "node/update_policy.h"
#include "organ_collision/core/nearest_triangle.h"

namespace organ_collision::node {

/// What an organ was asked lately.
struct Question {
  Eigen::Vector3d tip;  ///< [m] in the organ's frame
  core::Accuracy accuracy;
};

/// Counts questions and keeps a sample of them.
class RecentQuestions {
 public:
  struct Asked {
    std::uint64_t count = 0;  ///< since the last time
    std::vector<Question> sample;
  };

  /// True if there are now enough for take().
  bool add(const Question& question);

  /// Begins anew; nothing if too few came to be worth the time that measureWear() takes.
  std::optional<Asked> take();

 private:
  std::mutex mutex_;
  Asked asked_;
};

/// Asks the questions again: of the organ as it is, and of the organ as it was when its hierarchy
/// was built, with each tip where the surface near it was then. So a tip that goes where answers
/// cost more is not taken for wear. Nothing if no tip can be carried back (all the triangles near
/// them have lost their area). REQUIRES: both have the same topology.
std::optional<Wear> measureWear(const std::vector<Question>& questions,
                                const core::CollisionMesh& now,
                                const core::CollisionMesh& as_built);

}  // namespace organ_collision::node
