#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "experiments/exit_status.h"
#include "experiments/study/study_plan.h"

namespace duet {

struct StudyChoices {
  std::filesystem::path file = {};  ///< of --plan and --run; a study at hand needs none
  std::filesystem::path out;
  std::filesystem::path data;  ///< where recordings are; empty: beside the file
  bool quick = false;
  int jobs = 1;
  bool quiet = false;
  bool print_summary = true;  ///< on stdout, at the end
  std::string command_line;   ///< for the manifests
};

/// Runs what the study's folder lacks, each run in a process of its own, then writes runs.csv,
/// summary.txt and what else is made of the records. A run whose process died has no record and its
/// end as the reason; it is tried again at the next start. Returns kDone, kInterrupted,
/// kWritingFailed (what is done stays) or, where a process died, kInternalError. Throws InputError
/// and OutputError.
[[nodiscard]] int RunStudy(const StudyChoices& choices);
/// The same of a study at hand.
[[nodiscard]] int RunStudy(StudyFile study, const StudyChoices& choices);

/// One run of the plan, by its id, as an engine outside calls it: writes its record and nothing
/// else.
[[nodiscard]] int RunStudyById(const StudyChoices& choices, const std::string& id);

/// How many runs and streams there are, how many are left, and how long they will take.
[[nodiscard]] int DryRunStudy(const StudyChoices& choices);
[[nodiscard]] int DryRunStudy(StudyFile study, const StudyChoices& choices);

/// Prepares the folder and prints one command for each run that is left.
[[nodiscard]] int PrintStudyPlan(const StudyChoices& choices);

}  // namespace duet
