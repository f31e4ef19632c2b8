#pragma once

#include <Eigen/Core>
#include <numbers>
#include <vector>

#include "common/support/random.h"

namespace duet {

inline Eigen::Vector3d RandomVector(Random* random) {
  Eigen::Vector3d v;
  for (int i = 0; i < 3; ++i) v[i] = random->Normal();
  return v;
}

/// Rotation vectors at which every property must hold: identity, 1e-8, around every switch between
/// a series and a closed form, random, and near (not beyond) half a turn.
inline std::vector<Eigen::Vector3d> HardRotationVectors() {
  Random random(1);
  std::vector<Eigen::Vector3d> result = {Eigen::Vector3d::Zero()};
  const double pi = std::numbers::pi;
  for (const double angle : {1e-300, 1e-155, 1e-12, 1e-8, 0.99e-4, 1.01e-4, 1e-2, 0.499, 0.501,
                             0.999, 1.001, 2.0, pi - 1e-2, pi - 1e-6, pi - 1e-8, pi - 1e-12}) {
    for (int i = 0; i < 3; ++i) {
      result.push_back(angle * RandomVector(&random).normalized());
      result.push_back(angle * Eigen::Vector3d::Unit(i));
    }
  }
  for (int i = 0; i < 200; ++i) {
    result.push_back(pi * random.Uniform() * RandomVector(&random).normalized());
  }
  return result;
}

}  // namespace duet
