#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

// Eight numbers at a time, in the compiler's own vectors of the width that the translation unit is
// made for. Internal linkage throughout: no unit's code may be taken for another's.
namespace organ_collision::core {
namespace {

#if defined(__AVX512F__)
constexpr int kVectorBytes = 64;
#elif defined(__AVX__)
constexpr int kVectorBytes = 32;
#else
constexpr int kVectorBytes = 16;
#endif

constexpr int kLanes = 8;
template <class Real>
constexpr int kPartBytes =
    kVectorBytes < kLanes* int{sizeof(Real)} ? kVectorBytes : kLanes* int{sizeof(Real)};

/// Vector types of the machine, and the integers that comparisons give.
template <class Real>
struct Part;
template <>
struct Part<float> {
  using Numbers __attribute__((vector_size(kPartBytes<float>))) = float;
  using Truths __attribute__((vector_size(kPartBytes<float>))) = std::int32_t;
};
template <>
struct Part<double> {
  using Numbers __attribute__((vector_size(kPartBytes<double>))) = double;
  using Truths __attribute__((vector_size(kPartBytes<double>))) = std::int64_t;
};

inline float rootOf(float x) { return __builtin_sqrtf(x); }
inline double rootOf(double x) { return __builtin_sqrt(x); }
/// Without a branch, which the sign of a coordinate would often mislead.
inline float magnitudeOf(float x) { return __builtin_fabsf(x); }
inline double magnitudeOf(double x) { return __builtin_fabs(x); }

/// The bits of a comparison, one a lane.
template <class Truths>
inline std::uint32_t bitsOf(const Truths& truths) {
#if defined(__AVX512DQ__)
  if constexpr (sizeof(truths) == 64) {
    using Longs __attribute__((vector_size(64))) = long long;
    return static_cast<std::uint8_t>(__builtin_ia32_cvtq2mask512(reinterpret_cast<Longs>(truths)));
  }
#endif
#if defined(__AVX__)
  if constexpr (sizeof(truths) == 32 && sizeof(truths[0]) == 4) {
    using Floats __attribute__((vector_size(32))) = float;
    return static_cast<std::uint32_t>(__builtin_ia32_movmskps256(reinterpret_cast<Floats>(truths)));
  }
  if constexpr (sizeof(truths) == 32 && sizeof(truths[0]) == 8) {
    using Doubles __attribute__((vector_size(32))) = double;
    return static_cast<std::uint32_t>(
        __builtin_ia32_movmskpd256(reinterpret_cast<Doubles>(truths)));
  }
#elif defined(__SSE2__)
  if constexpr (sizeof(truths) == 16 && sizeof(truths[0]) == 4) {
    using Floats __attribute__((vector_size(16))) = float;
    return static_cast<std::uint32_t>(__builtin_ia32_movmskps(reinterpret_cast<Floats>(truths)));
  }
  if constexpr (sizeof(truths) == 16 && sizeof(truths[0]) == 8) {
    using Doubles __attribute__((vector_size(16))) = double;
    return static_cast<std::uint32_t>(__builtin_ia32_movmskpd(reinterpret_cast<Doubles>(truths)));
  }
#endif
  std::uint32_t bits = 0;
  for (int i = 0; i < int{sizeof(truths) / sizeof(truths[0])}; ++i)
    bits |= static_cast<std::uint32_t>(truths[i] & 1) << i;
  return bits;
}

using LaneInts __attribute__((vector_size(kLanes * sizeof(std::int32_t)))) = std::int32_t;

template <class Real>
struct Truth {
  static constexpr int kParts = kLanes * int{sizeof(Real)} / kPartBytes<Real>;
  typename Part<Real>::Truths part[kParts];

  std::uint32_t bits() const {
    std::uint32_t all = 0;
    for (int i = 0; i < kParts; ++i) all |= bitsOf(part[i]) << (i * (kLanes / kParts));
    return all;
  }
};

template <class Real>
struct Lanes {
  static constexpr int kParts = Truth<Real>::kParts;
  static constexpr int kPartLanes = kLanes / kParts;
  using Numbers = typename Part<Real>::Numbers;
  Numbers part[kParts];

  /// The same number in all lanes.
  static Lanes all(Real x) {
    Lanes result;
    for (Numbers& part : result.part) part = x - Numbers{};
    return result;
  }
  /// 0, 1, ... 7.
  static Lanes numbers() {
    Lanes result;
    for (int lane = 0; lane < kLanes; ++lane)
      result.part[lane / kPartLanes][lane % kPartLanes] = static_cast<Real>(lane);
    return result;
  }
  /// number(0), number(1), ... number(7).
  template <class Number>
  static Lanes each(const Number& number) {
    Lanes result;
    if constexpr (kPartLanes == 8) {
      result.part[0] = Numbers{number(0), number(1), number(2), number(3),
                               number(4), number(5), number(6), number(7)};
    } else {
      for (int i = 0; i < kLanes; ++i) result.part[i / kPartLanes][i % kPartLanes] = number(i);
    }
    return result;
  }
  /// Eight numbers, aligned like a vector.
  static Lanes load(const float* values) {
    Lanes result;
    for (int i = 0; i < kParts; ++i) {
      using Stored __attribute__((vector_size(kPartLanes * sizeof(float)))) = float;
      result.part[i] = __builtin_convertvector(
          *reinterpret_cast<const Stored*>(values + std::ptrdiff_t{i} * kPartLanes), Numbers);
    }
    return result;
  }
  /// As they are in memory. Part by part: gcc copies what is larger than a vector in smaller
  /// pieces, through memory.
  static Lanes copy(const Real* values) {
    Lanes result;
    for (int i = 0; i < kParts; ++i)
      __builtin_memcpy(&result.part[i], values + std::ptrdiff_t{i} * kPartLanes, sizeof(Numbers));
    return result;
  }
  void store(Real* values) const {
    for (int i = 0; i < kParts; ++i)
      __builtin_memcpy(values + std::ptrdiff_t{i} * kPartLanes, &part[i], sizeof(Numbers));
  }
  Real operator[](std::uint32_t lane) const { return part[lane / kPartLanes][lane % kPartLanes]; }
};

template <class Real, class Operation>
inline Lanes<Real> lanewise(const Lanes<Real>& a, const Lanes<Real>& b,
                            const Operation& operation) {
  Lanes<Real> result;
  for (int i = 0; i < Lanes<Real>::kParts; ++i) result.part[i] = operation(a.part[i], b.part[i]);
  return result;
}

template <class Real>
inline Lanes<Real> operator+(const Lanes<Real>& a, const Lanes<Real>& b) {
  return lanewise(a, b, [](const auto& x, const auto& y) { return x + y; });
}
template <class Real>
inline Lanes<Real> operator-(const Lanes<Real>& a, const Lanes<Real>& b) {
  return lanewise(a, b, [](const auto& x, const auto& y) { return x - y; });
}
template <class Real>
inline Lanes<Real> operator*(const Lanes<Real>& a, const Lanes<Real>& b) {
  return lanewise(a, b, [](const auto& x, const auto& y) { return x * y; });
}
template <class Real>
inline Lanes<Real> operator/(const Lanes<Real>& a, const Lanes<Real>& b) {
  return lanewise(a, b, [](const auto& x, const auto& y) { return x / y; });
}
/// The second where the first is not a number. As built in where that is one instruction: where one
/// of them is a constant, gcc takes two.
struct Larger {
  template <class Numbers>
  Numbers operator()(const Numbers& x, const Numbers& y) const {
#if defined(__AVX__)
    if constexpr (std::is_same_v<Numbers, Part<float>::Numbers>)
      return __builtin_ia32_maxps256(x, y);
    else
#endif
      return x > y ? x : y;
  }
};
struct Smaller {
  template <class Numbers>
  Numbers operator()(const Numbers& x, const Numbers& y) const {
#if defined(__AVX__)
    if constexpr (std::is_same_v<Numbers, Part<float>::Numbers>)
      return __builtin_ia32_minps256(x, y);
    else
#endif
      return x < y ? x : y;
  }
};
template <class Real>
inline Lanes<Real> larger(const Lanes<Real>& a, const Lanes<Real>& b) {
  return lanewise(a, b, Larger{});
}
template <class Real>
inline Lanes<Real> smaller(const Lanes<Real>& a, const Lanes<Real>& b) {
  return lanewise(a, b, Smaller{});
}
template <class Real>
inline Lanes<Real> root(const Lanes<Real>& a) {
  Lanes<Real> result;
  for (int i = 0; i < Lanes<Real>::kParts; ++i)
    for (int lane = 0; lane < Lanes<Real>::kPartLanes; ++lane)
      result.part[i][lane] = rootOf(a.part[i][lane]);
  return result;
}
template <class Real>
inline Lanes<Real> magnitudeOf(const Lanes<Real>& a) {
  using Numbers = typename Lanes<Real>::Numbers;
  using Bits = typename Part<Real>::Truths;
  const Bits sign = reinterpret_cast<Bits>(-Numbers{});
  Lanes<Real> result;
  for (int i = 0; i < Lanes<Real>::kParts; ++i)
    result.part[i] = reinterpret_cast<Numbers>(reinterpret_cast<Bits>(a.part[i]) & ~sign);
  return result;
}

template <class Real>
inline Truth<Real> operator<=(const Lanes<Real>& a, const Lanes<Real>& b) {
  Truth<Real> result;
  for (int i = 0; i < Lanes<Real>::kParts; ++i) result.part[i] = a.part[i] <= b.part[i];
  return result;
}
template <class Real>
inline Truth<Real> operator&(const Truth<Real>& a, const Truth<Real>& b) {
  Truth<Real> result;
  for (int i = 0; i < Lanes<Real>::kParts; ++i) result.part[i] = a.part[i] & b.part[i];
  return result;
}
template <class Real>
inline Truth<Real> operator!(const Truth<Real>& a) {
  Truth<Real> result;
  for (int i = 0; i < Lanes<Real>::kParts; ++i) result.part[i] = ~a.part[i];
  return result;
}
/// v[i ^ distance] for each lane i.
template <int distance, class Numbers, int... lane>
inline Numbers exchanged(const Numbers& v, std::integer_sequence<int, lane...>) {
  return __builtin_shufflevector(v, v, (lane ^ distance)...);
}
/// Joins all lanes, always the same ones first: i and i + 4, then i and i + 2, then 0 and 1.
template <class Real, class Operation>
[[gnu::always_inline]] inline Real fold(Lanes<Real> lanes, const Operation& operation) {
  constexpr int kPartLanes = Lanes<Real>::kPartLanes;
  constexpr std::make_integer_sequence<int, kPartLanes> kNumbers;
  for (int parts = Lanes<Real>::kParts / 2; parts > 0; parts /= 2)
    for (int i = 0; i < parts; ++i) lanes.part[i] = operation(lanes.part[i], lanes.part[i + parts]);
  auto joined = lanes.part[0];
  if constexpr (kPartLanes > 4) joined = operation(joined, exchanged<4>(joined, kNumbers));
  if constexpr (kPartLanes > 2) joined = operation(joined, exchanged<2>(joined, kNumbers));
  return operation(joined, exchanged<1>(joined, kNumbers))[0];
}
template <class Real>
[[gnu::always_inline]] inline Real leastOf(const Lanes<Real>& lanes) {
  return fold(lanes, Smaller{});
}
template <class Real>
inline Real mostOf(const Lanes<Real>& lanes) {
  return fold(lanes, Larger{});
}
template <class Real>
inline Real sumOf(const Lanes<Real>& lanes) {
  return fold(lanes, [](const auto& x, const auto& y) { return x + y; });
}
/// In lane i, the largest of rows[i]. What crosses the middle of a vector is dear, and comes last.
template <class Real>
inline Lanes<Real> mostOfEach(const Lanes<Real> (&rows)[kLanes]) {
  static_assert(sizeof(Real) == sizeof(float));
  constexpr Larger kLarger;
  Lanes<Real> result;
  if constexpr (Lanes<Real>::kParts == 1) {
    typename Lanes<Real>::Numbers twos[4], fours[2];  // partial results of two rows, of four
    for (int i = 0; i < 4; ++i) {
      const auto& a = rows[2 * i].part[0];
      const auto& b = rows[2 * i + 1].part[0];
      twos[i] = kLarger(__builtin_shufflevector(a, b, 0, 8, 1, 9, 4, 12, 5, 13),
                        __builtin_shufflevector(a, b, 2, 10, 3, 11, 6, 14, 7, 15));
    }
    for (int i = 0; i < 2; ++i)
      fours[i] = kLarger(
          __builtin_shufflevector(twos[2 * i], twos[2 * i + 1], 0, 1, 8, 9, 4, 5, 12, 13),
          __builtin_shufflevector(twos[2 * i], twos[2 * i + 1], 2, 3, 10, 11, 6, 7, 14, 15));
    result.part[0] =
        kLarger(__builtin_shufflevector(fours[0], fours[1], 0, 1, 2, 3, 8, 9, 10, 11),
                __builtin_shufflevector(fours[0], fours[1], 4, 5, 6, 7, 12, 13, 14, 15));
  } else {
    for (int half = 0; half < 2; ++half) {
      typename Lanes<Real>::Numbers ones[4], twos[2];
      for (int i = 0; i < 4; ++i) {
        const auto& row = rows[4 * half + i];
        ones[i] = kLarger(row.part[0], row.part[1]);
      }
      for (int i = 0; i < 2; ++i)
        twos[i] = kLarger(__builtin_shufflevector(ones[2 * i], ones[2 * i + 1], 0, 4, 1, 5),
                          __builtin_shufflevector(ones[2 * i], ones[2 * i + 1], 2, 6, 3, 7));
      result.part[half] = kLarger(__builtin_shufflevector(twos[0], twos[1], 0, 1, 4, 5),
                                  __builtin_shufflevector(twos[0], twos[1], 2, 3, 6, 7));
    }
  }
  return result;
}

/// In each lane what was in the one before; in lane 0 `first`.
template <class Real>
inline Lanes<Real> movedUp(const Lanes<Real>& lanes, Real first) {
  static_assert(sizeof(Real) == sizeof(float));
  const auto& [part] = Lanes<Real>::all(first);
  Lanes<Real> result;
  if constexpr (Lanes<Real>::kParts == 1) {
    result.part[0] = __builtin_shufflevector(part[0], lanes.part[0], 0, 8, 9, 10, 11, 12, 13, 14);
  } else {
    result.part[0] = __builtin_shufflevector(part[0], lanes.part[0], 0, 4, 5, 6);
    result.part[1] = __builtin_shufflevector(lanes.part[0], lanes.part[1], 3, 4, 5, 6);
  }
  return result;
}

/// a where it is true, else b.
template <class Real>
inline Lanes<Real> select(const Truth<Real>& truth, const Lanes<Real>& a, const Lanes<Real>& b) {
  Lanes<Real> result;
  for (int i = 0; i < Lanes<Real>::kParts; ++i)
    result.part[i] = truth.part[i] ? a.part[i] : b.part[i];
  return result;
}

/// Where `those` is true, the lesser of `bounds` and `least`; else `least`.
template <class Real>
inline Lanes<Real> leastOfThose(const Truth<Real>& those, const Lanes<Real>& bounds,
                                const Lanes<Real>& least) {
  return smaller(least, select(those, bounds, least));
}

/// True in these lanes, by bits.
inline Truth<float> lanesOf(std::uint32_t bits) {
  const LaneInts chosen =
      (LaneInts{} + static_cast<std::int32_t>(bits)) & LaneInts{1, 2, 4, 8, 16, 32, 64, 128};
  const LaneInts truths = chosen != 0;
  Truth<float> lanes;
  __builtin_memcpy(lanes.part, &truths, sizeof(lanes.part));
  return lanes;
}

/// One lane.
inline Truth<float> only(std::uint32_t lane) {
  const Lanes<float> others = Lanes<float>::numbers() - Lanes<float>::all(static_cast<float>(lane));
  return magnitudeOf(others) <= Lanes<float>{};
}

/// Those that are below zero, by bits; -0 too.
inline std::uint32_t signsOf(const Lanes<float>& lanes) {
  Truth<float> signs;
  __builtin_memcpy(signs.part, lanes.part, sizeof(signs.part));
  for (auto& part : signs.part) part >>= 31;
  return signs.bits();
}

/// The lanes of these numbers, three bits each, the first in the lowest bits.
inline Lanes<float> permuted(const Lanes<float>& lanes, std::uint32_t numbers) {
  Lanes<float> result;
#if defined(__AVX2__)
  const LaneInts chosen =
      (LaneInts{} + static_cast<std::int32_t>(numbers)) >> LaneInts{0, 3, 6, 9, 12, 15, 18, 21};
  result.part[0] =
      __builtin_ia32_permvarsf256(lanes.part[0], chosen);  // the lowest three bits count
#else
  float from[kLanes], to[kLanes];
  lanes.store(from);
  for (int i = 0; i < kLanes; ++i) to[i] = from[numbers >> (3 * i) & 7U];
  result = Lanes<float>::copy(to);
#endif
  return result;
}

inline std::uint32_t lowestBit(std::uint32_t bits) {
  return static_cast<std::uint32_t>(__builtin_ctz(bits));
}

}  // namespace
}  // namespace organ_collision::core
