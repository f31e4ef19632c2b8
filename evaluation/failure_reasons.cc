#include "evaluation/failure_reasons.h"

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <utility>

#include "common/support/numeric_text.h"

namespace duet {
namespace {

/// A reason as words with numbers between them: one more piece of text than there are numbers.
struct Reason {
  std::vector<std::string> text;
  std::vector<std::string> numbers;
};

bool IsDigit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// The length of the number that begins at `at`; 0 where none does. Digits within a word (cam0,
/// T_CB2) are the word's.
std::size_t NumberAt(const std::string& reason, std::size_t at) {
  const char before = at == 0 ? ' ' : reason[at - 1];
  if (std::isalnum(static_cast<unsigned char>(before)) != 0 || before == '_') return 0;
  std::size_t end = at + (reason[at] == '-' ? 1 : 0);
  if (end >= reason.size() || !IsDigit(reason[end])) return 0;
  while (end < reason.size() &&
         (IsDigit(reason[end]) ||
          (reason[end] == '.' && end + 1 < reason.size() && IsDigit(reason[end + 1])))) {
    ++end;
  }
  if (end < reason.size() && (reason[end] == 'e' || reason[end] == 'E')) {
    std::size_t exponent = end + 1;
    if (exponent < reason.size() && (reason[exponent] == '+' || reason[exponent] == '-')) {
      ++exponent;
    }
    if (exponent < reason.size() && IsDigit(reason[exponent])) {
      while (exponent < reason.size() && IsDigit(reason[exponent])) ++exponent;
      end = exponent;
    }
  }
  return end - at;
}

Reason Split(const std::string& reason) {
  Reason split{{""}, {}};
  for (std::size_t at = 0; at < reason.size();) {
    const std::size_t length = NumberAt(reason, at);
    if (length == 0) {
      split.text.back() += reason[at++];
      continue;
    }
    split.numbers.push_back(reason.substr(at, length));
    split.text.emplace_back();
    at += length;
  }
  return split;
}

/// "1.6", or "1.6 to 3.2" where they differ.
std::string RangeOf(const std::vector<Reason>& reasons, std::size_t number) {
  const auto less = [&](const Reason& a, const Reason& b) {
    return ParseDouble(a.numbers[number]).value_or(0.0) <
           ParseDouble(b.numbers[number]).value_or(0.0);
  };
  const auto [low, high] = std::minmax_element(reasons.begin(), reasons.end(), less);
  const std::string& lowest = low->numbers[number];
  const std::string& highest = high->numbers[number];
  return less(*low, *high) ? lowest + " to " + highest : lowest;
}

}  // namespace

std::string CommonestReason(const std::vector<std::string>& reasons) {
  std::vector<std::vector<Reason>> kinds;
  for (const std::string& reason : reasons) {
    Reason split = Split(reason);
    const auto found = std::find_if(kinds.begin(), kinds.end(), [&](const auto& kind) {
      return kind.front().text == split.text;
    });
    if (found == kinds.end()) {
      kinds.push_back({std::move(split)});
    } else {
      found->push_back(std::move(split));
    }
  }
  if (kinds.empty()) return "";
  const std::vector<Reason>& most = *std::max_element(
      kinds.begin(), kinds.end(), [](const auto& a, const auto& b) { return a.size() < b.size(); });
  std::string text = most.front().text.front();
  for (std::size_t n = 0; n < most.front().numbers.size(); ++n) {
    text += RangeOf(most, n) + most.front().text[n + 1];
  }
  return text + (kinds.size() > 1 ? " (" + std::to_string(most.size()) + ")" : "");
}

}  // namespace duet
