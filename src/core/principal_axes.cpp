#include "core/principal_axes.h"

#include <Eigen/Eigenvalues>

namespace organ_collision::core {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// So many points are asked at most.
constexpr std::size_t kMostPoints = 256;

bool isOrthonormal(const Matrix3d& axes) {
  const Matrix3d off = axes * axes.transpose() - Matrix3d::Identity();
  return (off.array().abs() <= 0x1p-40).all();  // also if something is not a number
}

/// In rows. In closed form, which tells less where two eigenvalues are nearly the same: then by
/// iterations.
Matrix3d eigenvectorsOf(const Matrix3d& symmetric) {
  Eigen::SelfAdjointEigenSolver<Matrix3d> solver;
  const Matrix3d axes = solver.computeDirect(symmetric).eigenvectors().transpose();
  return isOrthonormal(axes) ? axes : solver.compute(symmetric).eigenvectors().transpose();
}

}  // namespace

Matrix3d principalAxes(const Vector3d* points, std::size_t count) {
  const std::size_t step = 1 + count / kMostPoints;
  Vector3d mean = Vector3d::Zero();
  for (std::size_t i = 0; i < count; i += step) mean += points[i];
  const std::size_t added = (count + step - 1) / step;
  mean /= static_cast<double>(added);
  Vector3d squares = Vector3d::Zero();
  Vector3d products = Vector3d::Zero();  // y*z, z*x, x*y
  for (std::size_t i = 0; i < count; i += step) {
    const Vector3d offset = points[i] - mean;
    squares += offset.cwiseAbs2();
    products += Vector3d(offset.y() * offset.z(), offset.z() * offset.x(), offset.x() * offset.y());
  }
  Matrix3d covariance;
  covariance << squares.x(), products.z(), products.y(),  //
      products.z(), squares.y(), products.x(),            //
      products.y(), products.x(), squares.z();
  return eigenvectorsOf(covariance);
}

}  // namespace organ_collision::core
