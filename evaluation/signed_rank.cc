#include "evaluation/signed_rank.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "common/support/logging.h"

namespace duet {
namespace {

/// Twice the ranks of magnitudes (mean ranks of equal ones are halves), and their signs.
struct DoubledRank {
  int rank = 0;
  int sign = 0;
};

std::vector<DoubledRank> DoubledRanks(std::vector<double> differences) {
  std::sort(differences.begin(), differences.end(),
            [](double a, double b) { return std::abs(a) < std::abs(b); });
  std::vector<DoubledRank> ranks(differences.size());
  for (std::size_t first = 0; first < differences.size();) {
    std::size_t end = first;
    while (end < differences.size() && std::abs(differences[end]) == std::abs(differences[first])) {
      ++end;
    }
    for (std::size_t i = first; i < end; ++i) {
      const double d = differences[i];
      // Ranks first + 1 ... end: twice their mean.
      ranks[i] = {static_cast<int>(first + 1 + end), d > 0.0 ? 1 : (d < 0.0 ? -1 : 0)};
    }
    first = end;
  }
  return ranks;
}

/// P(W+ <= observed) where each rank is in the sum with probability 1/2, by counting the subsets of
/// each sum: exact for as long as 2^n is an exact double.
double ExactLowerTail(const std::vector<DoubledRank>& ranks, int doubled_sum) {
  int total = 0;
  for (const DoubledRank& rank : ranks) total += rank.rank;
  std::vector<double> subsets(static_cast<std::size_t>(total) + 1, 0.0);
  subsets[0] = 1.0;
  int reached = 0;
  for (const DoubledRank& rank : ranks) {
    reached += rank.rank;
    for (int sum = reached; sum >= rank.rank; --sum) {
      subsets[static_cast<std::size_t>(sum)] += subsets[static_cast<std::size_t>(sum - rank.rank)];
    }
  }
  double below = 0.0;
  for (int sum = 0; sum <= doubled_sum; ++sum) below += subsets[static_cast<std::size_t>(sum)];
  return std::ldexp(below, -static_cast<int>(ranks.size()));
}

double NormalTwoSided(const std::vector<DoubledRank>& ranks, double w_plus) {
  double mean = 0.0;
  double variance = 0.0;
  for (const DoubledRank& rank : ranks) {
    mean += 0.25 * rank.rank;
    variance += rank.rank * rank.rank / 16.0;
  }
  const double distance = std::max(0.0, std::abs(w_plus - mean) - 0.5);
  return std::min(1.0, std::erfc(distance / std::sqrt(2.0 * variance)));
}

/// How many of the means of pairs of `sorted` are at most `t`.
std::size_t CountMeansUpTo(std::span<const double> sorted, double t) {
  std::size_t count = 0;
  std::size_t end = sorted.size();  // of the j whose mean with i is at most t
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    while (end > i && 0.5 * (sorted[i] + sorted[end - 1]) > t) --end;
    if (end <= i) break;
    count += end - i;
  }
  return count;
}

/// The means in (low, high], sorted.
std::vector<double> MeansBetween(std::span<const double> sorted, double low, double high) {
  std::vector<double> means;
  std::size_t end = sorted.size();    // of the j whose mean with i is at most high
  std::size_t begin = sorted.size();  // of those whose mean is above low
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    while (end > 0 && 0.5 * (sorted[i] + sorted[end - 1]) > high) --end;
    while (begin > 0 && 0.5 * (sorted[i] + sorted[begin - 1]) > low) --begin;
    for (std::size_t j = std::max(i, begin); j < end; ++j) {
      means.push_back(0.5 * (sorted[i] + sorted[j]));
    }
  }
  std::sort(means.begin(), means.end());
  return means;
}

/// The mean of the k-th and the l-th smallest mean, k <= l <= k + 1 counted from 1: bisection until
/// few are left, without ever holding all n (n + 1) / 2 of them.
double MeanOfRanks(std::span<const double> sorted, std::size_t k, std::size_t l) {
  // Fewer than k means are at most `low`, at least l are at most `high`.
  double low = std::nextafter(sorted.front(), -std::numeric_limits<double>::infinity());
  double high = sorted.back();
  std::size_t below = 0;
  std::size_t up_to = sorted.size() * (sorted.size() + 1) / 2;
  while (up_to - below > 2 * sorted.size() + 8) {
    const double middle = std::midpoint(low, high);
    if (!(low < middle && middle < high)) return high;  // all of these are equal
    const std::size_t count = CountMeansUpTo(sorted, middle);
    if (count < k) {
      low = middle;
      below = count;
    } else if (count >= l) {
      high = middle;
      up_to = count;
    } else {
      break;  // the two are on either side of the middle
    }
  }
  const std::vector<double> means = MeansBetween(sorted, low, high);
  return std::midpoint(means[k - 1 - below], means[l - 1 - below]);
}

}  // namespace

SignedRank SignedRankTest(std::span<const double> differences, const SignedRankOptions& options) {
  std::vector<double> ranked;
  SignedRank result;
  for (const double d : differences) {
    CHECK(!std::isnan(d));
    if (d == 0.0) ++result.zeros;
    if (d != 0.0 || options.zeros == ZeroDifferences::kPratt) ranked.push_back(d);
  }
  std::vector<DoubledRank> ranks = DoubledRanks(std::move(ranked));
  std::erase_if(ranks, [](const DoubledRank& rank) { return rank.sign == 0; });
  result.count = static_cast<int>(ranks.size());
  int doubled_plus = 0;
  int doubled_minus = 0;
  for (const DoubledRank& rank : ranks) {
    (rank.sign > 0 ? doubled_plus : doubled_minus) += rank.rank;
  }
  result.w_plus = 0.5 * doubled_plus;
  result.w_minus = 0.5 * doubled_minus;
  if (ranks.empty()) return result;
  result.exact = result.count <= std::min(options.exact_up_to, 50);
  result.p_value =
      result.exact
          ? std::min(1.0, 2.0 * ExactLowerTail(ranks, std::min(doubled_plus, doubled_minus)))
          : NormalTwoSided(ranks, result.w_plus);
  return result;
}

double HodgesLehmann(std::span<const double> values) {
  CHECK(!values.empty());
  std::vector<double> sorted(values.begin(), values.end());
  std::sort(sorted.begin(), sorted.end());
  CHECK(std::isfinite(sorted.front()) && std::isfinite(sorted.back()));
  const std::size_t means = sorted.size() * (sorted.size() + 1) / 2;
  return MeanOfRanks(sorted, (means + 1) / 2, means / 2 + 1);
}

}  // namespace duet
