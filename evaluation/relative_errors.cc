#include "evaluation/relative_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "common/geometry/angle.h"
#include "common/geometry/so3.h"
#include "common/support/logging.h"
#include "evaluation/alignment.h"

namespace duet {
namespace {

constexpr std::size_t kAutomaticLengths = 4;

struct Segment {
  const PosePair* start;
  const PosePair* end;
};

struct SegmentSamples {
  std::vector<double> translation_m, translation_percent, rotation_deg, yaw_deg, tilt_deg;
};

std::vector<double> AutomaticLengths(double way_m) {
  std::vector<double> lengths;
  for (double decade = 0.1; decade <= 0.5 * way_m; decade *= 10.0) {
    for (const double factor : {1.0, 2.0, 5.0}) {
      const double length_m = decade * factor;
      if (length_m >= 0.5 && length_m <= 0.5 * way_m) lengths.push_back(length_m);
    }
  }
  if (lengths.size() > kAutomaticLengths) lengths.erase(lengths.begin(), lengths.end() - 4);
  return lengths;
}

const PosePair* NearestPair(const std::vector<PosePair>& pairs, Timestamp t, double reach_s) {
  const auto after =
      std::lower_bound(pairs.begin(), pairs.end(), t,
                       [](const PosePair& pair, Timestamp at) { return pair.timestamp < at; });
  const PosePair* nearest = after != pairs.end() ? &*after : nullptr;
  if (after != pairs.begin()) {
    const PosePair* before = &*std::prev(after);
    if (nearest == nullptr || t - before->timestamp <= nearest->timestamp - t) nearest = before;
  }
  if (nearest == nullptr || std::abs(SecondsBetween(nearest->timestamp, t)) > reach_s) {
    return nullptr;
  }
  return nearest;
}

Eigen::Quaterniond ErrorRotation(const PosePair& pair) {
  return pair.T_GB_true.R * pair.T_EB.R.conjugate();
}

void AddSegment(const Segment& segment, const TravelledDistance& way, SegmentSamples* samples) {
  const Eigen::Quaterniond E_s = ErrorRotation(*segment.start);
  const Eigen::Quaterniond E_e = ErrorRotation(*segment.end);
  const Eigen::Vector3d moved_true = segment.end->T_GB_true.p - segment.start->T_GB_true.p;
  const Eigen::Vector3d moved_est = segment.end->T_EB.p - segment.start->T_EB.p;
  const double error_m = (moved_true - E_s * moved_est).norm();
  const double way_m = way.At(segment.end->timestamp) - way.At(segment.start->timestamp);
  const Eigen::Quaterniond rotation = E_e * E_s.conjugate();
  samples->translation_m.push_back(error_m);
  if (way_m > 0.0) samples->translation_percent.push_back(100.0 * error_m / way_m);
  samples->rotation_deg.push_back(Log(rotation).norm() * kDegreesPerRadian);
  samples->yaw_deg.push_back(std::abs(YawOf(rotation)) * kDegreesPerRadian);
  samples->tilt_deg.push_back(TiltOf(rotation) * kDegreesPerRadian);
}

RelativeErrors SummarizeSegments(double length_m, SegmentSamples samples) {
  RelativeErrors errors;
  errors.length_m = length_m;
  errors.segments = static_cast<int>(samples.translation_m.size());
  errors.translation_m = Summarize(std::move(samples.translation_m));
  errors.translation_percent = Summarize(std::move(samples.translation_percent));
  errors.rotation_deg = Summarize(std::move(samples.rotation_deg));
  errors.yaw_deg = Summarize(std::move(samples.yaw_deg));
  errors.tilt_deg = Summarize(std::move(samples.tilt_deg));
  return errors;
}

/// The spans' intersection, of the estimators that have one; false where it is empty.
bool IntersectSpans(std::span<const std::vector<PosePair>> estimators, Timestamp* start,
                    Timestamp* end) {
  *start = std::numeric_limits<Timestamp>::min();
  *end = std::numeric_limits<Timestamp>::max();
  bool any = false;
  for (const std::vector<PosePair>& pairs : estimators) {
    if (pairs.empty()) continue;
    any = true;
    *start = std::max(*start, pairs.front().timestamp);
    *end = std::min(*end, pairs.back().timestamp);
  }
  if (any && *start < *end) return true;
  *start = *end = 0;
  return false;
}

/// The segment as each estimator has it; empty entries for those without any pair; nothing where
/// one lacks a pose near an end.
std::optional<std::vector<std::optional<Segment>>> SnapToAll(
    std::span<const std::vector<PosePair>> estimators, Timestamp start, Timestamp end,
    double reach_s) {
  std::vector<std::optional<Segment>> segments;
  for (const std::vector<PosePair>& pairs : estimators) {
    if (pairs.empty()) {
      segments.emplace_back();
      continue;
    }
    const Segment segment{NearestPair(pairs, start, reach_s), NearestPair(pairs, end, reach_s)};
    if (segment.start == nullptr || segment.end == nullptr ||
        segment.start->timestamp >= segment.end->timestamp) {
      return std::nullopt;
    }
    segments.emplace_back(segment);
  }
  return segments;
}

}  // namespace

TravelledDistance::TravelledDistance(const std::vector<StampedPose>& truth, double step_s) {
  const StampedPose* last = nullptr;
  for (const StampedPose& pose : truth) {
    if (last != nullptr && SecondsBetween(last->timestamp, pose.timestamp) < step_s) continue;
    const double moved_m = last == nullptr ? 0.0 : (pose.T_GB.p - last->T_GB.p).norm();
    nodes_.push_back({pose.timestamp, total_m() + moved_m});
    last = &pose;
  }
}

double TravelledDistance::At(Timestamp t) const {
  if (nodes_.empty() || t <= nodes_.front().timestamp) return 0.0;
  if (t >= nodes_.back().timestamp) return nodes_.back().distance_m;
  const auto after = std::lower_bound(nodes_.begin(), nodes_.end(), t,
                                      [](const Node& n, Timestamp at) { return n.timestamp < at; });
  const Node& a = *std::prev(after);
  const double share =
      SecondsBetween(a.timestamp, t) / SecondsBetween(a.timestamp, after->timestamp);
  return std::lerp(a.distance_m, after->distance_m, share);
}

std::optional<Timestamp> TravelledDistance::WhenReached(double distance_m) const {
  const auto after =
      std::lower_bound(nodes_.begin(), nodes_.end(), distance_m,
                       [](const Node& n, double distance) { return n.distance_m < distance; });
  if (after == nodes_.end() || distance_m < 0.0) return std::nullopt;
  if (after == nodes_.begin()) return after->timestamp;
  const Node& a = *std::prev(after);
  const double share = (distance_m - a.distance_m) / (after->distance_m - a.distance_m);
  return a.timestamp + ToNanoseconds(share * SecondsBetween(a.timestamp, after->timestamp));
}

RelativeErrorReport ComputeRelativeErrors(const std::vector<StampedPose>& truth,
                                          std::span<const std::vector<PosePair>> estimators,
                                          const RelativeErrorOptions& options) {
  RelativeErrorReport report;
  report.of_estimator.resize(estimators.size());
  if (!IntersectSpans(estimators, &report.start, &report.end)) return report;
  const TravelledDistance way(truth, options.start_step_s);
  report.way_m = way.At(report.end) - way.At(report.start);
  const std::vector<double> lengths =
      options.lengths_m.empty() ? AutomaticLengths(report.way_m) : options.lengths_m;
  for (const double length_m : lengths) {
    CHECK_GT(length_m, 0.0);
    std::vector<SegmentSamples> samples(estimators.size());
    for (const TravelledDistance::Node& node : way.nodes()) {
      if (node.timestamp < report.start) continue;
      const auto end = way.WhenReached(node.distance_m + length_m);
      if (!end || *end > report.end) break;
      const auto segments = SnapToAll(estimators, node.timestamp, *end, options.max_snap_s);
      report.dropped += segments ? 0 : 1;
      for (std::size_t i = 0; segments && i < estimators.size(); ++i) {
        if ((*segments)[i]) AddSegment(*(*segments)[i], way, &samples[i]);
      }
    }
    for (std::size_t i = 0; i < estimators.size(); ++i) {
      report.of_estimator[i].push_back(SummarizeSegments(length_m, std::move(samples[i])));
    }
  }
  return report;
}

}  // namespace duet
