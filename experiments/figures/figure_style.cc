#include "experiments/figures/figure_style.h"

#include <cctype>
#include <sstream>

namespace duet {
namespace {

// Advance widths of ' ' to '~', thousandths of the font's size.
constexpr std::array<int, 95> kAdvance = {
    278,  278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278,  // ' ' to /
    556,  556, 556, 556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556,  // 0 to ?
    1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833, 722, 778,  // @ to O
    667,  778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469, 556,  // P to _
    333,  556, 556, 500, 556, 556, 278, 556, 556, 222, 222, 500, 222, 833, 556, 556,  // ` to o
    556,  556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584};      // p to ~

}  // namespace

const std::vector<double>& DashLengths(int dash) {
  static const std::vector<std::vector<double>> lengths = {
      {}, {4.0, 1.6}, {1.0, 1.2}, {5.0, 1.4, 1.0, 1.4}, {2.0, 1.2}, {7.0, 2.0}};
  return lengths[static_cast<std::size_t>(dash) % lengths.size()];
}

Look LookOf(std::size_t n) {
  constexpr std::array<int, 7> kOrder = {kBlue,   kVermilion, kGreen, kPurple,
                                         kOrange, kSkyBlue,   kGrey};
  const auto k = static_cast<int>(n);
  return {.colour = kOrder[n % kOrder.size()],
          .dash = k % 6,
          .symbol = k % static_cast<int>(kSymbols.size()),
          .pattern = k % static_cast<int>(kHatchings.size())};
}

Look LookOfEstimator(const std::string& estimator, std::size_t n) {
  if (estimator == "msckf") return LookOf(0);
  if (estimator == "window") return LookOf(1);
  return LookOf(n + 2);
}

Look TruthLook() { return {.colour = kBlack, .dash = kSolid, .width_pt = 0.8}; }

Look SigmaLook(Look curve) {
  curve.width_pt = 0.5;
  return curve;
}

double TextWidthMm(std::string_view text) {
  int thousandths = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80 && byte < 0xc0) continue;  // goes on with the letter before
    thousandths += byte < ' ' || byte > '~' ? 600 : kAdvance[byte - static_cast<unsigned>(' ')];
  }
  return thousandths * 1e-3 * kLetteringPt * kMmPerPt;
}

std::vector<std::string> WrapText(const std::string& text, double width_mm) {
  // A number and its unit stay together.
  constexpr std::size_t kLongestUnit = 4;
  std::vector<std::string> words;
  std::istringstream in(text);
  for (std::string word; in >> word;) {
    const bool unit = word.size() <= kLongestUnit && !words.empty() &&
                      std::isdigit(static_cast<unsigned char>(words.back().back())) != 0;
    if (unit) {
      words.back() += " " + word;
    } else {
      words.push_back(word);
    }
  }
  std::vector<std::string> lines;
  for (const std::string& word : words) {
    if (!lines.empty() && TextWidthMm(lines.back() + " " + word) <= width_mm) {
      lines.back() += " " + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

}  // namespace duet
