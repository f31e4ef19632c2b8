#pragma once

#include "common/support/random.h"
#include "experiments/simulation/world/canvas.h"

namespace duet {

// What a street shows; the same rules as in procedural_texture.h.

/// The front of a house: a shop or an entrance at the foot (where `ground` says that it stands on
/// the ground), floors of windows, a cornice. Material, rhythm and ornament are drawn from the
/// generator, so that no two are alike.
void PaintFacade(Canvas& canvas, const Area& area, Random& random, bool ground);
/// A wall without windows between houses.
void PaintPartyWall(Canvas& canvas, const Area& area, Random& random);
void PaintRoofTiles(Canvas& canvas, const Area& area, Random& random);

/// The road between the kerbs; y runs across, the tramway in the middle, crossings now and then.
void PaintRoad(Canvas& canvas, const Area& area, Random& random);
/// Slabs, with a gutter of small stones along the edge.
void PaintPavement(Canvas& canvas, const Area& area, Random& random);
void PaintGrass(Canvas& canvas, const Area& area, Random& random);

}  // namespace duet
