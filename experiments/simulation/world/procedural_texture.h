#pragma once

#include <string>

#include "common/support/random.h"
#include "experiments/simulation/world/canvas.h"

namespace duet {

// What the surfaces of buildings look like. Every function paints `area` of a canvas (the rest
// stays), greys are reflectances in 0..255 before light, sizes in metres, and all chance comes from
// the generator given.

/// A grey that differs from `grey` by at most `spread`, within what a surface may have.
[[nodiscard]] double NearGrey(Random& random, double grey, double spread);
/// A word or a number for signs and labels.
[[nodiscard]] std::string RandomWord(Random& random);
[[nodiscard]] std::string RandomCode(Random& random);

/// Fine irregularity of any material: multiplies by 1 +- amplitude at 5 to 60 mm.
void PaintGrain(Canvas& canvas, const Area& area, Random& random, double amplitude);
/// Dirt in large soft patches, `count` stains, `count` scratches.
void PaintWear(Canvas& canvas, const Area& area, Random& random, double strength, int count);
/// Thin dark cracks that wander over it.
void PaintCracks(Canvas& canvas, const Area& area, Random& random, int count, double grey);

void PaintPlaster(Canvas& canvas, const Area& area, Random& random, double grey);
void PaintConcrete(Canvas& canvas, const Area& area, Random& random, double grey,
                   double joint_pitch_m);
/// Bricks in stretcher bond, each with a tone of its own.
void PaintBricks(Canvas& canvas, const Area& area, Random& random, double brick_width_m,
                 double brick_height_m, double grey, double spread);
/// Boards along x (or y), with grain, knots and nails.
void PaintBoards(Canvas& canvas, const Area& area, Random& random, bool along_x,
                 double board_width_m, double grey, double spread);
/// Square tiles with joints; some with an ornament.
void PaintTiles(Canvas& canvas, const Area& area, Random& random, double size_m, double grey_a,
                double grey_b, double ornament_share);
/// Foam mats that lock into each other, speckled.
void PaintPuzzleMats(Canvas& canvas, const Area& area, Random& random, double size_m);
void PaintRug(Canvas& canvas, const Area& area, Random& random);
/// Ceiling boards with pinholes in a metal grid.
void PaintCeilingBoards(Canvas& canvas, const Area& area, Random& random, double size_m);
/// Wall panels with joints and screws.
void PaintWallPanels(Canvas& canvas, const Area& area, Random& random, double pitch_x_m,
                     double pitch_y_m, double grey, double spread);
/// Corrugated or trapezoidal sheet metal, ribs along y.
void PaintSheetMetal(Canvas& canvas, const Area& area, Random& random, double rib_pitch_m,
                     double grey);
/// A window with frame, `columns` x `rows` panes, and what is seen in the glass: about as bright
/// as `glass_grey`, behind a blind or curtains now and then.
void PaintWindow(Canvas& canvas, const Area& area, Random& random, int columns, int rows,
                 double frame_grey, double glass_grey);
void PaintDoor(Canvas& canvas, const Area& area, Random& random, double grey);
/// A grating of bars over a dark pit.
void PaintGrating(Canvas& canvas, const Area& area, Random& random, double pitch_m);
/// Diagonal warning stripes.
void PaintHazardStripes(Canvas& canvas, const Area& area, double pitch_m, double dark,
                        double bright);
/// Worn paint: lines and areas that dirt shows through.
void PaintWornFill(Canvas& canvas, const Area& area, Random& random, double grey, double worn);

}  // namespace duet
