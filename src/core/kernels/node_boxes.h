#pragma once

#include "core/kernels/bounds.h"
#include "core/kernels/lane_triangles.h"
#include "core/kernels/separation.h"

// Boxes of wide nodes, for whichever vector unit includes it.
//
// Rounding: with r the node's radius and u the unit roundoff, moving a point to the node's origin
// and turning it, be it in two steps, is off by less than 32*u*r; axes turn back by their
// transpose but for 2^-20*r; corners of triangles are off by 24*u*r more. All boxes are widened by
// more than all of that.
namespace organ_collision::core {
namespace {

constexpr float kBoxRounding = 0x1p-17F;
/// Of the sum of a box' three sizes, as no corner is farther than 4 from its node's origin.
constexpr float kSizeRounding = 0x1p-14F;

/// How far something reaches from a node's origin: in lanes 0 to 2 along the node's axes, in 4 to 6
/// against them, in the others 0.
using Reach = Lanes<float>;

/// Rows of a rotation.
struct Turn {
  Vector<float> x, y, z;

  [[gnu::always_inline]] LaneVector<float> operator()(const LaneVector<float>& v) const {
    return {dot(everywhere(x), v), dot(everywhere(y), v), dot(everywhere(z), v)};
  }
  Turn magnitudes() const { return {magnitudesOf(x), magnitudesOf(y), magnitudesOf(z)}; }
};

inline Turn turnOf(const std::array<std::array<float, 3>, 3>& rows) {
  return {vectorOf<float>(rows[0]), vectorOf<float>(rows[1]), vectorOf<float>(rows[2])};
}

/// Of nothing: to be joined with others.
inline Reach nowhere() { return Reach::all(-kFloatInfinity); }

/// Of what lies in eight boxes.
inline Reach reachOfBoxes(const LaneVector<float>& low, const LaneVector<float>& high) {
  const LaneVector<float> against = LaneVector<float>{} - low;
  const Lanes<float> none{};
  return mostOfEach<float>({high.x, high.y, high.z, none, against.x, against.y, against.z, none});
}

/// Of triangles' corners.
[[gnu::always_inline]] inline Reach reachOfCorners(const LaneTriangles<float>& triangles,
                                                   const Turn& turn) {
  const LaneVector<float> a = turn(triangles.a);
  const LaneVector<float> b = turn(triangles.a + triangles.ab);
  const LaneVector<float> c = turn(triangles.a + triangles.ac);
  return reachOfBoxes(smaller(smaller(a, b), c), larger(larger(a, b), c));
}

/// The sets' reaches.
class SetReaches {
 public:
  void set(std::uint32_t lane, const Reach& reach) { reach.store(reaches_[lane].data()); }
  void add(std::uint32_t lane, const Reach& reach) {
    set(lane, larger(Reach::load(reaches_[lane].data()), reach));
  }

  /// Along the axes, of sets from one on, up to another: other lanes repeat the nearest of these.
  LaneVector<float> along(std::uint32_t begin, std::uint32_t end) const {
    return gather(reaches_[0].data(), offsetsOf(begin, end));
  }
  LaneVector<float> against(std::uint32_t begin, std::uint32_t end) const {
    return gather(reaches_[0].data() + kLaneCount / 2, offsetsOf(begin, end));
  }

 private:
  /// Without a branch, which would depend on how many there are.
  static std::array<std::uint16_t, kLaneCount> offsetsOf(std::uint32_t begin, std::uint32_t end) {
    std::array<std::uint16_t, kLaneCount> offsets;
    for (std::uint32_t lane = 0; lane < kLaneCount; ++lane) {
      const std::uint32_t least = lane < begin ? begin : lane;
      const std::uint32_t set = least < end ? least : end - 1;
      offsets[lane] = static_cast<std::uint16_t>(set * sizeof(LaneFloats));
    }
    return offsets;
  }

  alignas(sizeof(LaneFloats)) std::array<LaneFloats, kLaneCount> reaches_;
};

/// Of a ball around any point of what reaches so far: the sum of its sizes along the axes.
inline float radiusOf(const Reach& reach) { return sumOf(reach) + kSizeRounding; }

/// Of the ball around a node's origin that holds what reaches so far.
inline float radiusAround(const LaneVector<float>& along, const LaneVector<float>& against) {
  const LaneVector<float> farthest = larger(along, against);
  return rootOf(mostOf(dot(farthest, farthest))) * kRadiusRounding + kPlaceRounding;
}

/// Takes over the boxes of some lanes of a node; after the last lane of all, they repeat that.
/// Returns the radius around these.
inline float storeBoxes(WideNode& node, std::uint32_t begin, std::uint32_t end,
                        const SetReaches& reaches) {
  const LaneVector<float> along = reaches.along(begin, end);
  const LaneVector<float> against = reaches.against(begin, end);
  const float radius = radiusAround(along, against);
  const float rounding = kBoxRounding * radius + 2 * kPlaceRounding;
  const LaneVector<float> margin = everywhere(Vector<float>{rounding, rounding, rounding});
  const std::uint32_t last = end == node.lane_count ? kLaneCount : end;
  const Truth<float> is_meant = lanesOf(((1U << last) - 1) & ~((1U << begin) - 1));
  const LaneVector<float> none{};
  store(select(is_meant, none - against - margin, load<float>(node.low)), node.low);
  store(select(is_meant, along + margin, load<float>(node.high)), node.high);
  return radius;
}

}  // namespace
}  // namespace organ_collision::core
