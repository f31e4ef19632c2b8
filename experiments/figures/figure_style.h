#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "experiments/figures/figure.h"

namespace duet {

/// The house's style, for a paper of two columns.
inline constexpr double kColumnWidthMm = 88.9;
inline constexpr double kLetteringPt = 8.0;
inline constexpr double kMmPerPt = 25.4 / 72.0;
inline constexpr double kLineHeightMm = 1.2 * kLetteringPt * kMmPerPt;
inline constexpr const char* kFont = "Liberation Sans";

/// Okabe and Ito's palette ("Color Universal Design", 2008), black first, then a grey.
enum Colour { kBlack, kOrange, kSkyBlue, kGreen, kYellow, kBlue, kVermilion, kPurple, kGrey };
struct ColourValue {
  const char* name;  ///< in the PGFPlots file
  const char* hex;
};
inline constexpr std::array<ColourValue, 9> kColours = {{{"duetblack", "000000"},
                                                         {"duetorange", "E69F00"},
                                                         {"duetskyblue", "56B4E9"},
                                                         {"duetgreen", "009E73"},
                                                         {"duetyellow", "F0E442"},
                                                         {"duetblue", "0072B2"},
                                                         {"duetvermilion", "D55E00"},
                                                         {"duetpurple", "CC79A7"},
                                                         {"duetgrey", "888888"}}};

/// Lengths of dash and gap in turn, in pt; the first is a solid line.
enum Dash { kSolid, kDashed, kDotted, kDashDotted, kShortDashed, kLongDashed };
[[nodiscard]] const std::vector<double>& DashLengths(int dash);

/// Marks of points, by gnuplot's and PGFPlots's names.
struct Symbol {
  int gnuplot;
  const char* pgfplots;
};
inline constexpr std::array<Symbol, 6> kSymbols = {
    {{7, "*"}, {5, "square*"}, {9, "triangle*"}, {13, "diamond*"}, {6, "o"}, {2, "x"}}};
/// Hatchings of bars; the first is not used (filled).
struct Hatching {
  int gnuplot;
  const char* pgfplots;
};
inline constexpr std::array<Hatching, 5> kHatchings = {
    {{3, ""}, {4, "north east lines"}, {5, "north west lines"}, {2, "crosshatch"}, {1, "grid"}}};

/// The look of the n-th of several alike (0: the first): blue and solid, vermilion and dashed, ...
[[nodiscard]] Look LookOf(std::size_t n);
/// The same for an estimator: the two have theirs wherever they are drawn; others take LookOf(n).
[[nodiscard]] Look LookOfEstimator(const std::string& estimator, std::size_t n);
[[nodiscard]] Look TruthLook();
/// The thin lines at +-3 sigma that go with a curve.
[[nodiscard]] Look SigmaLook(Look curve);

/// Width of a text in the house's font and size. From the metrics of Helvetica, which are those of
/// Liberation Sans; what is no ASCII counts as a digit.
[[nodiscard]] double TextWidthMm(std::string_view text);
/// Lines of words that are at most `width_mm` wide (a longer word stands alone).
[[nodiscard]] std::vector<std::string> WrapText(const std::string& text, double width_mm);

}  // namespace duet
