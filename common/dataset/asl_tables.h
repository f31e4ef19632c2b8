#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/imu/imu_sample.h"

namespace duet {

/// imu0/data.csv: stamps [ns], omega [rad/s], a [m/s^2]; stamps increase strictly.
[[nodiscard]] std::vector<ImuSample> ReadImuTable(std::string_view csv, const std::string& file);
[[nodiscard]] std::string WriteImuTable(const std::vector<ImuSample>& samples);

struct ImageName {
  Timestamp timestamp = 0;
  std::string name;  ///< a file in data/
};

/// cam<k>/data.csv: stamps [ns], strictly increasing, and file names without a folder.
[[nodiscard]] std::vector<ImageName> ReadImageTable(std::string_view csv, const std::string& file);

}  // namespace duet
