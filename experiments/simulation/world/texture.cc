#include "experiments/simulation/world/texture.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/support/logging.h"

namespace duet {
namespace {

// Each texel the mean of the 2 x 2 below it, rounded to the nearest (halves to even, so that the
// levels' mean does not creep upwards); beyond an odd edge the edge texels go on.
Texture::Level Halved(const Texture::Level& fine) {
  Texture::Level coarse;
  coarse.width = (fine.width + 1) / 2;
  coarse.height = (fine.height + 1) / 2;
  coarse.texels.resize(static_cast<std::size_t>(coarse.width) *
                       static_cast<std::size_t>(coarse.height));
  const auto row_of = [&fine](int y) {
    return fine.texels.data() + static_cast<std::ptrdiff_t>(std::min(y, fine.height - 1)) *
                                    static_cast<std::ptrdiff_t>(fine.width);
  };
  std::uint8_t* out = coarse.texels.data();
  for (int y = 0; y < coarse.height; ++y) {
    const std::uint8_t* upper = row_of(2 * y);
    const std::uint8_t* lower = row_of(2 * y + 1);
    for (int x = 0; x < coarse.width; ++x) {
      const int left = 2 * x;
      const int right = std::min(left + 1, fine.width - 1);
      const int sum = upper[left] + upper[right] + lower[left] + lower[right];
      const int down = sum / 4;
      const int rest = sum % 4;
      const bool up = rest == 3 || (rest == 2 && down % 2 == 1);
      *out++ = static_cast<std::uint8_t>(down + (up ? 1 : 0));
    }
  }
  return coarse;
}

}  // namespace

Texture::Texture(int width, int height, double texel_m, std::vector<std::uint8_t> texels)
    : texel_m_(texel_m) {
  CHECK_GT(width, 0);
  CHECK_GT(height, 0);
  CHECK_GT(texel_m, 0.0);
  CHECK_EQ(texels.size(), static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  levels_.push_back({width, height, std::move(texels)});
  while (levels_.back().width > 1 || levels_.back().height > 1) {
    levels_.push_back(Halved(levels_.back()));
  }
}

}  // namespace duet
