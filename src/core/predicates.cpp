#include "organ_collision/core/predicates.h"

#include <array>
#include <cmath>
#include <cstddef>

#include "core/plane_coordinates.h"

namespace organ_collision::core {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Shewchuk's bounds on the rounding error of a determinant, relative to the sum of the magnitudes
// of its terms.
constexpr double kUnit = 0x1p-53;
constexpr double kErrorOf2d = (3 + 16 * kUnit) * kUnit;
constexpr double kErrorOf3d = (7 + 56 * kUnit) * kUnit;
// Above this sum of magnitudes no underflow of a product counts, even when multiplied by the
// largest coordinate.
constexpr double kNoUnderflow = 0x1p-400;

int signOf(double x) { return (x > 0 ? 1 : 0) - (x < 0 ? 1 : 0); }

/// A sum that is never rounded: terms of ascending magnitude whose bits do not overlap (Shewchuk's
/// expansion).
class ExactSum {
 public:
  void add(double x) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < size_; ++i) {
      const double sum = x + terms_[i];
      const double added = sum - x;
      const double lost = (x - (sum - added)) + (terms_[i] - added);
      if (lost != 0) terms_[kept++] = lost;
      x = sum;
    }
    if (x != 0) terms_[kept++] = x;
    size_ = kept;
  }
  void addProduct(double x, double y) {
    const double product = x * y;
    add(std::fma(x, y, -product));
    add(product);
  }
  void addProduct(double x, double y, double z) {
    const double product = x * y;
    addProduct(std::fma(x, y, -product), z);
    addProduct(product, z);
  }
  int sign() const { return size_ == 0 ? 0 : signOf(terms_[size_ - 1]); }

 private:
  // 6 products of three differences, in each 8 choices of head or tail, 4 terms for each choice
  std::array<double, 192> terms_;
  std::size_t size_ = 0;
};

/// head + tail = v - w without rounding, but for a factor that is a power of two and brings the
/// head near 1.
class ExactDifference {
 public:
  ExactDifference(const Vector3d& v, const Vector3d& w) : head_(v - w) {
    const Vector3d subtracted = v - head_;
    tail_ = (v - (head_ + subtracted)) + (subtracted - w);
    const double largest = largestCoordinate(head_);
    if (largest == 0) return;
    const double factor = normalisingFactor(largest);
    head_ *= factor;
    tail_ *= factor;
  }
  std::array<double, 2> operator[](int i) const { return {head_[i], tail_[i]}; }

 private:
  Vector3d head_;
  Vector3d tail_;
};

void addProducts(int sign, const std::array<double, 2>& left, const std::array<double, 2>& middle,
                 const std::array<double, 2>& right, ExactSum& sum) {
  for (const double x : left) {
    for (const double y : middle) {
      for (const double z : right) {
        if (x != 0 && y != 0 && z != 0) sum.addProduct(sign * x, y, z);
      }
    }
  }
}

int exactSign(const ExactDifference& p, const ExactDifference& q, const ExactDifference& r) {
  ExactSum determinant;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    addProducts(+1, p[i], q[j], r[k], determinant);
    addProducts(-1, p[i], q[k], r[j], determinant);
  }
  return determinant.sign();
}

/// The filter of orientation(a, b, c) along all three axes at a time.
bool isClearlyNotCollinear(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d p = b - a;
  const Vector3d q = c - a;
  const auto is_clear = [](double left, double right) {
    const double magnitude = std::abs(left) + std::abs(right);
    return (magnitude > kNoUnderflow) & (std::abs(left - right) > kErrorOf2d * magnitude);
  };
  return is_clear(p.x() * q.y(), p.y() * q.x()) | is_clear(p.y() * q.z(), p.z() * q.y()) |
         is_clear(p.z() * q.x(), p.x() * q.z());
}

}  // namespace

int orientation(const Vector2d& a, const Vector2d& b, const Vector2d& c) {
  const Vector2d p = b - a;
  const Vector2d q = c - a;
  const double left = p.x() * q.y();
  const double right = p.y() * q.x();
  const double magnitude = std::abs(left) + std::abs(right);
  const double determinant = left - right;
  if (magnitude > kNoUnderflow && std::abs(determinant) > kErrorOf2d * magnitude)
    return signOf(determinant);
  const auto flat = [](const Vector2d& v) { return Vector3d(v.x(), v.y(), 0); };
  return exactSign({flat(b), flat(a)}, {flat(c), flat(a)}, {Vector3d::UnitZ(), Vector3d::Zero()});
}

int orientation(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d) {
  const Vector3d p = b - a;
  const Vector3d q = c - a;
  const Vector3d r = d - a;
  double determinant = 0;
  double magnitude = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const int k = (i + 2) % 3;
    const double left = q[j] * r[k];
    const double right = q[k] * r[j];
    determinant += p[i] * (left - right);
    magnitude += std::abs(p[i]) * (std::abs(left) + std::abs(right));
  }
  if (magnitude > kNoUnderflow && std::abs(determinant) > kErrorOf3d * magnitude)
    return signOf(determinant);
  return exactSign({b, a}, {c, a}, {d, a});
}

bool collinear(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  if (isClearlyNotCollinear(a, b, c)) return false;
  const auto aligned_along = [&](int axis) {
    return orientation(alongAxis(a, axis), alongAxis(b, axis), alongAxis(c, axis)) == 0;
  };
  return aligned_along(0) && aligned_along(1) && aligned_along(2);
}

}  // namespace organ_collision::core
