#include "experiments/record_tables.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <optional>

#include "common/dataset/csv_reader.h"
#include "common/support/input_error.h"
#include "common/support/numeric_text.h"

namespace duet {
namespace {

constexpr int kStateSize = 15;
/// Numbers of a covariance that a record may hold: far above any calibration's size.
constexpr std::uint64_t kLargestCovariance = 1000;

}  // namespace

std::vector<InertialState> ReadStateTable(std::string_view csv, const std::string& file) {
  constexpr int kQuaternion = 3;  // after instant, frame and status
  constexpr std::size_t kFewestColumns = kQuaternion + 16;
  std::vector<std::string> names = ReadColumnNames(csv, file);
  if (names.size() < kFewestColumns) {
    throw InputError(file, 1, "",
                     "expected at least " + std::to_string(kFewestColumns) + " columns");
  }
  CsvReader reader(csv, file, {std::move(names)});
  std::vector<InertialState> states;
  while (reader.Next()) {
    InertialState& state = states.emplace_back();
    state.instant = reader.CheckLater(0, reader.Stamp(0));
    state.nav.R_GB = ReadQuaternion(reader, kQuaternion, /*w_first=*/false);
    state.nav.p_GB = ReadVector(reader, kQuaternion + 4);
    state.nav.v_GB = ReadVector(reader, kQuaternion + 7);
    state.biases.b_g = ReadVector(reader, kQuaternion + 10);
    state.biases.b_a = ReadVector(reader, kQuaternion + 13);
  }
  return states;
}

std::vector<RecordedCovariance> ReadCovarianceTable(std::string_view csv, const std::string& file) {
  CsvReader reader(csv, file, {});
  std::vector<RecordedCovariance> rows;
  while (reader.Next()) {
    if (reader.column_count() < 2) reader.Fail(0, "expected a stamp, a size and a covariance");
    RecordedCovariance& row = rows.emplace_back();
    row.instant = reader.CheckLater(0, reader.Stamp(0));
    const std::uint64_t size = reader.Unsigned(1);
    if (size < kStateSize || size > kLargestCovariance ||
        static_cast<std::uint64_t>(reader.column_count()) != 2 + size * (size + 1) / 2) {
      reader.Fail(1, "expected the size of a covariance of at least 15 rows and so many numbers");
    }
    int next = 2;
    for (int i = 0; i < kStateSize; ++i) {
      for (int j = 0; j <= i; ++j) {
        const std::optional<double> value = ParseDouble(reader.Text(next));
        if (!value) reader.Fail(next, "expected a number");
        row.covariance(i, j) = row.covariance(j, i) = *value;
        ++next;
      }
    }
  }
  return rows;
}

Eigen::MatrixXd ReadLastCovariance(std::string_view csv, const std::string& file) {
  const std::size_t end = csv.find_last_not_of("\r\n");
  if (end == std::string_view::npos) return {};
  const std::size_t before = csv.find_last_of('\n', end);
  const std::size_t begin = before == std::string_view::npos ? 0 : before + 1;
  CsvReader reader(csv.substr(begin), file, {});
  if (!reader.Next()) return {};
  if (reader.column_count() < 2) reader.Fail(0, "expected a stamp, a size and a covariance");
  const std::uint64_t size = reader.Unsigned(1);
  if (size < kStateSize || size > kLargestCovariance ||
      static_cast<std::uint64_t>(reader.column_count()) != 2 + size * (size + 1) / 2) {
    reader.Fail(1, "expected the size of a covariance of at least 15 rows and so many numbers");
  }
  Eigen::MatrixXd covariance(static_cast<Eigen::Index>(size), static_cast<Eigen::Index>(size));
  int next = 2;
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const std::optional<double> value = ParseDouble(reader.Text(next));
      if (!value) reader.Fail(next, "expected a number");
      covariance(i, j) = covariance(j, i) = *value;
      ++next;
    }
  }
  return covariance;
}

double ReadFeatureMean(std::string_view csv, const std::string& file, const std::string& column) {
  std::vector<std::string> names = ReadColumnNames(csv, file);
  const auto found = std::find(names.begin(), names.end(), column);
  if (found == names.end()) throw InputError(file, 1, column, "expected this column");
  const int index = static_cast<int>(found - names.begin());
  CsvReader reader(csv, file, {std::move(names)});
  double sum = 0.0;
  int count = 0;
  for (; reader.Next(); ++count) sum += static_cast<double>(reader.Unsigned(index));
  return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum / count;
}

double ReadWindowSpan(std::string_view csv, const std::string& file, int frames) {
  std::vector<std::string> names = ReadColumnNames(csv, file);
  const auto index_of = [&](const char* column) {
    const auto found = std::find(names.begin(), names.end(), column);
    if (found == names.end()) throw InputError(file, 1, column, "expected this column");
    return static_cast<int>(found - names.begin());
  };
  const int status = index_of("status");
  const int keyframe = index_of("keyframe");
  CsvReader reader(csv, file, {std::move(names)});
  std::deque<Timestamp> window;
  double sum_s = 0.0;
  int count = 0;
  while (reader.Next()) {
    if (reader.Text(status) != "tracking" && reader.Text(status) != "dead reckoning") continue;
    window.push_back(reader.CheckLater(0, reader.Stamp(0)));
    const bool full = static_cast<int>(window.size()) >= frames;
    if (full) {
      sum_s += SecondsBetween(window.front(), window.back());
      ++count;
    }
    if (reader.Unsigned(keyframe) == 0) {
      if (window.size() > 1) window.erase(window.end() - 2);
    } else if (full) {
      window.pop_front();
    }
  }
  return count == 0 ? std::numeric_limits<double>::quiet_NaN() : sum_s / count;
}

}  // namespace duet
