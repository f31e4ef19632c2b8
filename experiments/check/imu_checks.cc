#include "experiments/check/imu_checks.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "common/geometry/so3.h"
#include "experiments/check/stamp_checks.h"

namespace duet {
namespace {

using Eigen::Vector3d;

constexpr double kRestWindow_s = 0.5;
constexpr const char* kAxes = "xyz";

// Mean and variance of a run of samples.
struct Moments {
  Vector3d mean = Vector3d::Zero();
  Vector3d variance = Vector3d::Zero();
};
Moments MomentsOf(const std::vector<ImuSample>& imu, std::size_t begin, std::size_t end,
                  Vector3d ImuSample::*member) {
  Moments m;
  const double count = static_cast<double>(end - begin);
  for (std::size_t i = begin; i < end; ++i) m.mean += imu[i].*member / count;
  for (std::size_t i = begin; i < end; ++i) {
    m.variance += (imu[i].*member - m.mean).cwiseAbs2() / (count - 1.0);
  }
  return m;
}

// The halves' means agree within what their scatter allows. Vibration is correlated over a few
// samples, hence the floors.
bool HalvesAgree(const std::vector<ImuSample>& imu, std::size_t begin, std::size_t end,
                 Vector3d ImuSample::*member, double floor) {
  const std::size_t middle = (begin + end) / 2;
  const Moments a = MomentsOf(imu, begin, middle, member);
  const Moments b = MomentsOf(imu, middle, end, member);
  const double count = static_cast<double>(middle - begin);
  const Vector3d sigma = ((a.variance + b.variance) / count).cwiseSqrt();
  return ((a.mean - b.mean).cwiseAbs().array() < 4.0 * sigma.array() + floor).all();
}

bool AtRestByImu(const std::vector<ImuSample>& imu, std::size_t begin, std::size_t end,
                 double gravity) {
  if (end - begin < 20) return false;
  const Moments force = MomentsOf(imu, begin, end, &ImuSample::a_m);
  return std::abs(force.mean.norm() - gravity) < 0.5 &&
         HalvesAgree(imu, begin, end, &ImuSample::omega_m, 0.005) &&
         HalvesAgree(imu, begin, end, &ImuSample::a_m, 0.03);
}

void AddSpan(Timestamp start, Timestamp end, std::vector<RestSpan>* spans) {
  if (!spans->empty() && start <= spans->back().end) {
    spans->back().end = std::max(spans->back().end, end);
  } else {
    spans->push_back({start, end});
  }
}

std::vector<RestSpan> RestByPoses(const std::vector<StampedPose>& truth) {
  std::vector<RestSpan> spans;
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= truth.size(); ++i) {
    const bool still = i < truth.size() && (truth[i].T_GB.p - truth[begin].T_GB.p).norm() < 5e-3 &&
                       truth[i].T_GB.R.angularDistance(truth[begin].T_GB.R) < 0.0087;
    if (still) continue;
    if (SecondsBetween(truth[begin].timestamp, truth[i - 1].timestamp) >= kRestWindow_s) {
      spans.push_back({truth[begin].timestamp, truth[i - 1].timestamp});
      begin = i;
    } else {
      ++begin;
      // Poses between are tried as the start in turn; i goes back to the next one.
      i = begin;
    }
  }
  return spans;
}

std::vector<RestSpan> RestByImu(const std::vector<ImuSample>& imu, double gravity) {
  std::vector<RestSpan> spans;
  const Timestamp window = ToNanoseconds(kRestWindow_s);
  for (std::size_t begin = 0; begin < imu.size();) {
    std::size_t end = begin;
    while (end < imu.size() && imu[end].timestamp - imu[begin].timestamp <= window) ++end;
    if (end == imu.size()) break;
    if (AtRestByImu(imu, begin, end, gravity)) {
      AddSpan(imu[begin].timestamp, imu[end - 1].timestamp, &spans);
    }
    begin = (begin + end) / 2;
  }
  return spans;
}

// A reading that stays at the extreme of its axis, which lies far out in its own steps.
void CheckSaturation(const std::vector<ImuSample>& imu, Vector3d ImuSample::*member,
                     const char* name, Findings* findings) {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> sizes;
    for (const ImuSample& sample : imu) sizes.push_back(std::abs((sample.*member)[axis]));
    const double largest = *std::max_element(sizes.begin(), sizes.end());
    int at_largest = 0;
    int run = 0;
    int longest_run = 0;
    for (const double size : sizes) {
      run = size >= largest * (1.0 - 1e-9) ? run + 1 : 0;
      at_largest += run > 0 ? 1 : 0;
      longest_run = std::max(longest_run, run);
    }
    std::sort(sizes.begin(), sizes.end());
    double step = largest;
    for (std::size_t i = 1; i < sizes.size(); ++i) {
      const double difference = sizes[i] - sizes[i - 1];
      if (difference > 1e-9 * largest) step = std::min(step, difference);
    }
    // Three in a row at one value happens at rest with a coarse step, not far from it.
    if (longest_run < 3 || largest < 100.0 * step) continue;
    findings->push_back(
        {Severity::kWarning,
         std::string("imu.saturation.") + name + "." + kAxes[axis],
         Sentence("%s %c stays at its extreme %.4g for up to %d samples (%d in all): it is "
                  "saturated",
                  name, kAxes[axis], largest, longest_run, at_largest),
         "The motion there is lost; choose a larger range, and leave those seconds out.",
         {{"extreme", largest}, {"samples", static_cast<double>(at_largest)}}});
  }
}

void CheckDensities(const ImuNoise& noise, Findings* findings) {
  struct Range {
    const char* name;
    double value;
    double low;
    double high;
  };
  // From navigation grade to the cheapest telephone, with room.
  for (const Range& range :
       {Range{"gyroscope_noise_density", noise.gyroscope_density, 1e-7, 1e-2},
        Range{"accelerometer_noise_density", noise.accelerometer_density, 1e-6, 1e-1},
        Range{"gyroscope_random_walk", noise.gyroscope_random_walk, 1e-9, 1e-2},
        Range{"accelerometer_random_walk", noise.accelerometer_random_walk, 1e-8, 1e-1}}) {
    if (range.value >= range.low && range.value <= range.high) continue;
    findings->push_back({Severity::kWarning,
                         std::string("imu.") + range.name,
                         Sentence("%s is %g; IMUs lie between %g and %g", range.name, range.value,
                                  range.low, range.high),
                         "Densities are in rad/s/sqrt(Hz), m/s^2/sqrt(Hz), rad/s^2/sqrt(Hz) and "
                         "m/s^3/sqrt(Hz): check units (degrees, hours, milli-g).",
                         {{"told", range.value}}});
  }
}

void CheckNoiseAtRest(const std::vector<ImuSample>& imu, const ImuSensor& sensor,
                      const RestSpan& span, Findings* findings) {
  // Setting off and coming to rest still belong to a span: its ends are left out.
  const Timestamp margin = (span.end - span.start) / 5;
  const auto before = [](const ImuSample& sample, Timestamp t) { return sample.timestamp < t; };
  const auto begin = static_cast<std::size_t>(
      std::lower_bound(imu.begin(), imu.end(), span.start + margin, before) - imu.begin());
  const auto end = static_cast<std::size_t>(
      std::lower_bound(imu.begin(), imu.end(), span.end - margin, before) - imu.begin());
  if (end < begin + 20) return;
  const double rate_hz = static_cast<double>(end - 1 - begin) /
                         SecondsBetween(imu[begin].timestamp, imu[end - 1].timestamp);
  const Moments gyro = MomentsOf(imu, begin, end, &ImuSample::omega_m);
  const Moments force = MomentsOf(imu, begin, end, &ImuSample::a_m);
  const double gyro_sigma = std::sqrt(gyro.variance.maxCoeff());
  const double force_sigma = std::sqrt(force.variance.maxCoeff());
  const double gyro_ratio = gyro_sigma / (sensor.noise.gyroscope_density * std::sqrt(rate_hz));
  const double force_ratio =
      force_sigma / (sensor.noise.accelerometer_density * std::sqrt(rate_hz));
  const bool vibrates = gyro_ratio > 5.0 || force_ratio > 5.0;
  const bool too_quiet = gyro_ratio < 0.2 || force_ratio < 0.2;
  findings->push_back(
      {vibrates || too_quiet ? Severity::kWarning : Severity::kInfo,
       "imu.noise_at_rest",
       Sentence("at rest the gyroscope scatters by %.3g rad/s and the accelerometer by %.3g m/s^2 "
                "(worst axes): %.1f and %.1f times what the told densities say at %.0f Hz",
                gyro_sigma, force_sigma, gyro_ratio, force_ratio, rate_hz),
       vibrates    ? "Something vibrates (motors?), or the densities are too small: judge rest by "
                     "means, and do not take the densities for what this motion does."
       : too_quiet ? "The told densities are far too large, or the readings are filtered."
                   : "",
       {{"gyroscope_sigma_rad_per_s", gyro_sigma},
        {"accelerometer_sigma_m_per_s2", force_sigma},
        {"gyroscope_ratio", gyro_ratio},
        {"accelerometer_ratio", force_ratio}}});
  const double size = force.mean.norm();
  if (std::abs(size - sensor.gravity) > 0.3) {
    findings->push_back(
        {std::abs(size - sensor.gravity) > 3.0 ? Severity::kError : Severity::kWarning,
         "imu.gravity_at_rest",
         Sentence("at rest the specific force is %.3f m/s^2, gravity is told as %.3f", size,
                  sensor.gravity),
         "A bias of that size, a wrong scale, or units (g instead of m/s^2).",
         {{"specific_force_m_per_s2", size}}});
  }
  if (gyro.mean.norm() > 0.3) {
    findings->push_back({Severity::kWarning,
                         "imu.gyro_at_rest",
                         Sentence("at rest the gyroscope reads %.3f rad/s", gyro.mean.norm()),
                         "A very large bias, or units (deg/s instead of rad/s).",
                         {{"rate_rad_per_s", gyro.mean.norm()}}});
  }
}

}  // namespace

std::vector<RestSpan> FindRest(const std::vector<ImuSample>& imu,
                               const std::vector<StampedPose>& truth, double gravity_m_per_s2) {
  return truth.size() > 2 ? RestByPoses(truth) : RestByImu(imu, gravity_m_per_s2);
}

Findings CheckImu(const std::vector<ImuSample>& imu, const ImuSensor& sensor,
                  const std::vector<RestSpan>& rest, bool rest_from_truth) {
  Findings findings;
  if (imu.size() < 2) return findings;
  CheckDensities(sensor.noise, &findings);
  CheckSaturation(imu, &ImuSample::omega_m, "gyroscope", &findings);
  CheckSaturation(imu, &ImuSample::a_m, "accelerometer", &findings);
  double total_s = 0.0;
  const RestSpan* longest = nullptr;
  for (const RestSpan& span : rest) {
    const double length_s = SecondsBetween(span.start, span.end);
    total_s += length_s;
    if (longest == nullptr || length_s > SecondsBetween(longest->start, longest->end)) {
      longest = &span;
    }
  }
  const char* source = rest_from_truth ? "the truth" : "the IMU alone";
  if (longest == nullptr) {
    findings.push_back({Severity::kInfo,
                        "rest.none",
                        Sentence("never at rest for half a second (by %s)", source),
                        "A start at rest is not possible: start from the truth (--init "
                        "groundtruth).",
                        {{"rest_s", 0.0}}});
    return findings;
  }
  findings.push_back(
      {Severity::kInfo,
       "rest",
       Sentence("at rest for %.2f s in all (by %s), the longest from %s on for %.2f s", total_s,
                source, SinceOrigin(longest->start, imu.front().timestamp).c_str(),
                SecondsBetween(longest->start, longest->end)),
       "",
       {{"rest_s", total_s},
        {"longest_s", SecondsBetween(longest->start, longest->end)},
        {"longest_from_s", SecondsBetween(imu.front().timestamp, longest->start)}}});
  CheckNoiseAtRest(imu, sensor, *longest, &findings);
  return findings;
}

}  // namespace duet
