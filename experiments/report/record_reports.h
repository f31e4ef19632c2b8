#pragma once

#include <filesystem>

#include "experiments/report/report.h"

namespace duet {

/// Reports without curves and figures: what records say in words, tables and numbers. All throw
/// InputError.

/// Of a study's folder: its tables are made anew from the records.
[[nodiscard]] Report DescribeStudy(const std::filesystem::path& folder);
/// Of a folder of duet compare.
[[nodiscard]] Report DescribeComparison(const std::filesystem::path& folder);
/// Of one run record.
[[nodiscard]] Report DescribeRunRecord(const std::filesystem::path& folder);

/// Whether the folder holds a complete run record.
[[nodiscard]] bool IsRunRecord(const std::filesystem::path& folder);

}  // namespace duet
