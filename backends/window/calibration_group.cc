#include "backends/window/calibration_group.h"

#include <Eigen/Core>
#include <algorithm>

#include "common/geometry/rotation_manifold.h"

namespace duet {
namespace {

constexpr int kRotationNumbers = 4;
constexpr int kRotationSize = 3;

bool IsRotation(const CalibrationLayout::Entry& entry) {
  return entry.block == CalibrationBlock::kExtrinsicRotation;
}

// Calls function(is a rotation, first number, first component, size of the error) block by block.
template <class Function>
void ForEachBlockOf(const CalibrationLayout& layout, const CalibrationGroup& group,
                    const Function& function) {
  int number = 0;
  for (int e = group.first_entry; e < group.first_entry + group.entry_count; ++e) {
    const CalibrationLayout::Entry& entry = layout.entries()[e];
    function(IsRotation(entry), number, entry.offset - group.offset, entry.size);
    number += IsRotation(entry) ? kRotationNumbers : entry.size;
  }
}

using Rows = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

}  // namespace

std::vector<CalibrationGroup> GroupCalibration(const CalibrationLayout& layout) {
  std::vector<CalibrationGroup> groups;
  bool of_imu = false;
  for (int e = 0; e < static_cast<int>(layout.entries().size()); ++e) {
    const CalibrationLayout::Entry& entry = layout.entries()[e];
    if (groups.empty() || of_imu != IsImuBlock(entry.block)) {
      of_imu = IsImuBlock(entry.block);
      groups.push_back({.first_entry = e, .offset = entry.offset});
    }
    CalibrationGroup& group = groups.back();
    ++group.entry_count;
    group.size += entry.size;
    group.ambient_size += IsRotation(entry) ? kRotationNumbers : entry.size;
    group.has_rotation = group.has_rotation || IsRotation(entry);
  }
  return groups;
}

bool CalibrationManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const RotationManifold rotation;
  ForEachBlockOf(layout_, group_, [&](bool rotates, int number, int component, int size) {
    if (rotates) {
      rotation.Plus(x + number, delta + component, x_plus_delta + number);
    } else {
      for (int k = 0; k < size; ++k) {
        x_plus_delta[number + k] = x[number + k] + delta[component + k];
      }
    }
  });
  return true;
}

bool CalibrationManifold::PlusJacobian(const double* x, double* jacobian) const {
  const RotationManifold rotation;
  Rows J(jacobian, AmbientSize(), TangentSize());
  J.setZero();
  ForEachBlockOf(layout_, group_, [&](bool rotates, int number, int component, int size) {
    if (rotates) {
      Eigen::Matrix<double, kRotationNumbers, kRotationSize, Eigen::RowMajor> lift;
      rotation.PlusJacobian(x + number, lift.data());
      J.block<kRotationNumbers, kRotationSize>(number, component) = lift;
    } else {
      J.block(number, component, size, size).setIdentity();
    }
  });
  return true;
}

bool CalibrationManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  const RotationManifold rotation;
  ForEachBlockOf(layout_, group_, [&](bool rotates, int number, int component, int size) {
    if (rotates) {
      rotation.Minus(y + number, x + number, y_minus_x + component);
    } else {
      for (int k = 0; k < size; ++k) y_minus_x[component + k] = y[number + k] - x[number + k];
    }
  });
  return true;
}

bool CalibrationManifold::MinusJacobian(const double* x, double* jacobian) const {
  const RotationManifold rotation;
  Rows J(jacobian, TangentSize(), AmbientSize());
  J.setZero();
  ForEachBlockOf(layout_, group_, [&](bool rotates, int number, int component, int size) {
    if (rotates) {
      Eigen::Matrix<double, kRotationSize, kRotationNumbers, Eigen::RowMajor> drop;
      rotation.MinusJacobian(x + number, drop.data());
      J.block<kRotationSize, kRotationNumbers>(component, number) = drop;
    } else {
      J.block(component, number, size, size).setIdentity();
    }
  });
  return true;
}

}  // namespace duet
