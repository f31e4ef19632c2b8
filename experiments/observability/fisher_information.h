#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "backends/estimator.h"
#include "backends/window/imu_factor.h"
#include "common/dataset/track_stream.h"
#include "common/imu/imu_buffer.h"
#include "common/imu/imu_sample.h"
#include "common/imu/nav_state.h"
#include "common/measurement/calibration.h"
#include "common/measurement/measurement_model.h"
#include "common/measurement/rate_profile.h"

namespace duet {

/// A motion and what was measured along it: where everything is linearized.
struct ObservedMotion {
  /// Calibration (the linearization point), densities, pixel noise, priors and standstill options.
  EstimatorSetup setup;
  /// Of the first state: theta, p, v, b_g, b_a.
  Matrix15d start_covariance = Matrix15d::Identity();
  /// Kept by reference. `frames` and `states` go together: states[k].instant is frames[k]'s stamp +
  /// t_d, ascending; the IMU covers them all.
  const std::vector<TrackFrameSet>& frames;
  std::vector<InertialState> states;  ///< true or estimated, biases included
  const std::vector<ImuSample>& imu;  ///< as recorded
  /// What the IMU would read along the motion without noise, over the same span; empty: unknown,
  /// `imu` stands for it. It is what factors are linearized at. A Jacobian made from noisy readings
  /// holds whitened noise, about one unit of information a frame on numbers of T_g and T_a that the
  /// motion says nothing of: little beside a prior of 0.01 (1e4 units), and enough to hide what
  /// cannot be observed.
  std::vector<ImuSample> readings = {};
};

/// How much of a motion's information is used, and with what priors.
struct InformationOptions {
  /// A track is used in pieces of at most so many frames: each of its pixels once, the next piece
  /// is a new landmark. This is what an estimator does whose window holds so many poses. 0: uncut.
  int window_frames = 0;
  /// Pieces with fewer pixels (all cameras) are not used.
  int min_observations = 2;
  /// Multiplies the standard deviations of the calibration's priors and of the first state's tilt,
  /// velocity and biases (its yaw and position are a gauge and stay).
  double prior_scale = 1.0;
  /// Linearizes pixels as if each were taken at its state's instant (t_r = 0; its derivative
  /// stays). Between instant and row the measurement model freezes the rates, whose derivatives to
  /// biases and T matrices are left out by definition; that ties, by a little, directions that no
  /// measurement ties, and hides them.
  bool at_instants = false;
  /// Instants after the first frame at which sigmas are kept, ascending, s; the end always is.
  std::vector<double> times_s = {};
};

/// What an efficient estimator would know.
struct PredictedCovariance {
  struct Row {
    double time_s;           ///< of the frame, after the first
    Eigen::VectorXd sigmas;  ///< of the calibration's components
  };
  std::vector<Row> history;  ///< the last one is the end
  /// At the end, of theta, p, v, b_g, b_a of the last frame and the calibration.
  Eigen::MatrixXd covariance;
  int landmarks = 0;  ///< pieces of tracks used
  int pixels = 0;     ///< in them
  int left_out = 0;   ///< pixels in pieces too short

  [[nodiscard]] Eigen::MatrixXd CalibrationCovariance() const {
    const Eigen::Index size = covariance.rows() - 15;
    return covariance.bottomRightCorner(size, size);
  }
};

/// The Fisher information that a recording holds on its calibration: the sum of J'J of all factors
/// that the estimators use (IMU with bias walks, standstill, pixels at their row's time), at the
/// given states, with the trajectory, the points and the biases eliminated and the priors in it
/// (InformationFilter). Its inverse is the Cramer-Rao bound: no unbiased estimator that is told
/// these noises does better, one that uses all of it does as well.
///
/// Points are triangulated once from the given states with all pixels of their track, by the
/// estimators' own rules; what cannot be triangulated is left out and counted. Robust losses and
/// gates, keyframes and limits on landmarks are not modelled: every frame is used.
class FisherInformation {
 public:
  /// Called with the frames done so far; for a line of progress.
  using Observer = std::function<void(int frame)>;

  /// Integrates, triangulates. CHECKs the contract of ObservedMotion.
  explicit FisherInformation(const ObservedMotion& motion);

  /// Throws InputError where the priors are too wide for double precision. `observer` may throw.
  [[nodiscard]] PredictedCovariance Predict(const InformationOptions& options,
                                            const Observer& observer = nullptr) const;

  [[nodiscard]] const CalibrationLayout& layout() const { return layout_; }
  [[nodiscard]] double duration_s() const;
  [[nodiscard]] int frames() const { return static_cast<int>(motion_.states.size()); }
  [[nodiscard]] int tracks() const { return static_cast<int>(tracks_.size()); }
  /// Of at least two pixels, but refused by triangulation.
  [[nodiscard]] int not_triangulated() const { return not_triangulated_; }
  [[nodiscard]] int frames_at_rest() const;

 private:
  struct Pixel {
    int track;
    int piece_frame;  ///< how many frames with this track came before
    PixelObservation observation;
  };
  struct Frame {
    RateProfile rates;
    ImuFactorJacobians link;  ///< whitened; from the frame before
    bool at_rest_since_before = false;
    std::vector<Pixel> pixels;
  };
  /// A point at rest, as (alpha, beta, rho) in C0 at its first frame's state, which is a number
  /// here and no variable.
  struct Track {
    bool has_point = false;
    int frames = 0;
    int first_frame = 0;
    InverseDepth point = InverseDepth::Zero();
  };

  void Collect();
  void IntegrateLinks();
  void TriangulateTracks();
  [[nodiscard]] ObservingState StateOf(int frame) const;
  [[nodiscard]] Eigen::MatrixXd PriorInformation(double scale) const;

  ObservedMotion motion_;
  CalibrationLayout layout_;
  bool off_instant_;
  ImuBuffer imu_;       ///< as recorded
  ImuBuffer readings_;  ///< what is linearized at
  std::vector<Frame> frames_;
  std::vector<Track> tracks_;
  int not_triangulated_ = 0;
};

}  // namespace duet
