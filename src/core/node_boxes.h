#pragma once

#include "core/bounds.h"
#include "core/lane_triangles.h"
#include "core/ways.h"

// Boxes of wide nodes, for whichever vector unit includes it.
//
// Rounding: with r the node's radius and u the unit roundoff, moving a point to the node's origin
// and turning it, be it in two steps, is off by less than 32*u*r; axes turn back by their
// transpose but for 2^-20*r; corners of triangles are off by 24*u*r more. All boxes are widened by
// more than all of that.
namespace organ_collision::core {
namespace {

constexpr float kBoxRounding = 0x1p-17F;

struct LaneBox {
  LaneVector<float> low, high;

  void add(const LaneBox& other) {
    low = {smaller(low.x, other.low.x), smaller(low.y, other.low.y), smaller(low.z, other.low.z)};
    high = {larger(high.x, other.high.x), larger(high.y, other.high.y),
            larger(high.z, other.high.z)};
  }
};

inline LaneBox emptyLaneBox() {
  const LaneVector<float> infinite = everywhere(
      Vector<float>{__builtin_huge_valf(), __builtin_huge_valf(), __builtin_huge_valf()});
  return {infinite, LaneVector<float>{} - infinite};
}

/// Rows of a rotation.
struct Turn {
  Vector<float> x, y, z;

  [[gnu::always_inline]] LaneVector<float> operator()(const LaneVector<float>& v) const {
    return {dot(everywhere(x), v), dot(everywhere(y), v), dot(everywhere(z), v)};
  }
  Turn magnitudes() const { return {magnitudesOf(x), magnitudesOf(y), magnitudesOf(z)}; }
};

inline Turn turnOf(const WideNode& node) {
  return {vectorOf<float>(node.axes[0]), vectorOf<float>(node.axes[1]),
          vectorOf<float>(node.axes[2])};
}

/// Of all of the triangles.
[[gnu::always_inline]] inline LaneBox boxOf(const LaneTriangles<float>& triangles,
                                            const Turn& turn) {
  const LaneVector<float> a = turn(triangles.a);
  const LaneVector<float> b = turn(triangles.a + triangles.ab);
  const LaneVector<float> c = turn(triangles.a + triangles.ac);
  return {{smaller(smaller(a.x, b.x), c.x), smaller(smaller(a.y, b.y), c.y),
           smaller(smaller(a.z, b.z), c.z)},
          {larger(larger(a.x, b.x), c.x), larger(larger(a.y, b.y), c.y),
           larger(larger(a.z, b.z), c.z)}};
}

/// The sets' boxes, lane by lane.
struct SetBoxes {
  Lanes<float> low[3][kLaneCount], high[3][kLaneCount];

  void set(std::uint32_t lane, const LaneBox& box) {
    low[0][lane] = box.low.x;
    low[1][lane] = box.low.y;
    low[2][lane] = box.low.z;
    high[0][lane] = box.high.x;
    high[1][lane] = box.high.y;
    high[2][lane] = box.high.z;
  }
  void add(std::uint32_t lane, const LaneBox& box) {
    low[0][lane] = smaller(low[0][lane], box.low.x);
    low[1][lane] = smaller(low[1][lane], box.low.y);
    low[2][lane] = smaller(low[2][lane], box.low.z);
    high[0][lane] = larger(high[0][lane], box.high.x);
    high[1][lane] = larger(high[1][lane], box.high.y);
    high[2][lane] = larger(high[2][lane], box.high.z);
  }
  void repeat(std::uint32_t source, std::uint32_t lane) {
    for (int axis = 0; axis < 3; ++axis) {
      low[axis][lane] = low[axis][source];
      high[axis][lane] = high[axis][source];
    }
  }
};

/// Of the ball around a node's origin that holds its lanes' boxes.
inline float radiusAround(const LaneVector<float>& low, const LaneVector<float>& high) {
  const LaneVector<float> farthest = {larger(Lanes<float>{} - low.x, high.x),
                                      larger(Lanes<float>{} - low.y, high.y),
                                      larger(Lanes<float>{} - low.z, high.z)};
  return rootOf(mostOf(dot(farthest, farthest))) * kRadiusRounding + kPlaceRounding;
}

/// Takes over the boxes of some lanes of a node; after the last lane of all, they repeat that.
/// Returns the radius around these.
inline float storeBoxes(WideNode& node, std::uint32_t begin, std::uint32_t end, SetBoxes& boxes) {
  for (std::uint32_t lane = 0; lane < begin; ++lane) boxes.repeat(begin, lane);
  for (std::uint32_t lane = end; lane < kLaneCount; ++lane) boxes.repeat(end - 1, lane);
  const LaneVector<float> low = {leastOfEach(boxes.low[0]), leastOfEach(boxes.low[1]),
                                 leastOfEach(boxes.low[2])};
  const LaneVector<float> high = {mostOfEach(boxes.high[0]), mostOfEach(boxes.high[1]),
                                  mostOfEach(boxes.high[2])};
  const float radius = radiusAround(low, high);
  const float rounding = kBoxRounding * radius + 2 * kPlaceRounding;
  const LaneVector<float> margin = everywhere(Vector<float>{rounding, rounding, rounding});
  const std::uint32_t last = end == node.lane_count ? kLaneCount : end;
  const Truth<float> is_meant = lanesOf(((1U << last) - 1) & ~((1U << begin) - 1));
  store(select(is_meant, low - margin, load<float>(node.low)), node.low);
  store(select(is_meant, high + margin, load<float>(node.high)), node.high);
  return radius;
}

}  // namespace
}  // namespace organ_collision::core
