// Filter, window and batch least squares on a linear-Gaussian problem, through the production
// functions of both: they must be one estimate.

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <cstdio>

#include "backends/msckf/compression.h"
#include "backends/msckf/filter_state.h"
#include "backends/msckf/kalman_update.h"
#include "backends/msckf/nullspace.h"
#include "backends/msckf/propagation.h"
#include "backends/window/normal_equations.h"
#include "backends/window/prior.h"
#include "backends/window/window_linearizer.h"
#include "common/support/random.h"

namespace duet {
namespace {

constexpr int kFrames = 12;
constexpr int kWindow = 5;
constexpr int kState = 15;
constexpr int kTrackLength = 3;

Eigen::MatrixXd RandomMatrix(int rows, int cols, double sigma, Random* random) {
  Eigen::MatrixXd M(rows, cols);
  for (int j = 0; j < cols; ++j) {
    for (int i = 0; i < rows; ++i) M(i, j) = sigma * random->Normal();
  }
  return M;
}

// A landmark (three free numbers) seen by consecutive frames: z = H_x x_pose + H_f f + n, n ~ N(0,
// I).
struct LinearLandmark {
  int first_frame;
  std::vector<Eigen::Matrix<double, 2, 6>> H_x;
  std::vector<Eigen::Matrix<double, 2, 3>> H_f;
  std::vector<Eigen::Vector2d> z;
  [[nodiscard]] int last_frame() const { return first_frame + kTrackLength - 1; }
};

// x_{k+1} = Phi_k x_k + u_k + w_k, the biases (last six) carried over as in every IMU interval.
struct LinearProblem {
  Vector15d mean0;
  Matrix15d P0;
  std::vector<Transition> transitions;
  std::vector<Vector15d> u;
  std::vector<LinearLandmark> landmarks;
};

Matrix15d RandomCovariance(double sigma, Random* random) {
  const Eigen::MatrixXd A = RandomMatrix(kState, kState, sigma, random);
  return A * A.transpose() + 0.1 * sigma * sigma * Matrix15d::Identity();
}

LinearProblem MakeProblem(Random* random) {
  LinearProblem problem;
  problem.mean0 = RandomMatrix(kState, 1, 1.0, random);
  problem.P0 = RandomCovariance(0.3, random);
  Vector15d x = problem.mean0 + RandomMatrix(kState, 1, 0.5, random);
  std::vector<Vector15d> states = {x};
  for (int k = 0; k + 1 < kFrames; ++k) {
    Transition t;
    t.Phi.topRows<9>() += RandomMatrix(9, kState, 0.1, random);
    t.Q = RandomCovariance(0.05, random);
    problem.u.push_back(RandomMatrix(kState, 1, 0.2, random));
    x = t.Phi * x + problem.u.back() + RandomMatrix(kState, 1, 0.05, random);
    states.push_back(x);
    problem.transitions.push_back(t);
  }
  for (int first = 0; first + kTrackLength < kFrames; ++first) {
    for (int i = 0; i < 4; ++i) {
      LinearLandmark landmark;
      landmark.first_frame = first;
      const Eigen::Vector3d f = RandomMatrix(3, 1, 1.0, random);
      for (int k = 0; k < kTrackLength; ++k) {
        landmark.H_x.push_back(RandomMatrix(2, 6, 1.0, random));
        landmark.H_f.push_back(RandomMatrix(2, 3, 1.0, random));
        landmark.z.push_back(landmark.H_x[k] * states[first + k].head<6>() + landmark.H_f[k] * f +
                             RandomMatrix(2, 1, 1.0, random));
      }
      problem.landmarks.push_back(landmark);
    }
  }
  return problem;
}

struct Answer {
  Vector15d mean;
  Matrix15d covariance;
};

Matrix15d Whitener(const Matrix15d& covariance) { return SquareRootInformation(covariance); }

// All states and landmarks at once, by QR of the stacked, whitened rows.
Answer Batch(const LinearProblem& problem, double* condition) {
  const int columns = kState * kFrames + 3 * static_cast<int>(problem.landmarks.size());
  const int rows = kState * kFrames + 2 * kTrackLength * static_cast<int>(problem.landmarks.size());
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(rows, columns);
  Eigen::VectorXd y(rows);
  int row = 0;
  const Matrix15d W0 = Whitener(problem.P0);
  A.block<15, 15>(row, 0) = W0;
  y.segment<15>(row) = W0 * problem.mean0;
  row += kState;
  for (int k = 0; k + 1 < kFrames; ++k) {
    const Matrix15d W = Whitener(problem.transitions[k].Q);
    A.block<15, 15>(row, kState * k) = -W * problem.transitions[k].Phi;
    A.block<15, 15>(row, kState * (k + 1)) = W;
    y.segment<15>(row) = W * problem.u[k];
    row += kState;
  }
  for (std::size_t l = 0; l < problem.landmarks.size(); ++l) {
    const LinearLandmark& landmark = problem.landmarks[l];
    for (int k = 0; k < kTrackLength; ++k) {
      A.block<2, 6>(row, kState * (landmark.first_frame + k)) = landmark.H_x[k];
      A.block<2, 3>(row, kState * kFrames + 3 * static_cast<int>(l)) = landmark.H_f[k];
      y.segment<2>(row) = landmark.z[k];
      row += 2;
    }
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(A);
  const Eigen::MatrixXd R =
      qr.matrixQR().topRows(columns).triangularView<Eigen::Upper>().toDenseMatrix();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(R.transpose() * R,
                                                             Eigen::EigenvaluesOnly);
  *condition = std::sqrt(eigen.eigenvalues()[columns - 1] / eigen.eigenvalues()[0]);
  const Eigen::VectorXd x = qr.solve(y);
  const Eigen::MatrixXd R_inverse =
      R.triangularView<Eigen::Upper>().solve(Eigen::MatrixXd::Identity(columns, columns));
  const int newest = kState * (kFrames - 1);
  return {x.segment<15>(newest),
          (R_inverse.middleRows<15>(newest) * R_inverse.middleRows<15>(newest).transpose())};
}

// The filter: propagate, augment, and update with every landmark that has ended, null space and
// compression included; the oldest clone leaves when the window is full.
Answer Filter(const LinearProblem& problem) {
  constexpr int kClone = 9;  // theta, p, v
  Eigen::MatrixXd P = Eigen::MatrixXd::Zero(kState + kClone * kWindow, kState + kClone * kWindow);
  P.topLeftCorner<15, 15>() = problem.P0;
  Eigen::VectorXd x = problem.mean0;
  std::vector<int> clones;  // frames
  KalmanWorkspace kalman;
  PropagationWorkspace propagation;
  for (int frame = 0; frame < kFrames; ++frame) {
    int n = static_cast<int>(x.size());
    if (frame > 0) {
      const Transition& t = problem.transitions[frame - 1];
      PropagateCovariance(t, CalibrationLayout(), P.topLeftCorner(n, n), &propagation);
      x.head<15>() = (t.Phi * x.head<15>() + problem.u[frame - 1]).eval();
    }
    DuplicateComponents(P, n, 0, kClone);
    x.conservativeResize(n + kClone);
    x.tail<kClone>() = x.head<kClone>();
    n += kClone;
    clones.push_back(frame);

    std::vector<int> components;
    for (int c = kState; c < n; ++c) components.push_back(c);
    const int width = n - kState;
    std::vector<MeasurementRows> blocks;
    int total = 0;
    for (const LinearLandmark& landmark : problem.landmarks) {
      if (landmark.last_frame() + 1 != frame) continue;
      const int m = 2 * kTrackLength;
      MeasurementRows rows = MeasurementRows::Zero(m, width + 1);
      LandmarkRows H_f(m, 3);
      for (int k = 0; k < kTrackLength; ++k) {
        const auto it = std::find(clones.begin(), clones.end(), landmark.first_frame + k);
        const int column = kClone * static_cast<int>(it - clones.begin());
        rows.block<2, 6>(2 * k, column) = landmark.H_x[k];
        H_f.middleRows<2>(2 * k) = landmark.H_f[k];
        rows.block<2, 1>(2 * k, width) =
            landmark.z[k] - landmark.H_x[k] * x.segment<6>(kState + column);
      }
      ProjectNullspace(H_f, rows);
      blocks.push_back(rows.bottomRows(m - 3));
      total += m - 3;
    }
    if (total > 0) {
      Eigen::MatrixXd stack(total, width + 1);
      int row = 0;
      for (const MeasurementRows& block : blocks) {
        stack.middleRows(row, block.rows()) = block;
        row += static_cast<int>(block.rows());
      }
      const int left = Compress(stack);
      Eigen::VectorXd dx(n);
      EXPECT_TRUE(
          KalmanUpdate(stack.topRows(left), components, P.topLeftCorner(n, n), dx, &kalman));
      x += dx;
    }
    if (static_cast<int>(clones.size()) == kWindow) {
      RemoveComponents(P.topLeftCorner(n, n), kState, kClone);
      Eigen::VectorXd rest(n - kClone);
      rest << x.head<15>(), x.tail(n - kState - kClone);
      x = rest;
      clones.erase(clones.begin());
    }
  }
  return {x.head<15>(), P.topLeftCorner<15, 15>()};
}

// The window: normal equations about an arbitrary point, marginalized frame by frame with the
// landmarks that the oldest frame saw.
Answer Window(const LinearProblem& problem) {
  const CalibrationLayout no_calibration;
  const Eigen::VectorXd x_bar = Eigen::VectorXd::Constant(kState * kFrames, 0.3);  // anywhere
  const auto at = [&](int frame) { return x_bar.segment<15>(kState * frame); };
  const auto add_link = [&](int oldest, int frame, NormalEquations* equations) {
    const Transition& t = problem.transitions[frame - 1];
    const Matrix15d W = Whitener(t.Q);
    ImuFactorJacobians J;
    J.J_i = -W * t.Phi;
    J.J_j = W;
    J.J_T.setZero();
    const Vector15d r = W * (at(frame) - t.Phi * at(frame - 1) - problem.u[frame - 1]);
    equations->AddImu(frame - 1 - oldest, frame - oldest, r, J);
  };
  const auto add_landmarks = [&](int oldest, int first_frame, NormalEquations* equations) {
    for (const LinearLandmark& landmark : problem.landmarks) {
      if (landmark.first_frame != first_frame) continue;
      std::vector<LinearObservation> observations(kTrackLength);
      for (int k = 0; k < kTrackLength; ++k) {
        LinearObservation& o = observations[k];
        o.frame = landmark.first_frame + k - oldest;
        o.J.landmark = landmark.H_f[k];
        o.J.anchor.setZero();
        o.J.state.setZero();
        o.J.state.leftCols<6>() = landmark.H_x[k];
        o.J.calibration.resize(2, 0);
        o.r = landmark.H_x[k] * at(landmark.first_frame + k).head<6>() - landmark.z[k];
      }
      equations->AddLandmark(landmark.first_frame - oldest, observations, false, false);
    }
  };

  // The first prior, J d + e with d from x_bar.
  WindowPrior prior;
  for (const auto& [kind, size] :
       {std::pair{PriorBlock::Kind::kPose, 6}, std::pair{PriorBlock::Kind::kVelocity, 3},
        std::pair{PriorBlock::Kind::kBiases, 6}}) {
    prior.blocks.push_back({kind, 0, size});
  }
  prior.root.J = Whitener(problem.P0);
  prior.root.e = prior.root.J * (at(0) - problem.mean0);

  int oldest = 0;
  for (int newest = 1; newest < kFrames; ++newest) {
    if (newest - oldest + 1 <= kWindow) continue;
    NormalEquations equations(newest - oldest, no_calibration);
    add_link(oldest, oldest + 1, &equations);
    add_landmarks(oldest, oldest, &equations);
    InformationForm form = equations.Take();
    AddPrior(prior, newest - oldest, no_calibration, &form);
    std::vector<int> keep;
    std::vector<int> drop;
    for (int c = 0; c < static_cast<int>(form.b.size()); ++c) {
      (c < kState ? drop : keep).push_back(c);
    }
    prior = PriorFromInformation(SchurComplement(form, keep, drop), newest - oldest - 1, {},
                                 no_calibration);
    ++oldest;
  }
  const int count = kFrames - oldest;
  NormalEquations equations(count, no_calibration);
  for (int frame = oldest + 1; frame < kFrames; ++frame) add_link(oldest, frame, &equations);
  for (int frame = oldest; frame < kFrames; ++frame) add_landmarks(oldest, frame, &equations);
  InformationForm form = equations.Take();
  AddPrior(prior, count, no_calibration, &form);
  const Eigen::VectorXd step = form.H.ldlt().solve(-form.b);
  return {at(kFrames - 1) + step.tail<15>(), NewestCovariance(form.H, 0)};
}

double Difference(const Answer& a, const Answer& b) {
  return std::max((a.mean - b.mean).norm() / b.mean.norm(),
                  (a.covariance - b.covariance).norm() / b.covariance.norm());
}

TEST(LinearGaussian, FilterWindowAndBatchAreOneEstimate) {
  for (int seed = 1; seed <= 5; ++seed) {
    Random random(seed);
    const LinearProblem problem = MakeProblem(&random);
    double condition = 0.0;
    const Answer batch = Batch(problem, &condition);
    const double filter = Difference(Filter(problem), batch);
    const double window = Difference(Window(problem), batch);
    std::printf("seed %d: condition of the batch %.1e, filter - batch %.1e, window - batch %.1e\n",
                seed, condition, filter, window);
    EXPECT_LT(condition, 1e4);  // normal equations square it: 1e8 * 2e-16 stays below the bound
    EXPECT_LT(filter, 1e-8);
    EXPECT_LT(window, 1e-8);
  }
}

}  // namespace
}  // namespace duet
