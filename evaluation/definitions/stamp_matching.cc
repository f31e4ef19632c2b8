#include "evaluation/definitions/stamp_matching.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "evaluation/definitions/nearest_index.h"

namespace duet {
namespace {

std::vector<double> StampsInSeconds(const std::vector<StampedPose>& poses) {
  std::vector<double> seconds;
  seconds.reserve(poses.size());
  for (const StampedPose& pose : poses) seconds.push_back(StampSeconds(pose.timestamp));
  return seconds;
}

}  // namespace

double StampSeconds(Timestamp t) {
  constexpr Timestamp kExact = Timestamp{1} << 53;
  constexpr Timestamp kSecond = 1'000'000'000;
  if (-kExact <= t && t <= kExact) return static_cast<double>(t) / 1e9;
  // Whole seconds and nanoseconds apart are exact, and the sum's last digit is so much coarser than
  // the fraction's that no tie is near: rounded once in effect.
  return static_cast<double>(t / kSecond) + static_cast<double>(t % kSecond) / 1e9;
}

std::vector<StampMatch> MatchLikeEvo(const std::vector<StampedPose>& truth,
                                     const std::vector<StampedPose>& estimate,
                                     double max_difference_s, double offset_s) {
  const bool walk_truth = estimate.size() > truth.size();
  const std::vector<double> shorter = StampsInSeconds(walk_truth ? truth : estimate);
  std::vector<double> longer = StampsInSeconds(walk_truth ? estimate : truth);
  for (double& stamp : longer) stamp += walk_truth ? offset_s : -offset_s;
  std::vector<StampMatch> matches;
  for (int i = 0; i < static_cast<int>(shorter.size()); ++i) {
    const auto difference = [&](double stamp) { return std::abs(stamp - shorter[i]); };
    const int nearest = NearestIndex(longer, 0, shorter[i], difference);
    if (nearest < 0 || difference(longer[nearest]) > max_difference_s) continue;
    matches.push_back(walk_truth ? StampMatch{nearest, i} : StampMatch{i, nearest});
  }
  return matches;
}

std::vector<StampMatch> MatchLikeRpg(const std::vector<StampedPose>& truth,
                                     const std::vector<StampedPose>& estimate,
                                     double max_difference_s, double offset_s) {
  const std::vector<double> of_estimate = StampsInSeconds(estimate);
  std::vector<double> of_truth = StampsInSeconds(truth);
  for (double& stamp : of_truth) stamp += offset_s;
  std::vector<std::tuple<double, int, int>> candidates;  // difference, estimate, truth
  for (int i = 0; i < static_cast<int>(of_estimate.size()); ++i) {
    const double t = of_estimate[i];
    const auto first = std::lower_bound(of_truth.begin(), of_truth.end(),
                                        t - 1.001 * max_difference_s);  // the bound itself: below
    for (auto k = first; k != of_truth.end(); ++k) {
      const double difference = std::abs(t - *k);
      if (difference < max_difference_s) {
        candidates.emplace_back(difference, i, static_cast<int>(k - of_truth.begin()));
      } else if (*k > t) {
        break;
      }
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<int> partner(of_estimate.size(), -1);
  std::vector<bool> taken(of_truth.size(), false);
  for (const auto& [difference, i, k] : candidates) {
    if (partner[i] >= 0 || taken[k]) continue;
    partner[i] = k;
    taken[k] = true;
  }
  std::vector<StampMatch> matches;
  for (int i = 0; i < static_cast<int>(partner.size()); ++i) {
    if (partner[i] >= 0) matches.push_back({i, partner[i]});
  }
  return matches;
}

std::vector<StampMatch> MatchLikeOvEval(const std::vector<StampedPose>& truth,
                                        const std::vector<StampedPose>& estimate,
                                        double max_difference_s, double offset_s) {
  const std::vector<double> of_estimate = StampsInSeconds(estimate);
  const std::vector<double> of_truth = StampsInSeconds(truth);
  std::vector<StampMatch> matches;
  int next = 0;
  for (int i = 0; i < static_cast<int>(of_estimate.size()); ++i) {
    const double t = of_estimate[i] + offset_s;
    const auto known = [&] { return next < static_cast<int>(of_truth.size()); };
    const auto difference = [&] { return std::abs(of_truth[next] - t); };
    while (known() && of_truth[next] < t && difference() > max_difference_s) ++next;
    double best = max_difference_s;
    int found = -1;
    for (; known() && difference() < best; ++next) {
      best = difference();
      found = next;
    }
    if (found >= 0) matches.push_back({i, found});
  }
  return matches;
}

}  // namespace duet
