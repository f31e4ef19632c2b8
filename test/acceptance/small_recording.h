#pragma once

#include <filesystem>

namespace duet {

/// Writes a recording with real images: a rig at rest before a textured wall, 40 frames at 20 Hz of
/// one 320x240 camera, IMU at 200 Hz from 0.5 s before to 0.5 s after, ground truth. Small enough
/// to be spoilt in many ways.
void WriteSmallRecording(const std::filesystem::path& folder);

/// Stamp of its first image, ns.
inline constexpr long long kSmallFirstImage = 1'000'000'000'000'000'000;
inline constexpr int kSmallImages = 40;

}  // namespace duet
