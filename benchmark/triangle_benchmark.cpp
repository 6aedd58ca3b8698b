// What do the measurements between points and triangles cost that searches end with? Each case asks
// the same 1,024 inputs in turn, more than branch prediction learns by heart.
#include <benchmark/benchmark.h>

#include <array>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "organ_collision/core/predicates.h"
#include "organ_collision/core/triangle_distance.h"
#include "organ_collision/core/triangle_intersection.h"
#include "test_meshes.h"

namespace organ_collision {
namespace {

using core::Feature;
using core::Triangle;
using Eigen::Vector3d;

constexpr std::size_t kInputs = 1024;

using Random = std::mt19937;

Triangle randomTriangle(Random& random) {
  return {test::randomPoint(random, 1.0), test::randomPoint(random, 1.0),
          test::randomPoint(random, 1.0)};
}

/// Drawn until there are enough of those that `belongs` accepts.
template <class Input>
std::vector<Input> inputs(const std::function<Input(Random&)>& draw,
                          const std::function<bool(const Input&)>& belongs) {
  Random random(1);
  std::vector<Input> drawn;
  while (drawn.size() < kInputs) {
    Input input = draw(random);
    if (belongs(input)) drawn.push_back(std::move(input));
  }
  return drawn;
}

/// Times `ask`, of one input after the other.
template <class Input, class Ask>
void time(const std::string& name, std::vector<Input> asked, const Ask& ask) {
  benchmark::RegisterBenchmark(name.c_str(), [asked = std::move(asked), ask](auto& state) {
    std::size_t i = 0;
    for (auto _ : state) {
      benchmark::DoNotOptimize(ask(asked[i]));
      i = (i + 1) % kInputs;
    }
  });
}

void timeClosestPoints() {
  using Input = std::pair<Vector3d, Triangle>;
  const auto ask = [](const Input& input) {
    return closestPointOnTriangle(input.first, input.second);
  };
  const auto draw = [](Random& random) {
    return Input(test::randomPoint(random, 1.0), randomTriangle(random));
  };
  const auto of = [&](Feature first, Feature last) {
    return inputs<Input>(draw, [&](const Input& input) {
      const Feature feature = ask(input).feature;
      return first <= feature && feature <= last;
    });
  };
  time("closestPointOnTriangle/corner", of(Feature::kVertexA, Feature::kVertexC), ask);
  time("closestPointOnTriangle/edge", of(Feature::kEdgeAB, Feature::kEdgeCA), ask);
  time("closestPointOnTriangle/face", of(Feature::kFace, Feature::kFace), ask);
}

void timePairsOfTriangles() {
  using Input = std::pair<Triangle, Triangle>;
  const auto draw = [](Random& random) {
    return Input(randomTriangle(random), randomTriangle(random));
  };
  const auto meet = [](const Input& input) {
    return trianglesIntersect(input.first, input.second);
  };
  const auto distance = [](const Input& input) { return closestPoints(input.first, input.second); };
  for (const bool meeting : {false, true}) {
    const std::string name = meeting ? "meeting" : "apart";
    const std::vector<Input> pairs =
        inputs<Input>(draw, [&](const Input& input) { return meet(input) == meeting; });
    time("closestPoints/" + name, pairs, distance);
    time("trianglesIntersect/" + name, pairs, meet);
  }
}

void timeOrientations() {
  using Input = std::array<Vector3d, 4>;
  const auto ask = [](const Input& p) { return core::orientation(p[0], p[1], p[2], p[3]); };
  const auto any = [](const Input& /*points*/) { return true; };
  const auto draw = [](Random& random) {
    const Triangle t = randomTriangle(random);
    return Input{t.a, t.b, t.c, test::randomPoint(random, 1.0)};
  };
  const auto draw_in_plane = [](Random& random) {
    const Triangle t = randomTriangle(random);
    return Input{t.a, t.b, t.c, core::centroid(t)};
  };
  time("orientation/apart", inputs<Input>(draw, any), ask);
  time("orientation/as near as rounding", inputs<Input>(draw_in_plane, any), ask);
}

}  // namespace
}  // namespace organ_collision

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  organ_collision::timeClosestPoints();
  organ_collision::timePairsOfTriangles();
  organ_collision::timeOrientations();
  benchmark::RunSpecifiedBenchmarks();
}
