#pragma once

#include <vector>

namespace duet {

/// Holm's step-down correction (Holm, "A simple sequentially rejective multiple test procedure",
/// 1979): which of the hypotheses are rejected so that the probability of any false rejection is at
/// most `alpha`, whatever the dependence between them. A p-value that is not a number is rejected
/// never.
[[nodiscard]] std::vector<bool> HolmRejections(const std::vector<double>& p_values, double alpha);

/// The smallest alpha at which HolmRejections rejects each: max over smaller or equal p_(j) of
/// min(1, (n - j) p_(j)), j counted from 0 (R's p.adjust). NaN, for a test that was not made, stays
/// NaN and does not count to n.
[[nodiscard]] std::vector<double> HolmAdjusted(const std::vector<double>& p_values);

}  // namespace duet
