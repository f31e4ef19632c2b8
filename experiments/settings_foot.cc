#include "experiments/settings_foot.h"

#include <cmath>
#include <functional>
#include <optional>
#include <string_view>

#include "common/support/numeric_text.h"
#include "common/support/text_file.h"
#include "experiments/record_tables.h"

namespace duet {
namespace {

using Foot = std::vector<std::pair<std::string, std::string>>;

/// A row of the foot: the key below the estimator's own group that it shows, one of the two where
/// the estimators name it differently.
struct FootRow {
  const char* title;
  std::vector<const char*> keys;
};

const std::vector<FootRow>& FootRows() {
  static const std::vector<FootRow> rows = {
      {"window [frames]", {"max_clones", "max_frames"}},
      {"frames kept", {"keyframes"}},
      {"first estimates", {"first_estimates"}},
      {"chi-squared gate", {"gate"}},
      {"outliers removed from tracks", {"remove_outliers"}},
      {"robust loss", {"robust_loss"}},
      {"landmark parameters", {"landmark_parameters"}},
      {"iterations, at most", {"max_iterations"}},
  };
  return rows;
}

const std::string* ValueOf(const std::vector<ResolvedValue>& values, const std::string& key) {
  for (const ResolvedValue& value : values) {
    if (value.key == key) return &value.value;
  }
  return nullptr;
}

std::string EstimatedCalibration(const std::vector<ResolvedValue>& values) {
  constexpr std::string_view prefix = "shared.calibration.";
  constexpr std::string_view suffix = ".state";
  std::string text;
  for (const ResolvedValue& value : values) {
    if (!value.key.starts_with(prefix) || !value.key.ends_with(suffix)) continue;
    if (value.value != "estimated") continue;
    const std::size_t length = value.key.size() - prefix.size() - suffix.size();
    text += (text.empty() ? "" : " ") + value.key.substr(prefix.size(), length);
  }
  return text.empty() ? "none" : text;
}

/// The mean over the records of what `read` tells of each features.csv; nothing where none tells.
std::optional<double> MeanOverRecords(
    const std::vector<std::filesystem::path>& folders,
    const std::function<double(const std::string& csv, const std::string& file)>& read) {
  double sum = 0.0;
  int count = 0;
  for (const std::filesystem::path& folder : folders) {
    const std::filesystem::path features = folder / "features.csv";
    if (!std::filesystem::exists(features)) continue;
    const double value = read(ReadTextFile(features), features.string());
    if (!std::isfinite(value)) continue;
    sum += value;
    ++count;
  }
  if (count == 0) return std::nullopt;
  return sum / count;
}

int WindowFrames(const std::vector<ResolvedValue>& values, const std::string& estimator) {
  for (const char* key : {".max_clones", ".max_frames"}) {
    const std::string* value = ValueOf(values, estimator + key);
    if (value == nullptr) continue;
    if (const auto frames = ParseInt64(*value)) return static_cast<int>(*frames);
  }
  return 0;
}

}  // namespace

Foot SettingsFoot(const std::vector<ResolvedValue>& values, const std::string& estimator,
                  const std::vector<std::filesystem::path>& folders) {
  Foot foot;
  for (const FootRow& row : FootRows()) {
    for (const char* key : row.keys) {
      const std::string* value = ValueOf(values, estimator + "." + key);
      if (value != nullptr) foot.emplace_back(row.title, *value);
    }
  }
  foot.emplace_back("calibration estimated", EstimatedCalibration(values));
  if (const std::string* standstill = ValueOf(values, "shared.standstill.enabled")) {
    foot.emplace_back("standstill measurement", *standstill);
  }
  if (const int frames = WindowFrames(values, estimator); frames > 0) {
    const auto span_s =
        MeanOverRecords(folders, [&](const std::string& csv, const std::string& file) {
          return ReadWindowSpan(csv, file, frames);
        });
    if (span_s) foot.emplace_back("seconds spanned by a full window", FormatFixed(*span_s, 2));
  }
  const auto used = MeanOverRecords(folders, [](const std::string& csv, const std::string& file) {
    return ReadFeatureMean(csv, file, "used");
  });
  if (used) foot.emplace_back("landmarks used a frame", FormatFixed(*used, 1));
  return foot;
}

}  // namespace duet
