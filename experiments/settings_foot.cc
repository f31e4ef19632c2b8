#include "experiments/settings_foot.h"

#include <algorithm>
#include <string_view>

#include "common/support/numeric_text.h"
#include "common/support/text_file.h"

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
  constexpr std::string_view prefix = "shared.calibration.estimate_";
  std::string text;
  for (const ResolvedValue& value : values) {
    if (value.key.rfind(prefix, 0) != 0 || value.value != "true") continue;
    text += (text.empty() ? "" : " ") + value.key.substr(prefix.size());
  }
  return text.empty() ? "none" : text;
}

/// Mean over the frames of features.csv of one column, by its place.
std::string MeanOfColumn(const std::string& csv, std::size_t column) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t begin = 0; begin < csv.size();) {
    const std::size_t end = std::min(csv.find('\n', begin), csv.size());
    std::string_view line = std::string_view(csv).substr(begin, end - begin);
    begin = end + 1;
    if (line.empty() || line[0] == '#') continue;
    for (std::size_t i = 0; i < column && !line.empty(); ++i) {
      line.remove_prefix(std::min(line.find(','), line.size() - 1) + 1);
    }
    sum += ParseDouble(line.substr(0, line.find(','))).value_or(0.0);
    ++count;
  }
  return count == 0 ? "-" : FormatFixed(sum / count, 1);
}

}  // namespace

Foot SettingsFoot(const std::vector<ResolvedValue>& values, const std::string& estimator,
                  const std::filesystem::path& folder) {
  constexpr std::size_t kUsedColumn = 3;  // features.csv: stamp, status, observed, used
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
  if (std::filesystem::exists(folder / "features.csv")) {
    foot.emplace_back("landmarks used a frame",
                      MeanOfColumn(ReadTextFile(folder / "features.csv"), kUsedColumn));
  }
  return foot;
}

}  // namespace duet
