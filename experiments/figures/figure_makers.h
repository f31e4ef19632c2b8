#pragma once

#include "experiments/figures/figure.h"
#include "experiments/figures/figures.h"

namespace duet {

/// What MakeFigure writes, before it does.
[[nodiscard]] Figure ComposeFigure(const std::string& name, const FigureInput& input);

/// One function a figure: from records to what is drawn. All throw InputError. ComposeFigure fills
/// in the name, and the title where it is empty.

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

// relative_figure.cc
[[nodiscard]] Figure RelativeErrorsFigure(const FigureInput& input);

// calibration_figure.cc
[[nodiscard]] Figure CalibrationFigure(const FigureInput& input);

// ablation_figure.cc
[[nodiscard]] Figure AblationMatrixFigure(const FigureInput& input);

// cost_figures.cc
[[nodiscard]] Figure CostAgainstAccuracyFigure(const FigureInput& input);
[[nodiscard]] Figure TimeByStageFigure(const FigureInput& input);

// stream_figures.cc
[[nodiscard]] Figure TrackLengthsFigure(const FigureInput& input);
[[nodiscard]] Figure ParallaxFigure(const FigureInput& input);

// allan_figure.cc
[[nodiscard]] Figure AllanFigure(const FigureInput& input);

// information_figure.cc
[[nodiscard]] Figure InformationSpectrumFigure(const FigureInput& input);

// whiteness_figures.cc
[[nodiscard]] Figure NormalizedErrorsFigure(const FigureInput& input);
[[nodiscard]] Figure WhitenessFigure(const FigureInput& input);

// thesis_figures.cc, structure_figure.cc
[[nodiscard]] Figure Thesis32Figure(const FigureInput& input);
[[nodiscard]] Figure Thesis38Figure(const FigureInput& input);
[[nodiscard]] Figure Thesis39Figure(const FigureInput& input);
[[nodiscard]] Figure Thesis310Figure(const FigureInput& input);
[[nodiscard]] Figure Thesis54Figure(const FigureInput& input);
[[nodiscard]] Figure Thesis63Figure(const FigureInput& input);
[[nodiscard]] Figure Thesis81Figure(const FigureInput& input);

}  // namespace duet
