#include "node/wear.h"

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <utility>

#include "node/stopwatch.h"

namespace organ_collision::node {
namespace {

using core::CollisionMesh;
using core::NearestTriangle;
using core::Triangle;

// To measure the wear, five queries are made for each of the sample: some percent of those counted.
constexpr std::uint64_t kEnough = 1024;
constexpr std::uint64_t kSampleEvery = 61;  // prime: of pairs that take turns, none is left out

struct Answers {
  double work = 0.0;
  double wrong = 0.0;
  double duration = 0.0;        // [s]
  double exact_duration = 0.0;  // [s]
};

bool isWorseThanAskedFor(const NearestTriangle& found, const NearestTriangle& exact,
                         const core::Accuracy& accuracy) {
  const double distance = std::abs(found.distance);
  const double nearest = std::abs(exact.distance);
  return distance > nearest * (1.0 + accuracy.max_relative_error) &&
         distance > nearest + accuracy.max_absolute_error;
}

/// The clock is looked at once for all: a look takes as long as some queries.
Answers ask(const CollisionMesh& organ, const std::vector<Question>& questions) {
  std::vector<NearestTriangle> found(questions.size()), exact(questions.size());
  Answers answers;
  const CostStopwatch watch;
  for (std::size_t i = 0; i < questions.size(); ++i)
    found[i] = core::nearestTriangle(organ, questions[i].tip, questions[i].accuracy);
  answers.duration = watch.elapsed();
  const CostStopwatch exact_watch;
  for (std::size_t i = 0; i < questions.size(); ++i)
    exact[i] = core::nearestTriangle(organ, questions[i].tip);
  answers.exact_duration = exact_watch.elapsed();
  for (std::size_t i = 0; i < questions.size(); ++i) {
    answers.work += found[i].work.bounds + found[i].work.triangles;
    if (isWorseThanAskedFor(found[i], exact[i], questions[i].accuracy)) ++answers.wrong;
  }
  return answers;
}

/// A frame that moves with the triangle, its axes in columns; nothing if it has no area.
std::optional<Eigen::Isometry3d> frameOf(const Triangle& triangle, const Eigen::Vector3d& origin) {
  const Eigen::Vector3d along = (triangle.b - triangle.a).stableNormalized();
  const Eigen::Vector3d normal =
      along.cross((triangle.c - triangle.a).stableNormalized()).stableNormalized();
  if (normal.isZero(0.0)) return std::nullopt;
  Eigen::Isometry3d frame;
  frame.linear() << along, normal.cross(along), normal;
  frame.translation() = origin;
  return frame;
}

Eigen::Vector3d pointOn(const Triangle& triangle, const Eigen::Vector3d& barycentric) {
  return barycentric[0] * triangle.a + barycentric[1] * triangle.b + barycentric[2] * triangle.c;
}

/// Where `tip` was, as seen from the triangle that is nearest to it now; nothing where that tells
/// no place.
std::optional<Eigen::Vector3d> carriedBack(const Eigen::Vector3d& tip, const CollisionMesh& now,
                                           const CollisionMesh& as_built) {
  const NearestTriangle nearest = core::nearestTriangle(now, tip);
  const Eigen::Vector3d& barycentric = nearest.closest.barycentric;
  const auto frame_in = [&](const CollisionMesh& organ) {
    const Triangle triangle = organ.mesh().triangle(nearest.triangle);
    return frameOf(triangle, pointOn(triangle, barycentric));
  };
  const auto frame_now = frame_in(now);
  const auto frame_then = frame_in(as_built);
  if (!frame_now || !frame_then) return std::nullopt;
  const Eigen::Vector3d tip_then = *frame_then * (frame_now->inverse() * tip);
  return core::isUsable(tip_then) ? std::optional(tip_then) : std::nullopt;
}

}  // namespace

bool RecentQuestions::add(const Question& question) {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (++asked_.count % kSampleEvery == 0 && asked_.sample.size() < kEnough / kSampleEvery)
    asked_.sample.push_back(question);
  return asked_.count % kEnough == 0;
}

std::optional<RecentQuestions::Asked> RecentQuestions::take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (asked_.count < kEnough) return std::nullopt;
  return std::exchange(asked_, {});
}

std::optional<Wear> measureWear(const std::vector<Question>& questions, const CollisionMesh& now,
                                const CollisionMesh& as_built) {
  std::vector<Question> asked_now, asked_then;
  for (const Question& question : questions) {
    const auto tip_then = carriedBack(question.tip, now, as_built);
    if (!tip_then) continue;
    asked_now.push_back(question);
    asked_then.push_back({*tip_then, question.accuracy});
  }
  if (asked_now.empty()) return std::nullopt;
  const Answers answers = ask(now, asked_now);
  const Answers former = ask(as_built, asked_then);
  const auto count = static_cast<double>(asked_now.size());
  return Wear{answers.work / former.work, (answers.wrong - former.wrong) / count,
              answers.duration / count, answers.exact_duration / count};
}

}  // namespace organ_collision::node
