#include "common/measurement/told_checks.h"

#include <Eigen/LU>
#include <cmath>
#include <string>
#include <vector>

#include "common/support/input_error.h"
#include "common/support/numeric_text.h"

namespace duet {
namespace {

constexpr double kSmallestDeterminant = 1e-3;  // as where T_g and T_a are read

// The setting that moved a block from the recording's own values.
std::string KeyOf(const std::string& name, const std::vector<double>& offset, double error,
                  const char* block) {
  const std::string calibration = "shared.calibration.";
  if (!offset.empty()) return calibration + "told_offset." + name;
  if (error > 0.0) return calibration + "told_errors." + name;
  return calibration + block + ".sigma";  // told errors drawn from the priors
}

void CheckInverse(const Eigen::Matrix3d& T, const char* name, const std::vector<double>& offset,
                  double error) {
  const double determinant = T.determinant();
  if (std::abs(determinant) > kSmallestDeterminant) return;
  throw InputError(KeyOf(name, offset, error, name) + ": the told " + name +
                   " has a determinant of " + FormatNumber(determinant) +
                   "; expected a matrix with an inverse");
}

}  // namespace

void CheckTold(const RigCalibration& told, const CalibrationPriors& priors) {
  const int count = static_cast<int>(told.cameras.size());
  for (const int camera : priors.cameras) {
    if (camera < count) continue;
    throw InputError("shared.calibration.cameras: names camera " + std::to_string(camera) +
                     "; expected cameras of the rig, counted from 0: it has " +
                     std::to_string(count));
  }
  const ToldOffset& offset = priors.told_offset;
  const ToldErrors& errors = priors.told_errors;
  CheckInverse(told.imu.T_g, "T_g", offset.T_g, errors.T_g);
  CheckInverse(told.imu.T_a, "T_a", offset.T_a, errors.T_a);
  for (int c = 0; c < count; ++c) {
    for (const int k : {0, 1}) {
      const double focal_px = told.cameras[c].model.parameters()[k];
      if (focal_px > 0.0) continue;
      throw InputError(
          KeyOf("intrinsics_px", offset.intrinsics_px, errors.intrinsics_px, "intrinsics") +
          ": the told " + (k == 0 ? "fx" : "fy") + " of camera " + std::to_string(c) + " is " +
          FormatNumber(focal_px) + " px; expected a focal length above 0 px");
    }
  }
}

}  // namespace duet
