#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/support/stage_timer.h"
#include "common/support/timestamp.h"

namespace duet {

/// Rows of timing.csv: thread CPU time in ms, one row a frame, one column a stage. Columns appear
/// with their first use; a field is empty where the frame did not have the stage.
class TimingLog {
 public:
  void StartFrame(Timestamp timestamp);
  void Add(const std::string& column, double cpu_ms);
  /// Adds "prefix.stage" for each stage.
  void Add(const std::string& prefix, const std::vector<StageTimer::Stage>& stages);

  void Write(const std::filesystem::path& path) const;

 private:
  struct Row {
    Timestamp timestamp;
    std::vector<std::optional<double>> cpu_ms;  ///< may end early
  };
  std::vector<std::string> columns_;
  std::vector<Row> rows_;
};

/// A timing.csv by columns: name and the values [ms] of the frames that have it. Throws InputError.
[[nodiscard]] std::vector<std::pair<std::string, std::vector<double>>> ReadTimingTable(
    std::string_view csv, const std::string& file);

}  // namespace duet
