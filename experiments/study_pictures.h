#pragma once

#include <string>
#include <utility>
#include <vector>

#include "experiments/study/study_records.h"

namespace duet {

/// Refuses names of figures that there are none of, with the nearest. Throws InputError.
void CheckFigures(const StudyFile& study);

/// Writes the figures that a study's file names (without that key: a choice) and report.html into
/// its folder, and gives their paths in it. One that the records do not hold is a warning where it
/// was asked for: the study is done. Throws OutputError.
[[nodiscard]] std::vector<std::string> MakePictures(const StudyFolder& folder);

/// What of these is text that the records alone give: the figures' data and the page, by their
/// paths.
[[nodiscard]] std::vector<std::pair<std::string, std::string>> PictureTexts(
    const StudyFolder& folder);

}  // namespace duet
