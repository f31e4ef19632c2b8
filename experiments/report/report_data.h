#pragma once

#include <string>

#include "experiments/report/report.h"

namespace duet {

/// What the page's script is given (web/src/data.js), as JSON:
///   format       "duet report 1"
///   columns      of the curves (run_curves.h)
///   estimators   names, in the order of their colours
///   metrics      KEY: {label}
///   nees         BLOCK: {dof, band: [low, high]} of one instant; confidence
///   runs         the coordinates and metrics of StudyRun, stream_id, and of those with states
///                `curves` (EncodeCurves), `instants` of the record, `from_truth` (how it was
///                started) and `alignment` {R, p, orientation_R}, rotations as x y z w, or null
/// Numbers that are not finite are null.
[[nodiscard]] std::string ReportDataJson(const Report& report);

}  // namespace duet
