#include "common/measurement/told_errors.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "common/measurement/gauge.h"
#include "common/support/input_error.h"
#include "common/support/random.h"

namespace duet {
namespace {

// Apart from a simulated recording's random sequences of the same seed.
constexpr std::uint64_t kFirstStream = 1000;

// Everything estimated in every camera, so that a layout speaks of every number. `free` holds none.
CalibrationPriors Everything() {
  CalibrationPriors all;
  all.imu_frame = ImuFrame::kFree;
  for (BlockPrior* block : {&all.T_g, &all.T_s, &all.T_a, &all.p_CB, &all.R_CB, &all.intrinsics,
                            static_cast<BlockPrior*>(&all.distortion), &all.t_d, &all.t_r}) {
    block->estimated = true;
  }
  return all;
}

double SigmaOf(const ToldErrors& errors, CalibrationBlock block, double value) {
  switch (block) {
    case CalibrationBlock::kTg:
      return errors.T_g;
    case CalibrationBlock::kTs:
      return errors.T_s;
    case CalibrationBlock::kTa:
      return errors.T_a;
    case CalibrationBlock::kExtrinsicTranslation:
      return errors.p_CB_m;
    case CalibrationBlock::kExtrinsicRotation:
      return errors.R_CB_rad;
    case CalibrationBlock::kIntrinsics:
      return errors.intrinsics_px;
    case CalibrationBlock::kDistortion:
      return std::hypot(errors.distortion, errors.distortion_share * value);
    case CalibrationBlock::kTimeOffset:
      return errors.t_d_s;
    case CalibrationBlock::kReadoutTime:
      return errors.t_r_s;
  }
  return 0.0;
}

bool TiesAxes(ImuFrame frame, const CalibrationLayout::Entry& entry, int number) {
  switch (frame) {
    case ImuFrame::kGyroscope:
      return entry.block == CalibrationBlock::kTg && IsAboveDiagonal(number);
    case ImuFrame::kAccelerometer:
      return entry.block == CalibrationBlock::kTa && IsAboveDiagonal(number);
    case ImuFrame::kCamera:
      return entry.block == CalibrationBlock::kExtrinsicRotation && entry.camera == 0;
    case ImuFrame::kFree:
      return false;
  }
  return false;
}

// Blocks of no camera always are.
bool IsAmong(const std::vector<int>& cameras, int camera) {
  return camera < 0 || cameras.empty() ||
         std::find(cameras.begin(), cameras.end(), camera) != cameras.end();
}

struct NamedOffset {
  const char* key;
  const std::vector<double>* numbers;
};

NamedOffset OffsetOf(const ToldOffset& offset, CalibrationBlock block) {
  switch (block) {
    case CalibrationBlock::kTg:
      return {"T_g", &offset.T_g};
    case CalibrationBlock::kTs:
      return {"T_s", &offset.T_s};
    case CalibrationBlock::kTa:
      return {"T_a", &offset.T_a};
    case CalibrationBlock::kExtrinsicTranslation:
      return {"p_CB_m", &offset.p_CB_m};
    case CalibrationBlock::kExtrinsicRotation:
      return {"R_CB_rad", &offset.R_CB_rad};
    case CalibrationBlock::kIntrinsics:
      return {"intrinsics_px", &offset.intrinsics_px};
    case CalibrationBlock::kDistortion:
      return {"distortion", &offset.distortion};
    case CalibrationBlock::kTimeOffset:
      return {"t_d_s", &offset.t_d_s};
    case CalibrationBlock::kReadoutTime:
      return {"t_r_s", &offset.t_r_s};
  }
  return {"", nullptr};
}

}  // namespace

RigCalibration DrawToldRig(const RigCalibration& true_rig, const ToldErrors& errors,
                           ImuFrame imu_frame, const std::vector<int>& cameras,
                           std::uint64_t seed) {
  const CalibrationLayout layout(Everything(), true_rig);
  const Eigen::VectorXd values = ComponentValues(true_rig, layout);
  Eigen::VectorXd error(layout.size());
  for (const CalibrationLayout::Entry& entry : layout.entries()) {
    Random random(seed, kFirstStream + static_cast<std::uint64_t>(entry.block) +
                            16 * static_cast<std::uint64_t>(entry.camera + 1));
    for (int k = 0; k < entry.size; ++k) {
      const int i = entry.offset + k;
      const double drawn = random.Normal();  // drawn even where it is held: the rest stays the same
      const double sigma = SigmaOf(errors, entry.block, values[i]);
      const bool told_right =
          TiesAxes(imu_frame, entry, entry.number[k]) || !IsAmong(cameras, entry.camera);
      error[i] = told_right ? 0.0 : sigma * drawn;
    }
  }
  // x_true = x_told (+) e.
  return BoxPlus(true_rig, layout, -error);
}

RigCalibration AddToldOffset(const RigCalibration& told_rig, const ToldOffset& offset) {
  const CalibrationLayout layout(Everything(), told_rig);
  Eigen::VectorXd added = Eigen::VectorXd::Zero(layout.size());
  for (const CalibrationLayout::Entry& entry : layout.entries()) {
    const auto [key, numbers] = OffsetOf(offset, entry.block);
    if (numbers->empty()) continue;
    const auto size = static_cast<std::size_t>(entry.size);
    const std::size_t cameras = entry.camera < 0 ? 1 : told_rig.cameras.size();
    const bool one_for_all = numbers->size() == size;
    if (!one_for_all && numbers->size() != size * cameras) {
      const std::string each =
          cameras > 1 ? ", or " + std::to_string(size * cameras) + " (one set a camera)" : "";
      throw InputError("shared.calibration.told_offset." + std::string(key) + ": has " +
                       std::to_string(numbers->size()) + " numbers; expected " +
                       std::to_string(size) + each);
    }
    const std::size_t first = one_for_all ? 0 : size * static_cast<std::size_t>(entry.camera);
    for (std::size_t k = 0; k < size; ++k) {
      added[entry.offset + static_cast<int>(k)] = (*numbers)[first + k];
    }
  }
  return BoxPlus(told_rig, layout, added);
}

RigCalibration ToldRig(const RigCalibration& rig, const CalibrationPriors& priors) {
  const RigCalibration drawn =
      DrawToldRig(rig, priors.told_errors, priors.imu_frame, priors.cameras,
                  static_cast<std::uint64_t>(priors.told_errors_seed));
  return AddToldOffset(drawn, priors.told_offset);
}

ToldErrors ToldErrorsOfPriors(const CalibrationPriors& priors) {
  ToldErrors errors = priors.told_errors;
  const auto take = [](const BlockPrior& prior, double* sigma) {
    if (prior.estimated) *sigma = prior.sigma;
  };
  take(priors.T_g, &errors.T_g);
  take(priors.T_s, &errors.T_s);
  take(priors.T_a, &errors.T_a);
  take(priors.p_CB, &errors.p_CB_m);
  take(priors.R_CB, &errors.R_CB_rad);
  take(priors.intrinsics, &errors.intrinsics_px);
  take(priors.distortion, &errors.distortion);
  if (priors.distortion.estimated) errors.distortion_share = priors.distortion.share;
  take(priors.t_d, &errors.t_d_s);
  take(priors.t_r, &errors.t_r_s);
  return errors;
}

CalibrationPriors ScaledPriors(CalibrationPriors priors, double factor) {
  for (BlockPrior* block :
       {&priors.T_g, &priors.T_s, &priors.T_a, &priors.p_CB, &priors.R_CB, &priors.intrinsics,
        static_cast<BlockPrior*>(&priors.distortion), &priors.t_d, &priors.t_r}) {
    block->sigma *= factor;
  }
  priors.distortion.share *= factor;
  priors.told_errors = Scaled(priors.told_errors, factor);
  return priors;
}

ToldErrors Scaled(ToldErrors errors, double factor) {
  for (double* sigma : {&errors.T_g, &errors.T_s, &errors.T_a, &errors.p_CB_m, &errors.R_CB_rad,
                        &errors.intrinsics_px, &errors.distortion, &errors.distortion_share,
                        &errors.t_d_s, &errors.t_r_s}) {
    *sigma *= factor;
  }
  return errors;
}

}  // namespace duet
