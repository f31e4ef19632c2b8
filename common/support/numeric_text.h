#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/support/timestamp.h"

namespace duet {

/// Numbers from text and back, independent of the locale and without rounding twice. A text is a
/// number only as a whole: no blanks around it, nothing after it, no leading '+'.

/// Decimal or scientific; "nan" and "inf" are read as such (callers say whether they take them).
/// Nothing for numbers beyond the type's range.
[[nodiscard]] std::optional<double> ParseDouble(std::string_view text);
/// Rounded once, from the text: the float that AppendNumber(float) wrote.
[[nodiscard]] std::optional<float> ParseFloat(std::string_view text);
[[nodiscard]] std::optional<std::int64_t> ParseInt64(std::string_view text);
[[nodiscard]] std::optional<std::uint64_t> ParseUint64(std::string_view text);

/// A decimal number of seconds ("1403636583.763555584", "1.403636583763555584e+09") as integer
/// nanoseconds, exactly: it never passes through a double. Digits beyond the ninth are rounded to
/// nearest (halves away from zero). Nothing where it is no finite number or leaves 64 bits.
[[nodiscard]] std::optional<Timestamp> ParseSeconds(std::string_view text);

/// Appends the shortest text that reads back to the same number.
void AppendNumber(double value, std::string* text);
void AppendNumber(float value, std::string* text);
void AppendNumber(std::int64_t value, std::string* text);
void AppendNumber(std::uint64_t value, std::string* text);
inline void AppendNumber(int value, std::string* text) {
  AppendNumber(static_cast<std::int64_t>(value), text);
}
/// Appends seconds with nine decimals, printed from the integer.
void AppendSeconds(Timestamp t, std::string* text);

[[nodiscard]] std::string FormatNumber(double value);
/// With `decimals` digits after the point.
[[nodiscard]] std::string FormatFixed(double value, int decimals);
[[nodiscard]] std::string FormatSeconds(Timestamp t);
/// Seconds without trailing zeros, for sentences: "0.12".
[[nodiscard]] std::string FormatDuration(Timestamp duration);

}  // namespace duet
