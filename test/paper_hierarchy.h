#pragma once

#include <algorithm>
#include <memory>
#include <tuple>
#include <vector>

#include "organ_collision/core/closest_point.h"
#include "organ_collision/core/triangle_mesh.h"

namespace organ_collision::test {

/// The paper's pseudo-code, word for word, with the tie rules that make it definite; for tests.
/// Sets are what the paper calls U, poles C_k and C_l; O(n^2). Source: Muñoz, Diaz León, Trefftz,
/// Quid 19 (2012), algorithms 1 and 2.
class PaperHierarchy {
 public:
  using Vector = Eigen::Vector3d;

  struct Set {
    std::vector<core::TriangleId> triangles;
    Vector first_pole, second_pole;      // C_k, C_l
    std::unique_ptr<Set> first, second;  // U_k, U_l; none: a single triangle
  };

  explicit PaperHierarchy(const core::TriangleMesh& mesh) : mesh_(mesh) {
    std::vector<core::TriangleId> all;
    for (std::size_t i = 0; i < mesh.triangleCount(); ++i) {
      all.push_back(static_cast<core::TriangleId>(i));
      centroids_.push_back(core::centroid(mesh.triangle(all.back())));
    }
    root_ = split(all);
  }

  const Set& root() const { return *root_; }

  /// Goes to the child whose pole is nearer until one triangle is left.
  core::TriangleId search(const Vector& tip) const {
    const Set* set = root_.get();
    while (set->first) {
      const bool first_is_nearer =
          core::squaredLength(tip - set->first_pole) < core::squaredLength(tip - set->second_pole);
      set = first_is_nearer ? set->first.get() : set->second.get();
    }
    return set->triangles.front();
  }

 private:
  static std::tuple<double, double, double> tuple(const Vector& v) { return {v.x(), v.y(), v.z()}; }

  const Vector& centroid(core::TriangleId id) const { return centroids_[core::index(id)]; }

  std::vector<std::tuple<double, double, double>> corners(core::TriangleId id) const {
    const core::Triangle t = mesh_.triangle(id);
    return {tuple(t.a), tuple(t.b), tuple(t.c)};
  }

  std::vector<std::tuple<double, double, double>> sortedCorners(core::TriangleId id) const {
    std::vector<std::tuple<double, double, double>> sorted = corners(id);
    std::sort(sorted.begin(), sorted.end());
    return sorted;
  }

  std::unique_ptr<Set> split(const std::vector<core::TriangleId>& members) const {
    auto set = std::make_unique<Set>();
    set->triangles = members;
    if (members.size() == 1) return set;
    double longest = 0.0;
    for (const core::TriangleId i : members) {
      for (const core::TriangleId j : members) {
        const Vector& p = centroid(i);
        const Vector& q = centroid(j);
        if (!(tuple(p) < tuple(q))) continue;
        const double length = core::squaredLength(q - p);
        const bool wins_tie = std::make_pair(tuple(p), tuple(q)) <
                              std::make_pair(tuple(set->first_pole), tuple(set->second_pole));
        if (length > longest || (length == longest && longest > 0.0 && wins_tie)) {
          longest = length;
          set->first_pole = p;
          set->second_pole = q;
        }
      }
    }
    std::vector<core::TriangleId> first;
    std::vector<core::TriangleId> second;
    if (longest == 0.0) {
      set->first_pole = set->second_pole = centroid(members.front());
      std::vector<core::TriangleId> ordered = members;
      std::sort(ordered.begin(), ordered.end(), [this](core::TriangleId i, core::TriangleId j) {
        return std::make_tuple(sortedCorners(i), corners(i), i) <
               std::make_tuple(sortedCorners(j), corners(j), j);
      });
      const auto half = ordered.begin() + static_cast<std::ptrdiff_t>(ordered.size() / 2);
      first.assign(ordered.begin(), half);
      second.assign(half, ordered.end());
    } else {
      for (const core::TriangleId id : members) {
        const bool nearer_to_first = core::squaredLength(centroid(id) - set->first_pole) <
                                     core::squaredLength(centroid(id) - set->second_pole);
        (nearer_to_first ? first : second).push_back(id);
      }
    }
    set->first = split(first);
    set->second = split(second);
    return set;
  }

  const core::TriangleMesh& mesh_;
  std::vector<Vector> centroids_;
  std::unique_ptr<Set> root_;
};

}  // namespace organ_collision::test
