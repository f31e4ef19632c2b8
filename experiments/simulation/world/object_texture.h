#pragma once

#include "common/support/random.h"
#include "experiments/simulation/world/canvas.h"
#include "experiments/simulation/world/procedural_texture.h"

namespace duet {

// What things in a place look like; the same rules as in procedural_texture.h.

/// A label with words, a bar code or lines of small print.
void PaintLabel(Canvas& canvas, const Area& area, Random& random);
/// One of eight designs: shapes, print, fiducial tags, a landscape, a chart, rings, a map, a grid.
void PaintPoster(Canvas& canvas, const Area& area, Random& random);
inline constexpr int kPosterDesigns = 8;
void PaintPoster(Canvas& canvas, const Area& area, Random& random, int design);

/// Cloth in folds, with stripes or figures that follow them.
void PaintCurtain(Canvas& canvas, const Area& area, Random& random);
/// A quilted mattress.
void PaintMattress(Canvas& canvas, const Area& area, Random& random);
/// Woven cloth: stripes both ways.
void PaintPlaid(Canvas& canvas, const Area& area, Random& random, double grey);
/// Boards of a shelf with books, binders and boxes on them.
void PaintShelf(Canvas& canvas, const Area& area, Random& random);
void PaintCrateSide(Canvas& canvas, const Area& area, Random& random);
void PaintCardboard(Canvas& canvas, const Area& area, Random& random);
/// A machine's side: panels with vents, gauges, displays, switches, labels, doors, pipes.
void PaintMachineSide(Canvas& canvas, const Area& area, Random& random, double grey);
/// A tube or pipe that runs along the longer side.
void PaintPipe(Canvas& canvas, const Area& area, Random& random, double grey);
/// A steel beam or column along the longer side, with rivets and rust.
void PaintBeam(Canvas& canvas, const Area& area, Random& random, double grey);
void PaintFoliage(Canvas& canvas, const Area& area, Random& random, double grey);
void PaintBark(Canvas& canvas, const Area& area, Random& random);

}  // namespace duet
