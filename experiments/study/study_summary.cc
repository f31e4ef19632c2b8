// StudySummaryTable: a study's numbers in one table.

#include "evaluation/study_table.h"
#include "experiments/study/study_records.h"

namespace duet {

StudyTable StudySummaryTable(const StudyResult& result, const std::vector<std::string>& metrics,
                             const std::vector<StudyTable>& tables) {
  const std::vector<std::string> choice = {"ate.position_m", "ate.orientation_deg",
                                           "coverage_share", "frame_ms.median"};
  return SummaryTable(result, metrics.empty() ? choice : metrics, tables);
}

}  // namespace duet
