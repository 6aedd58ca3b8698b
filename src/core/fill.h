#pragma once

#include "core/kernels.h"
#include "core/lane_vector.h"

// Packets of triangles, for whichever vector unit includes it.
namespace organ_collision::core {
namespace {

// Those of predicates.cpp, which has the reasons.
constexpr double kDeterminantRounding = (3 + 16 * 0x1p-53) * 0x1p-53;
constexpr double kNoUnderflow = 0x1p-400;

/// Single precision can hold it; off by at most 2^-24. REQUIRES: magnitude below 2^27.
inline double inSinglePrecision(double x) {
  constexpr double kLastBit = 0x1.8p29;  // numbers as large are multiples of 2^-23
  return (x + kLastBit) - kLastBit;
}

inline LaneVector<double> cornerOf(const PacketCorners& corners, std::uint32_t corner) {
  const auto& axes = corners.position[corner];
  return {Lanes<double>::copy(axes[0]), Lanes<double>::copy(axes[1]), Lanes<double>::copy(axes[2])};
}

inline void storeRounded(const LaneVector<double>& v, LanePoints& points) {
  v.x.storeRounded(points[0]);
  v.y.storeRounded(points[1]);
  v.z.storeRounded(points[2]);
}

/// Lanes where x*y - z*w may be 0: the filter of orientation() in predicates.cpp.
inline Truth<double> mayCancel(const Lanes<double>& x, const Lanes<double>& y,
                               const Lanes<double>& z, const Lanes<double>& w) {
  const Lanes<double> left = x * y;
  const Lanes<double> right = z * w;
  const Lanes<double> sum = magnitude(left) + magnitude(right);
  const Lanes<double> error =
      larger(Lanes<double>::all(kDeterminantRounding) * sum, Lanes<double>::all(kNoUnderflow));
  return magnitude(left - right) <= error;
}

inline std::uint32_t lanesThatMayHaveNoArea(const LaneVector<double>& p,
                                            const LaneVector<double>& q) {
  return (mayCancel(p.x, q.y, p.y, q.x) & mayCancel(p.y, q.z, p.z, q.y) &
          mayCancel(p.z, q.x, p.x, q.z))
      .bits();
}

inline PacketTally fill(const PacketCorners& corners, const PlainUnitFrame& frame,
                        TrianglePacket& packet) {
  const LaneVector<double> center =
      everywhere(Vector<double>{frame.center[0], frame.center[1], frame.center[2]});
  const Lanes<double> scale = Lanes<double>::all(frame.scale);
  const LaneVector<double> a_in_metres = cornerOf(corners, 0);
  const LaneVector<double> b_in_metres = cornerOf(corners, 1);
  const LaneVector<double> c_in_metres = cornerOf(corners, 2);
  const LaneVector<double> a = scale * (a_in_metres - center);
  const LaneVector<double> b = scale * (b_in_metres - center);
  const LaneVector<double> c = scale * (c_in_metres - center);

  const Vector<double> first = {inSinglePrecision(a.x[0]), inSinglePrecision(a.y[0]),
                                inSinglePrecision(a.z[0])};
  packet.origin = {static_cast<float>(first.x), static_cast<float>(first.y),
                   static_cast<float>(first.z)};
  const LaneVector<double> origin = everywhere(first);
  storeRounded(a - origin, packet.corner);
  storeRounded(b - a, packet.edge1);
  storeRounded(c - a, packet.edge2);

  const auto squared_reach = [&origin](const LaneVector<double>& point) {
    return dot(point - origin, point - origin);
  };
  const Lanes<double> reach = larger(larger(squared_reach(a), squared_reach(b)), squared_reach(c));
  packet.radius = static_cast<float>(rootOf(-leastOf(Lanes<double>{} - reach)) * (1.0 + 0x1p-20));

  const Lanes<double> volumes = dot(a, cross(b - a, c - a));
  PacketTally tally = {
      0.0, lanesThatMayHaveNoArea(b_in_metres - a_in_metres, c_in_metres - a_in_metres)};
  for (std::uint32_t lane = 0; lane < packet.lane_count; ++lane) tally.volume += volumes[lane];
  return tally;
}

}  // namespace
}  // namespace organ_collision::core
