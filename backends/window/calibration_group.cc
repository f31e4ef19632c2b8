#include "backends/window/calibration_group.h"

#include <Eigen/Core>
#include <algorithm>

#include "common/geometry/rotation_manifold.h"
#include "common/support/logging.h"

namespace duet {
namespace {

constexpr int kRotationNumbers = 4;
constexpr int kRotationSize = 3;

using Rows = Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>;

void Append(CalibrationGroup::Part part, CalibrationGroup* group) {
  part.component = group->tangent_size;
  part.number = group->ambient_size;
  if (part.entry != CalibrationGroup::kFilling) group->size += part.size;
  group->tangent_size += part.size;
  group->ambient_size += part.is_rotation ? kRotationNumbers : part.size;
  group->has_rotation = group->has_rotation || part.is_rotation;
  group->parts.push_back(part);
}

void Fill(int width, CalibrationGroup* group) {
  if (group->tangent_size < width) Append({.size = width - group->tangent_size}, group);
}

}  // namespace

std::vector<CalibrationGroup> GroupCalibration(const CalibrationLayout& layout, int pixel_width) {
  CHECK_GE(pixel_width, kRotationSize);
  std::vector<CalibrationGroup> groups;
  for (int e = 0; e < static_cast<int>(layout.entries().size()); ++e) {
    const CalibrationLayout::Entry& entry = layout.entries()[e];
    const bool of_imu = IsImuBlock(entry.block);
    const bool is_rotation = entry.block == CalibrationBlock::kExtrinsicRotation;
    for (int first = 0; first < entry.size;) {
      const bool same_kind = !groups.empty() && groups.back().of_imu == of_imu;
      const int left = of_imu      ? entry.size
                       : same_kind ? pixel_width - groups.back().tangent_size
                                   : 0;
      if (!same_kind || left == 0 || (is_rotation && left < kRotationSize)) {
        if (same_kind) Fill(pixel_width, &groups.back());
        groups.push_back({.of_imu = of_imu, .offset = entry.offset + first});
        continue;
      }
      const int size = std::min(left, entry.size - first);
      Append({.entry = e, .first = first, .size = size, .is_rotation = is_rotation},
             &groups.back());
      first += size;
    }
  }
  if (!groups.empty() && !groups.back().of_imu) Fill(pixel_width, &groups.back());
  return groups;
}

bool CalibrationManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const RotationManifold rotation;
  for (const auto& [entry, first, size, component, number, is_rotation] : group_.parts) {
    if (is_rotation) {
      rotation.Plus(x + number, delta + component, x_plus_delta + number);
    } else {
      for (int k = 0; k < size; ++k) {
        x_plus_delta[number + k] = x[number + k] + delta[component + k];
      }
    }
  }
  return true;
}

bool CalibrationManifold::PlusJacobian(const double* x, double* jacobian) const {
  const RotationManifold rotation;
  Rows J(jacobian, AmbientSize(), TangentSize());
  J.setZero();
  for (const auto& [entry, first, size, component, number, is_rotation] : group_.parts) {
    if (is_rotation) {
      Eigen::Matrix<double, kRotationNumbers, kRotationSize, Eigen::RowMajor> lift;
      rotation.PlusJacobian(x + number, lift.data());
      J.block<kRotationNumbers, kRotationSize>(number, component) = lift;
    } else {
      J.block(number, component, size, size).setIdentity();
    }
  }
  return true;
}

bool CalibrationManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  const RotationManifold rotation;
  for (const auto& [entry, first, size, component, number, is_rotation] : group_.parts) {
    if (is_rotation) {
      rotation.Minus(y + number, x + number, y_minus_x + component);
    } else {
      for (int k = 0; k < size; ++k) y_minus_x[component + k] = y[number + k] - x[number + k];
    }
  }
  return true;
}

bool CalibrationManifold::MinusJacobian(const double* x, double* jacobian) const {
  const RotationManifold rotation;
  Rows J(jacobian, TangentSize(), AmbientSize());
  J.setZero();
  for (const auto& [entry, first, size, component, number, is_rotation] : group_.parts) {
    if (is_rotation) {
      Eigen::Matrix<double, kRotationSize, kRotationNumbers, Eigen::RowMajor> drop;
      rotation.MinusJacobian(x + number, drop.data());
      J.block<kRotationSize, kRotationNumbers>(component, number) = drop;
    } else {
      J.block(component, number, size, size).setIdentity();
    }
  }
  return true;
}

}  // namespace duet
