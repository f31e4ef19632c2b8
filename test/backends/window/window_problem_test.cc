#include "backends/window/window_problem.h"

#include <ceres/crs_matrix.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <vector>

#include "backends/window/window_linearizer.h"
#include "test/backends/window/random_window.h"

namespace duet {
namespace {

using window_test::RandomWindow;

// A prior over everything, of random residuals.
WindowPrior RandomPrior(const RandomWindow& window, double origin_offset, Random* random,
                        std::vector<WindowFrame>* frames) {
  const int frame_count = static_cast<int>(frames->size());
  const int n = kFrameSize * frame_count + window.layout.size();
  for (WindowFrame& frame : *frames) {
    frame.origin = BoxPlus(frame.state, origin_offset * random->NormalVector<15>());
    frame.pose_in_prior = frame.velocity_in_prior = frame.biases_in_prior = true;
  }
  Eigen::MatrixXd J(n, n);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) J(i, j) = random->Normal();
  }
  const Eigen::VectorXd e = random->NormalVector(n);
  const RigCalibration rig_origin = BoxPlus(
      window.rig, window.layout, 0.01 * origin_offset * random->NormalVector(window.layout.size()));
  return PriorFromInformation({J.transpose() * J, J.transpose() * e}, frame_count, rig_origin,
                              window.layout);
}

// The problem's blocks in the order of the window's error, then the landmarks.
std::vector<double*> BlocksInOrder(const RandomWindow& window, ParameterArena* arena) {
  std::vector<double*> blocks;
  for (int i = 0; i < static_cast<int>(window.frames.size()); ++i) {
    blocks.push_back(arena->pose(i));
    if (!arena->pose_with_velocity()) blocks.push_back(arena->velocity(i));
    blocks.push_back(arena->biases(i));
  }
  for (int g = 0; g < static_cast<int>(arena->groups().size()); ++g) {
    blocks.push_back(arena->group(g));
  }
  for (int l = 0; l < static_cast<int>(window.landmarks.size()); ++l) {
    blocks.push_back(arena->landmark(l));
  }
  return blocks;
}

Eigen::MatrixXd Dense(const ceres::CRSMatrix& sparse) {
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
  for (int row = 0; row < sparse.num_rows; ++row) {
    for (int k = sparse.rows[row]; k < sparse.rows[row + 1]; ++k) {
      dense(row, sparse.cols[k]) = sparse.values[k];
    }
  }
  return dense;
}

// J without the columns of what fills a group of the calibration up: zeros, which are checked.
Eigen::MatrixXd WithoutFilling(const Eigen::MatrixXd& J, const RandomWindow& window,
                               const ParameterArena& arena) {
  std::vector<int> kept;
  int column = 0;
  while (column < kFrameSize * static_cast<int>(window.frames.size())) kept.push_back(column++);
  for (const CalibrationGroup& group : arena.groups()) {
    for (const CalibrationGroup::Part& part : group.parts) {
      const int end = column + part.size;
      if (part.entry == CalibrationGroup::kFilling) {
        EXPECT_TRUE(J.middleCols(column, part.size).isZero(0.0));
        column = end;
      }
      while (column < end) kept.push_back(column++);
    }
  }
  while (column < J.cols()) kept.push_back(column++);
  return J(Eigen::all, kept);
}

// Residuals and, where asked for, the Jacobian over errors in the order of `blocks`.
std::vector<double> Evaluate(ceres::Problem* problem, const std::vector<double*>& blocks,
                             Eigen::MatrixXd* J) {
  ceres::Problem::EvaluateOptions options;
  options.parameter_blocks = blocks;
  std::vector<double> residuals;
  ceres::CRSMatrix sparse;
  EXPECT_TRUE(
      problem->Evaluate(options, nullptr, &residuals, nullptr, J != nullptr ? &sparse : nullptr));
  if (J != nullptr) *J = Dense(sparse);
  return residuals;
}

struct Fixture {
  explicit Fixture(std::uint64_t seed, double origin_offset)
      : window(4, 6, seed), random(seed + 1000) {
    options.robust_loss = WindowOptions::RobustLoss::kNone;
    options.first_estimates = false;
    window.frames[2].at_rest_since_before = true;
    prior = RandomPrior(window, origin_offset, &random, &window.frames);
  }

  RandomWindow window;
  Random random;
  WindowOptions options;
  StandstillOptions standstill;
  WindowPrior prior;
};

TEST(WindowProblem, JacobiansAgreeWithNumericDifferentiation) {
  Fixture f(1, 0.3);
  WindowProblem problem(f.options, f.window.reprojection, f.standstill, f.window.layout);
  problem.Build(f.window.frames, f.window.rig, f.window.landmarks, f.prior);
  const std::vector<double*> blocks = BlocksInOrder(f.window, &problem.arena());
  Eigen::MatrixXd J;
  Evaluate(&problem.problem(), blocks, &J);
  // The standstill measurement's rotation rows are linearized at rest by definition
  // (common/measurement/standstill.h); its three rows follow prior and two IMU factors.
  const int standstill_rotation = static_cast<int>(f.prior.root.J.rows()) + 2 * 15 + 3;

  int column = 0;
  for (double* block : blocks) {
    const int size = problem.problem().ParameterBlockSize(block);
    const int tangent = problem.problem().ParameterBlockTangentSize(block);
    const ceres::Manifold* manifold = problem.problem().GetManifold(block);
    const std::vector<double> value(block, block + size);
    for (int k = 0; k < tangent; ++k, ++column) {
      // Central differences; distortion moves pixels by thousands a unit.
      constexpr double kStep = 1e-6;
      std::vector<std::vector<double>> residuals;
      for (const double step : {kStep, -kStep}) {
        std::vector<double> d(tangent, 0.0);
        d[k] = step;
        if (manifold != nullptr) {
          manifold->Plus(value.data(), d.data(), block);
        } else {
          block[k] = value[k] + step;
        }
        residuals.push_back(Evaluate(&problem.problem(), blocks, nullptr));
        std::copy(value.begin(), value.end(), block);
      }
      const double scale = 1.0 + J.col(column).cwiseAbs().maxCoeff();
      for (int row = 0; row < J.rows(); ++row) {
        if (row >= standstill_rotation && row < standstill_rotation + 3) continue;
        const double numeric = (residuals[0][row] - residuals[1][row]) / (2.0 * kStep);
        ASSERT_NEAR(numeric, J(row, column), 2e-6 * scale) << "row " << row << " column " << column;
      }
    }
  }
  EXPECT_EQ(column, J.cols());
}

TEST(WindowLinearizer, NormalEquationsEqualTheSolversSchurComplement) {
  // Two codes, one answer: H of the linearizer (landmarks eliminated as they come) against the
  // Schur complement of J'J from Ceres's Jacobian over everything.
  Fixture f(2, 0.0);
  WindowProblem problem(f.options, f.window.reprojection, f.standstill, f.window.layout);
  problem.Build(f.window.frames, f.window.rig, f.window.landmarks, f.prior);
  Eigen::MatrixXd J;
  const std::vector<double> r =
      Evaluate(&problem.problem(), BlocksInOrder(f.window, &problem.arena()), &J);
  J = WithoutFilling(J, f.window, problem.arena());
  const Eigen::Map<const Eigen::VectorXd> r_all(r.data(), static_cast<Eigen::Index>(r.size()));
  const int n = static_cast<int>(J.cols());
  const int n_window = kFrameSize * 4 + f.window.layout.size();
  std::vector<int> keep;
  std::vector<int> drop;
  for (int i = 0; i < n; ++i) (i < n_window ? keep : drop).push_back(i);
  const InformationForm expected =
      SchurComplement({J.transpose() * J, J.transpose() * r_all}, keep, drop);

  WindowLinearizer linearizer(f.options, f.window.reprojection, f.standstill, f.window.layout);
  linearizer.SetWindow(f.window.frames, f.window.rig);
  NormalEquations equations(4, f.window.layout);
  for (int i = 1; i < 4; ++i) linearizer.AddLink(i, &equations);
  for (const Landmark& landmark : f.window.landmarks) {
    linearizer.AddLandmark(landmark, 3, &equations);
  }
  InformationForm form = equations.Take();
  AddPrior(f.prior, 4, f.window.layout, &form);
  const Eigen::VectorXd scale = expected.H.diagonal().cwiseSqrt().cwiseInverse();
  EXPECT_LT((scale.asDiagonal() * (form.H - expected.H) * scale.asDiagonal()).norm(), 1e-9);
  EXPECT_LT(scale.cwiseProduct(form.b - expected.b).norm(),
            1e-9 * scale.cwiseProduct(form.b).norm());

  // The covariance is the corner of the inverse over everything, landmarks included.
  const Eigen::VectorXd all = J.colwise().norm().cwiseInverse();
  const Eigen::MatrixXd scaled = J * all.asDiagonal();
  const Eigen::MatrixXd inverse =
      all.asDiagonal() * (scaled.transpose() * scaled).inverse() * all.asDiagonal();
  const int corner = kFrameSize + f.window.layout.size();
  const int first = kFrameSize * 3;
  const Eigen::MatrixXd dense = inverse.block(first, first, corner, corner);
  const Eigen::MatrixXd covariance = NewestCovariance(form.H, f.window.layout.size());
  ASSERT_EQ(covariance.rows(), corner);
  const Eigen::VectorXd sigma = dense.diagonal().cwiseSqrt().cwiseInverse();
  // H is conditioned like 1e8 after scaling.
  EXPECT_LT((sigma.asDiagonal() * (covariance - dense) * sigma.asDiagonal()).norm(), 1e-6);
}

TEST(WindowLinearizer, DepthFollowsPosesAndCalibration) {
  // The least-squares inverse depth of a landmark, with its pixels' noise and with all else as
  // uncertain as prior and IMU leave it: from the solver's Jacobian against LinearizeDepth.
  Fixture f(4, 0.0);
  f.window.landmarks.resize(1);
  WindowProblem problem(f.options, f.window.reprojection, f.standstill, f.window.layout);
  problem.Build(f.window.frames, f.window.rig, f.window.landmarks, f.prior);
  Eigen::MatrixXd J;
  (void)Evaluate(&problem.problem(), BlocksInOrder(f.window, &problem.arena()), &J);
  J = WithoutFilling(J, f.window, problem.arena());
  std::vector<int> pixels;  // rows of the landmark
  for (int i = 0; i < J.rows(); ++i) {
    if (J.row(i).tail<3>().squaredNorm() > 0.0) pixels.push_back(i);
  }
  const Eigen::MatrixXd J_l = J(pixels, Eigen::all).rightCols<3>();
  const Eigen::RowVectorXd of_pixels =
      (J_l.transpose() * J_l).ldlt().solve(Eigen::MatrixXd(J_l.transpose())).row(2);
  const Eigen::VectorXd to_rho =
      (of_pixels * J(pixels, Eigen::all).leftCols(J.cols() - 3)).transpose();

  WindowLinearizer linearizer(f.options, f.window.reprojection, f.standstill, f.window.layout);
  linearizer.SetWindow(f.window.frames, f.window.rig);
  NormalEquations equations(4, f.window.layout);
  equations.AddPrior(f.prior);
  for (int i = 1; i < 4; ++i) linearizer.AddLink(i, &equations);
  DepthRow depth;
  linearizer.LinearizeDepth(f.window.landmarks.front(), &depth);
  const Eigen::MatrixXd H = equations.Take().H;
  const Eigen::VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::LLT<Eigen::MatrixXd> llt(scale.asDiagonal() * H * scale.asDiagonal());
  const auto variance = [&](const Eigen::VectorXd& row) {
    const Eigen::VectorXd scaled = scale.cwiseProduct(row);
    return scaled.dot(llt.solve(scaled));
  };
  const double expected = of_pixels.squaredNorm() + variance(to_rho);
  EXPECT_GT(variance(depth.row), 0.1);  // poses and calibration matter, or nothing is shown
  EXPECT_NEAR((1.0 + variance(depth.row)) / (depth.diagonal * depth.diagonal), expected,
              1e-6 * expected);
}

TEST(WindowProblem, SolverReachesTheNormalEquationsMinimum) {
  // At the solver's minimum the linearizer's gradient is zero: b against its size at the start.
  Fixture f(3, 0.0);
  f.options.max_iterations = 50;
  f.options.function_tolerance = 1e-14;
  for (const auto method :
       {WindowOptions::TrustRegion::kDogleg, WindowOptions::TrustRegion::kLevenbergMarquardt}) {
    for (const auto solver :
         {WindowOptions::LinearSolver::kDenseSchur, WindowOptions::LinearSolver::kSparseSchur}) {
      RandomWindow window = f.window;
      window.frames[2].at_rest_since_before = false;
      f.options.trust_region = method;
      f.options.linear_solver = solver;
      const WindowPrior prior = StartPrior(
          {.state = {}, .covariance = 1e-4 * Matrix15d::Identity()}, window.rig, window.layout);
      for (WindowFrame& frame : window.frames) {
        frame.pose_in_prior = frame.velocity_in_prior = frame.biases_in_prior = false;
      }
      WindowFrame& first = window.frames[0];
      first.origin = first.state;
      first.pose_in_prior = first.velocity_in_prior = first.biases_in_prior = true;
      const auto gradient = [&]() {
        WindowLinearizer linearizer(f.options, window.reprojection, f.standstill, window.layout);
        linearizer.SetWindow(window.frames, window.rig);
        NormalEquations equations(4, window.layout);
        for (int i = 1; i < 4; ++i) linearizer.AddLink(i, &equations);
        for (const Landmark& landmark : window.landmarks) {
          linearizer.AddLandmark(landmark, 3, &equations);
        }
        InformationForm form = equations.Take();
        linearizer.ShiftToOrigin(prior.rig_origin, &form);
        AddPrior(prior, 4, window.layout, &form);
        Eigen::VectorXd deviation;
        DeviationFromOrigin(window.frames, linearizer.now(), prior.rig_origin, window.layout,
                            &deviation);
        const Eigen::VectorXd at_now = form.b + form.H * deviation;
        return at_now.cwiseQuotient(form.H.diagonal().cwiseSqrt()).norm();
      };
      const double before = gradient();
      WindowProblem problem(f.options, window.reprojection, f.standstill, window.layout);
      problem.Build(window.frames, window.rig, window.landmarks, prior);
      const SolveSummary summary = problem.Solve();
      EXPECT_TRUE(summary.usable);
      EXPECT_LT(summary.final_cost, 1e-3 * summary.initial_cost);
      problem.Store(&window.frames, &window.rig, &window.landmarks);
      EXPECT_LT(gradient(), 1e-6 * before);
    }
  }
}

// Yaw about gravity and the three translations, at a point.
Eigen::MatrixXd UnobservableDirections(const WindowPoint& point, int calibration_size) {
  const int frames = static_cast<int>(point.nav.size());
  Eigen::MatrixXd N = Eigen::MatrixXd::Zero(kFrameSize * frames + calibration_size, 4);
  const Eigen::Vector3d up(0, 0, 1);
  for (int i = 0; i < frames; ++i) {
    const int row = kFrameSize * i;
    N.block<3, 1>(row, 0) = up;
    N.block<3, 1>(row + 3, 0) = up.cross(point.nav[i].p_GB);
    N.block<3, 1>(row + 6, 0) = up.cross(point.nav[i].v_GB);
    N.block<3, 3>(row + 3, 1).setIdentity();
  }
  return N;
}

// How much information there is along the unobservable directions, as a share of the information
// that the components have one by one.
double InformationAlong(const Eigen::MatrixXd& H, const Eigen::MatrixXd& N) {
  double worst = 0.0;
  for (Eigen::Index k = 0; k < N.cols(); ++k) {
    const double alone = N.col(k).cwiseAbs2().dot(H.diagonal());
    worst = std::max(worst, std::abs(N.col(k).dot(H * N.col(k))) / alone);
  }
  return worst;
}

TEST(Prior, FirstEstimatesKeepFourDirectionsUnobservable) {
  for (const bool first_estimates : {true, false}) {
    RandomWindow window(5, 30, 4);
    WindowOptions options;
    options.first_estimates = first_estimates;
    const StandstillOptions standstill;
    WindowLinearizer linearizer(options, window.reprojection, standstill, window.layout);
    linearizer.SetWindow(window.frames, window.rig);
    NormalEquations leaving(5, window.layout);
    linearizer.AddLink(1, &leaving);
    for (const Landmark& landmark : window.landmarks) {
      if (landmark.anchor() == 0) linearizer.AddLandmark(landmark, 3, &leaving);
    }
    const InformationForm form = leaving.Take();
    for (int i = 0; i < 4; ++i) {
      WindowFrame& frame = window.frames[i];
      frame.origin = frame.state;
      frame.pose_in_prior = true;
      frame.velocity_in_prior = frame.biases_in_prior = i <= 1;
    }
    // A prior over all frames with nothing dropped: the quadratic itself.
    const WindowPrior prior = PriorFromInformation(form, 5, window.rig, window.layout);

    // Estimates go on; live factors are added to the prior.
    Random random(5);
    for (WindowFrame& frame : window.frames) {
      frame.state = BoxPlus(frame.state, 0.03 * random.NormalVector<15>());
    }
    linearizer.SetWindow(window.frames, window.rig);
    NormalEquations live(5, window.layout);
    for (int i = 2; i < 5; ++i) linearizer.AddLink(i, &live);
    for (const Landmark& landmark : window.landmarks) {
      if (landmark.anchor() != 0) linearizer.AddLandmark(landmark, 4, &live);
    }
    InformationForm sum = live.Take();
    AddPrior(prior, 5, window.layout, &sum);
    const double share =
        InformationAlong(sum.H, UnobservableDirections(linearizer.first(), window.layout.size()));
    if (first_estimates) {
      EXPECT_LT(share, 1e-12);  // rounding
    } else {
      EXPECT_GT(share, 1e-8);  // what the first estimates are for
    }
  }
}

}  // namespace
}  // namespace duet
