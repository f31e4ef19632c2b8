#include <gtest/gtest.h>
#include <cstdio>
#include <Eigen/Eigenvalues>
#include "experiments/observability/observability_report.h"
#include "test/experiments/observability/small_simulation.h"
namespace duet {
namespace {
CalibrationPriors Some(const std::string& what) {
  CalibrationPriors p;
  p.imu_frame = ImuFrame::kGyroscope;
  if (what == "spatiotemporal") p.p_CB.estimated = p.R_CB.estimated = p.t_d.estimated = true;
  if (what == "spatial") p.p_CB.estimated = p.R_CB.estimated = true;
  if (what == "imu") { p.imu_frame = ImuFrame::kCamera; p.T_g.estimated = p.T_s.estimated = p.T_a.estimated = true; }
  if (what == "camera") p.intrinsics.estimated = p.distortion.estimated = true;
  if (what == "all") return AllEstimated();
  if (what == "times") p.t_d.estimated = p.t_r.estimated = true;
  return p;
}
std::string J(const std::vector<std::string>& v){ std::string s; for (auto& x: v) s += x + " "; return s; }
TEST(Degenerate, Print) {
  for (const char* name : {"lissajous", "standstill", "pure_rotation", "one_axis_rotation", "constant_rate", "straight_line", "constant_acceleration", "planar_driving", "circle"}) {
   for (const char* what : {"all", "spatiotemporal", "imu", "camera", "times"}) {
    SimulationOptions options = ObservedSimulation::Options(16.0);
    options.trajectory = name; options.t_r_s = 0.02;
    const ObservedSimulation simulation(options, MakeTrajectory(name, 16.4, 0), Some(what));
    const FisherInformation information(simulation.motion);
    const auto r = AnalyzeObservability(information, {});
    std::printf("%-22s %-15s | %s\n", name, what, J(r.Named(ObservabilityVerdict::kUnobservable)).c_str());
    { const Eigen::VectorXd w = information.layout().PriorSigmas().cwiseInverse();
      Eigen::MatrixXd M = w.asDiagonal()*r.wide.CalibrationCovariance()*w.asDiagonal();
      Eigen::VectorXd e = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(M).eigenvalues().reverse().cwiseSqrt()/kWidePriors;
      std::printf("   eig:"); for (int i=0;i<e.size() && e[i]>2e-3;++i) std::printf(" %.3g", e[i]); std::printf("\n"); }
    for (const auto& d : r.unobservable) std::printf("      %.2f %s\n", d.ratio, DirectionText(d, r.Names()).c_str());
   }
  }
}
}  // namespace
}  // namespace duet
