#include "evaluation/holm.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace duet {
namespace {

/// Indices of the numbers among `p_values`, the smallest first.
std::vector<std::size_t> AscendingPValues(const std::vector<double>& p_values) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < p_values.size(); ++i) {
    if (!std::isnan(p_values[i])) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return p_values[a] < p_values[b]; });
  return order;
}

}  // namespace

std::vector<bool> HolmRejections(const std::vector<double>& p_values, double alpha) {
  const std::vector<std::size_t> order = AscendingPValues(p_values);
  std::vector<bool> rejected(p_values.size(), false);
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const auto remaining = static_cast<double>(order.size() - rank);
    if (!(p_values[order[rank]] <= alpha / remaining)) break;
    rejected[order[rank]] = true;
  }
  return rejected;
}

std::vector<double> HolmAdjusted(const std::vector<double>& p_values) {
  const std::vector<std::size_t> order = AscendingPValues(p_values);
  std::vector<double> adjusted = p_values;
  double largest = 0.0;
  for (std::size_t rank = 0; rank < order.size(); ++rank) {
    const auto remaining = static_cast<double>(order.size() - rank);
    largest = std::max(largest, std::min(1.0, remaining * p_values[order[rank]]));
    adjusted[order[rank]] = largest;
  }
  return adjusted;
}

}  // namespace duet
