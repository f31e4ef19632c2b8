#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "evaluation/study_grid.h"
#include "evaluation/study_table.h"

namespace duet {

/// Numbers that others have published of a data set's sequences, kept as data with their source
/// (configs/studies/published/, docs/formats.md), and the tables that put a study's own beside
/// them.

struct PublishedRow {
  std::string sequence;         ///< as the data set calls it
  double position_rmse_m;       ///< NaN where it is not given
  double orientation_rmse_deg;  ///< NaN where it is not given
};

/// Of one system.
struct PublishedNumbers {
  std::string name;       ///< "OpenVINS mono"
  std::string source;     ///< who says so, and where
  std::string alignment;  ///< of estimate and truth, as the source says
  std::string covers;     ///< what the numbers are of: error, cameras, odometry or more
  std::string note;       ///< what else to know of them; may be empty
  std::vector<PublishedRow> rows;
};

/// What a sequence is like.
struct SequenceRow {
  std::string sequence;
  double length_m = 0.0;
  double duration_s = 0.0;
  double speed_m_per_s = 0.0;
  double rate_rad_per_s = 0.0;
  std::string remark;
};

struct PublishedSequences {
  std::string name;
  std::string source;
  std::vector<SequenceRow> rows;
};

/// A file is a table of the two kinds, told apart by its columns. `file` is for errors. Throws
/// InputError for a missing line of the head, an unknown column, a number that is none, a sequence
/// that is named twice.
[[nodiscard]] PublishedNumbers ParsePublishedNumbers(std::string_view text,
                                                     const std::string& file);
[[nodiscard]] PublishedSequences ParsePublishedSequences(std::string_view text,
                                                         const std::string& file);

/// Every file NAME.csv of the folder, in the order of their names.
struct Published {
  std::vector<PublishedNumbers> numbers;
  std::vector<PublishedSequences> sequences;
  [[nodiscard]] bool empty() const { return numbers.empty() && sequences.empty(); }
};
[[nodiscard]] Published ReadPublished(const std::filesystem::path& folder);

/// Tables of the study's medians beside the published numbers of sequences of the streams' names
/// (table 8.1 of the thesis), for "ate.position_m" and "ate.orientation_deg", and of what the
/// sequences are like (table 7.1), from the metrics truth.*. Nothing is marked best, and nothing is
/// tested: alignments, starts and cameras differ. No table where no stream has a published
/// sequence.
[[nodiscard]] std::vector<StudyTable> PublishedTables(const StudyGrid& grid,
                                                      const Published& published);

}  // namespace duet
