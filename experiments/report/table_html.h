#pragma once

#include <string>

#include "evaluation/study_table.h"

namespace duet {

/// A study's table in a page: the verdict over it, the title for those who hear it, groups and
/// columns, best and second marked for the eye and in words, the foot to be opened.
[[nodiscard]] std::string TableHtml(const StudyTable& table);

}  // namespace duet
