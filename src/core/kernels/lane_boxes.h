#pragma once

#include "core/kernels/bounds.h"
#include "core/kernels/pair_search.h"

// The boxes of a node, seen from another node, be it of another surface.
namespace organ_collision::core {
namespace {

template <class Real>
struct LaneBoxes {
  LaneVector<Real> low, high;

  Lanes<Real> squaredDistanceTo(const LaneBoxes& others, std::uint32_t lane) const {
    return squaredDistanceOf(low, high, laneOf(others.low, lane), laneOf(others.high, lane));
  }
};
template <class Real>
inline LaneBoxes<Real> boxesOf(const WideNode& node) {
  return {load<Real>(node.low), load<Real>(node.high)};
}

/// From one node's axes and origin to another's.
template <class Real>
struct Placement {
  std::array<Vector<Real>, 3> rows;
  Vector<Real> offset;

  Placement(const WideNode& from, const AffineMap& map, const WideNode& to) {
    const Vector<double> axes[3] = {vectorOf<double>(from.axes[0]), vectorOf<double>(from.axes[1]),
                                    vectorOf<double>(from.axes[2])};
    const Vector<double> origin = vectorOf<double>(from.origin);
    // Axes are a trifle shorter than 1.
    const double inverse = 1.0 / dot(axes[0], axes[0]);
    Vector<double> columns[3];  // of the map, along the axes of `from`
    double moved[3];
    for (int row = 0; row < 3; ++row) {
      const Vector<double> linear = {map.linear[row][0], map.linear[row][1], map.linear[row][2]};
      columns[row] = inverse * Vector<double>{dot(linear, axes[0]), dot(linear, axes[1]),
                                              dot(linear, axes[2])};
      moved[row] = dot(linear, origin) + map.offset[row];
    }
    const Vector<double> between =
        Vector<double>{moved[0], moved[1], moved[2]} - vectorOf<double>(to.origin);
    for (int row = 0; row < 3; ++row) {
      const Vector<double> axis = vectorOf<double>(to.axes[row]);
      const Vector<double> turned = axis.x * columns[0] + axis.y * columns[1] + axis.z * columns[2];
      rows[row] = {static_cast<Real>(turned.x), static_cast<Real>(turned.y),
                   static_cast<Real>(turned.z)};
    }
    offset = {static_cast<Real>(dot(vectorOf<double>(to.axes[0]), between)),
              static_cast<Real>(dot(vectorOf<double>(to.axes[1]), between)),
              static_cast<Real>(dot(vectorOf<double>(to.axes[2]), between))};
  }

  LaneVector<Real> turned(const LaneVector<Real>& v) const {
    return {dot(everywhere(rows[0]), v), dot(everywhere(rows[1]), v), dot(everywhere(rows[2]), v)};
  }
  LaneVector<Real> operator()(const LaneVector<Real>& v) const {
    return everywhere(offset) + turned(v);
  }
  /// Boxes around the moved boxes.
  LaneBoxes<Real> operator()(const LaneBoxes<Real>& boxes) const {
    const Lanes<Real> half = Lanes<Real>::all(Real{0.5});
    const LaneVector<Real> middle = (*this)(half * (boxes.low + boxes.high));
    const LaneVector<Real> size = half * (boxes.high - boxes.low);
    const auto reach = [&size](const Vector<Real>& row) {
      return dot(everywhere(magnitudesOf(row)), size);
    };
    const LaneVector<Real> reaches = {reach(rows[0]), reach(rows[1]), reach(rows[2])};
    return {middle - reaches, middle + reaches};
  }
};

}  // namespace
}  // namespace organ_collision::core
