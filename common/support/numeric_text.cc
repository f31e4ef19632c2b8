#include "common/support/numeric_text.h"

#include <array>
#include <charconv>
#include <limits>
#include <system_error>

namespace duet {
namespace {

template <class Number>
std::optional<Number> ParseWhole(std::string_view text) {
  Number value{};
  const char* end = text.data() + text.size();
  const auto [stopped, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stopped != end) return std::nullopt;
  return value;
}

template <class Number>
void AppendShortest(Number value, std::string* text) {
  std::array<char, 64> buffer;
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  text->append(buffer.data(), end);
}

bool IsDigit(char c) { return c >= '0' && c <= '9'; }

/// A decimal number cut into its parts: digits without a point, times 10^exponent.
struct Decimal {
  bool negative = false;
  std::string digits;
  std::int64_t exponent = 0;
};

std::optional<Decimal> SplitDecimal(std::string_view text) {
  Decimal number;
  std::size_t i = 0;
  if (i < text.size() && text[i] == '-') {
    number.negative = true;
    ++i;
  }
  bool after_point = false;
  for (; i < text.size() && (IsDigit(text[i]) || (text[i] == '.' && !after_point)); ++i) {
    if (text[i] == '.') {
      after_point = true;
      continue;
    }
    number.digits.push_back(text[i]);
    if (after_point) --number.exponent;
  }
  if (number.digits.empty()) return std::nullopt;
  if (i == text.size()) return number;
  if (text[i] != 'e' && text[i] != 'E') return std::nullopt;
  std::string_view exponent_text = text.substr(i + 1);
  if (exponent_text.starts_with('+')) {
    exponent_text.remove_prefix(1);
    if (exponent_text.starts_with('-')) return std::nullopt;
  }
  const std::optional<std::int64_t> exponent = ParseInt64(exponent_text);
  // Beyond any exponent that could leave a number of nanoseconds in 64 bits.
  if (!exponent || *exponent > 1000 || *exponent < -1000) return std::nullopt;
  number.exponent += *exponent;
  return number;
}

}  // namespace

std::optional<double> ParseDouble(std::string_view text) { return ParseWhole<double>(text); }
std::optional<float> ParseFloat(std::string_view text) { return ParseWhole<float>(text); }
std::optional<std::int64_t> ParseInt64(std::string_view text) {
  return ParseWhole<std::int64_t>(text);
}
std::optional<std::uint64_t> ParseUint64(std::string_view text) {
  return ParseWhole<std::uint64_t>(text);
}

std::optional<Timestamp> ParseSeconds(std::string_view text) {
  std::optional<Decimal> number = SplitDecimal(text);
  if (!number) return std::nullopt;
  const std::size_t first = number->digits.find_first_not_of('0');
  if (first == std::string::npos) return 0;
  // The number of digits of the whole number of nanoseconds; the rest is rounded away.
  const std::int64_t digit_count = static_cast<std::int64_t>(number->digits.size() - first);
  const std::int64_t whole = digit_count + number->exponent + 9;
  constexpr std::int64_t kMostDigits = 19;
  if (whole > kMostDigits) return std::nullopt;
  if (whole < 0) return 0;
  std::uint64_t nanoseconds = 0;
  for (std::int64_t k = 0; k < whole; ++k) {
    const char digit = k < digit_count ? number->digits[first + static_cast<std::size_t>(k)] : '0';
    nanoseconds = nanoseconds * 10 + static_cast<std::uint64_t>(digit - '0');
  }
  if (whole < digit_count && number->digits[first + static_cast<std::size_t>(whole)] >= '5') {
    ++nanoseconds;
  }
  if (nanoseconds > static_cast<std::uint64_t>(std::numeric_limits<Timestamp>::max())) {
    return std::nullopt;
  }
  const auto t = static_cast<Timestamp>(nanoseconds);
  return number->negative ? -t : t;
}

void AppendNumber(double value, std::string* text) { AppendShortest(value, text); }
void AppendNumber(float value, std::string* text) { AppendShortest(value, text); }
void AppendNumber(std::int64_t value, std::string* text) { AppendShortest(value, text); }
void AppendNumber(std::uint64_t value, std::string* text) { AppendShortest(value, text); }

void AppendSeconds(Timestamp t, std::string* text) {
  constexpr std::uint64_t kNanosecondsPerSecond = 1'000'000'000;
  // Negation in unsigned arithmetic holds for the smallest integer too.
  const std::uint64_t magnitude =
      t < 0 ? 0 - static_cast<std::uint64_t>(t) : static_cast<std::uint64_t>(t);
  if (t < 0) text->push_back('-');
  AppendNumber(magnitude / kNanosecondsPerSecond, text);
  std::uint64_t fraction = magnitude % kNanosecondsPerSecond;
  std::array<char, 10> decimals;
  decimals[0] = '.';
  for (std::size_t k = 9; k >= 1; --k) {
    decimals[k] = static_cast<char>('0' + fraction % 10);
    fraction /= 10;
  }
  text->append(decimals.data(), decimals.size());
}

std::string FormatNumber(double value) {
  std::string text;
  AppendNumber(value, &text);
  return text;
}

std::string FormatFixed(double value, int decimals) {
  // The largest double has 309 digits before the point.
  std::array<char, 400> buffer;
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                          std::chars_format::fixed, decimals);
  if (error != std::errc()) return FormatNumber(value);
  return std::string(buffer.data(), end);
}

std::string FormatSeconds(Timestamp t) {
  std::string text;
  AppendSeconds(t, &text);
  return text;
}

std::string FormatDuration(Timestamp duration) {
  std::string text = FormatSeconds(duration);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.ends_with('.')) text.pop_back();
  return text;
}

}  // namespace duet
