#include "common/support/logging.h"
#include "experiments/calibration_watch.h"
#include "experiments/figures/run_errors.h"
#include "test/fuzz/fuzz_reader.h"

// Tables of a record that figures read by their columns' names, and calibration.csv.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return duet::FuzzReader(data, size, [](std::string_view text) {
    try {
      const duet::RecordTable table = duet::ParseRecordTable(text, "f");
      CHECK_EQ(table.columns.size(), table.names.size());
      for (const std::vector<double>& column : table.columns) {
        CHECK_EQ(column.size(), table.stamps.size());
      }
    } catch (const duet::InputError&) {
    }
    const auto numbers = duet::ReadCalibrationCsv(text, "f");
    CHECK_EQ(duet::ReadCalibrationCsv(duet::CalibrationCsv(numbers), "g").size(), numbers.size());
  });
}
