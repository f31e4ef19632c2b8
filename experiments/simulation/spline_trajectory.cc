#include "common/support/timestamp.h"
#include "experiments/simulation/trajectory.h"

namespace duet {

double SplineTrajectory::duration_s() const {
  return SecondsBetween(spline_.start(), spline_.end());
}

Kinematics SplineTrajectory::At(double t_s) const {
  return spline_.At(spline_.start() + ToNanoseconds(t_s));
}

}  // namespace duet
