#pragma once

#include "core/kernels/kernels.h"
#include "core/kernels/lane_vector.h"

// Which of many points are far away, for whichever vector unit includes it.
namespace organ_collision::core {
namespace {

inline LaneVector<double> eightOf(const PointColumns& points, std::size_t first) {
  return {Lanes<double>::copy(points.x + first), Lanes<double>::copy(points.y + first),
          Lanes<double>::copy(points.z + first)};
}

inline LaneVector<double> everywhere(const std::array<double, 3>& point) {
  return everywhere(Vector<double>{point[0], point[1], point[2]});
}

/// Calls visit(i) for the eights of points that begin at i, from the one given on; the last may
/// overlap the one before.
template <class Visit>
[[gnu::always_inline]] inline void forEights(std::size_t count, const Visit& visit,
                                             std::size_t i = 0) {
  for (; i + kLanes <= count; i += kLanes) visit(i);
  if (i < count) visit(count - kLanes);
}

/// The largest squared distance so far of each lane, and where the first eight were that had it.
struct Farthest {
  Lanes<double> squared_distance = Lanes<double>::all(-1.0);
  Lanes<double> place{};

  void add(const LaneVector<double>& apart, std::size_t first_place) {
    const Lanes<double> candidate = dot(apart, apart);
    const Truth<double> nearer = candidate <= squared_distance;
    squared_distance = select(nearer, squared_distance, candidate);
    place = select(nearer, place, Lanes<double>::all(static_cast<double>(first_place)));
  }

  /// The first of all.
  FarPoint first() const {
    const double most = mostOf(squared_distance);
    FarPoint farthest = {~std::size_t{0}, most};
    for (std::uint32_t bits = (Lanes<double>::all(most) <= squared_distance).bits(); bits != 0;
         bits &= bits - 1) {
      const std::uint32_t lane = lowestBit(bits);
      const std::size_t index = static_cast<std::size_t>(place[lane]) + lane;
      if (index < farthest.index) farthest.index = index;
    }
    return farthest;
  }
};

inline FarPoint farthestFrom(const PointColumns& points, std::size_t count,
                             const std::array<double, 3>& point) {
  const LaneVector<double> from = everywhere(point);
  Farthest farthest;
  forEights(count, [&](std::size_t i) { farthest.add(eightOf(points, i) - from, i); });
  return farthest.first();
}

inline bool reach(const PointColumns& points, std::size_t count, const std::array<double, 3>& point,
                  double least) {
  const LaneVector<double> from = everywhere(point);
  Lanes<double> most = Lanes<double>::all(-1.0);
  forEights(count, [&](std::size_t i) {
    const LaneVector<double> apart = eightOf(points, i) - from;
    most = larger(most, dot(apart, apart));
  });
  return (Lanes<double>::all(least) <= most).bits() != 0;
}

inline FarthestPair farthestOfAllPairs(const PointColumns& points, std::size_t count) {
  Farthest farthest;
  for (std::size_t i = 0; i < count; ++i) {
    const LaneVector<double> from =
        everywhere(Vector<double>{points.x[i], points.y[i], points.z[i]});
    forEights(
        count, [&](std::size_t j) { farthest.add(eightOf(points, j) - from, i * count + j); },
        i - i % kLanes);
  }
  // The first place of a pair has the smaller index first.
  const FarPoint pair = farthest.first();
  return {pair.index / count, pair.index % count, pair.squared_distance};
}

/// Lists those of which far(at) is true; returns how many. `far` gets eight at a time.
template <class Far>
[[gnu::always_inline]] inline std::size_t list(const PointColumns& points, std::size_t count,
                                               const Far& far, std::uint32_t* found) {
  std::size_t end = 0;
  std::size_t next = 0;
  forEights(count, [&](std::size_t i) {
    const std::uint32_t bits = far(eightOf(points, i)).bits() & (~0U << (next - i));
    next = i + kLanes;
    if (bits == 0) return;
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) {  // no branch could be foreseen
      found[end] = static_cast<std::uint32_t>(i) + lane;
      end += bits >> lane & 1U;
    }
  });
  return end;
}

/// The power is the product of the offsets from the two ends: Thales.
inline std::size_t listByPower(const PointColumns& points, std::size_t count,
                               const std::array<double, 3>& first,
                               const std::array<double, 3>& second, double least,
                               std::uint32_t* found) {
  const LaneVector<double> one = everywhere(first);
  const LaneVector<double> other = everywhere(second);
  const Lanes<double> threshold = Lanes<double>::all(least);
  return list(
      points, count,
      [&](const LaneVector<double>& at) { return threshold <= dot(at - one, at - other); }, found);
}

inline std::size_t listFarFrom(const PointColumns& points, std::size_t count,
                               const std::array<double, 3>& low, const std::array<double, 3>& high,
                               double least, std::uint32_t* found) {
  const LaneVector<double> lowest = everywhere(low);
  const LaneVector<double> highest = everywhere(high);
  const Lanes<double> threshold = Lanes<double>::all(least);
  return list(
      points, count,
      [&](const LaneVector<double>& at) {
        const LaneVector<double> below = highest - at;
        const LaneVector<double> above = at - lowest;
        const LaneVector<double> apart = {larger(below.x, above.x), larger(below.y, above.y),
                                          larger(below.z, above.z)};
        return threshold <= dot(apart, apart);
      },
      found);
}

inline std::size_t separate(const PlainTriangles& triangles, std::size_t count, std::size_t spare,
                            const std::array<double, 3>& first,
                            const std::array<double, 3>& second) {
  const LaneVector<double> one = everywhere(first);
  const LaneVector<double> other = everywhere(second);
  const auto away = [&](std::size_t i) {
    const LaneVector<double> at = eightOf({triangles.x, triangles.y, triangles.z}, i);
    return (dot(at - other, at - other) <= dot(at - one, at - one)).bits();
  };
  std::size_t kept = 0;
  std::size_t moved = spare;
  const auto deal = [&](std::size_t i, std::uint32_t is_away) {
    // By arithmetic: of a choice compilers make a branch, which could not be foreseen.
    const std::size_t to = kept ^ ((kept ^ moved) & (std::size_t{0} - is_away));
    for (double* const column : {triangles.x, triangles.y, triangles.z}) column[to] = column[i];
    triangles.ids[to] = triangles.ids[i];
    kept += 1 - is_away;
    moved += is_away;
  };
  const std::size_t rest = count % kLanes;
  const std::uint32_t bits_of_rest = away(count - kLanes) >> (kLanes - rest);
  for (std::size_t i = 0; i < count - rest; i += kLanes) {
    const std::uint32_t bits = away(i);
    for (std::uint32_t lane = 0; lane < kLanes; ++lane) deal(i + lane, bits >> lane & 1U);
  }
  for (std::uint32_t lane = 0; lane < rest; ++lane)
    deal(count - rest + lane, bits_of_rest >> lane & 1U);
  return kept;
}

}  // namespace
}  // namespace organ_collision::core
