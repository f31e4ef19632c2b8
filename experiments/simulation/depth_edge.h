#pragma once

#include <Eigen/Core>

#include "experiments/simulation/render/true_camera.h"

namespace duet {

/// True where within `radius_px` of `uv` the true depth jumps, a body that moves against the other
/// begins, or the world ends: a patch there shows two motions. Where two surfaces meet (a wall and
/// the floor, two faces of a box) is no edge. Looks along twelve directions in steps of 1.25 px or
/// less; all rays are cast with the pose and the instant of `uv`.
[[nodiscard]] bool NearDepthEdge(const TrueCamera& truth, int camera, Timestamp stamp,
                                 const Eigen::Vector2d& uv, double radius_px);

}  // namespace duet
