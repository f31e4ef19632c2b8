#pragma once

#include "experiments/study/study_file.h"
#include "experiments/study/study_runner.h"

namespace duet {

/// Everything that a study's folder holds besides its records and is made of them alone: runs.csv,
/// summary.txt, the manifest. The one place where tables, figures and report join in. Throws
/// InputError and OutputError.
void WriteStudyProducts(const StudyFile& study, const StudyChoices& choices);

}  // namespace duet
