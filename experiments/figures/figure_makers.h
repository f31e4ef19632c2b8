#pragma once

#include "experiments/figures/figure.h"
#include "experiments/figures/figures.h"

namespace duet {

/// One function a figure: from records to what is drawn. All throw InputError. MakeFigure fills in
/// the name, and the title where it is empty.

// trajectory_figures.cc
[[nodiscard]] Figure TrajectoryTopFigure(const FigureInput& input);
[[nodiscard]] Figure TrajectorySideFigure(const FigureInput& input);
[[nodiscard]] Figure Thesis82Figure(const FigureInput& input);

// error_figures.cc
[[nodiscard]] Figure PositionErrorFigure(const FigureInput& input);
[[nodiscard]] Figure OrientationErrorFigure(const FigureInput& input);
[[nodiscard]] Figure RmseOverRunsFigure(const FigureInput& input);

// consistency_figures.cc
[[nodiscard]] Figure NeesOverTimeFigure(const FigureInput& input);

}  // namespace duet
