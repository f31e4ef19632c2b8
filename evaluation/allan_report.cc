#include "evaluation/allan_report.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/support/input_error.h"
#include "common/support/numeric_text.h"
#include "evaluation/text_table.h"

namespace duet {
namespace {

constexpr std::size_t kFewestSamples = 1000;
// Neighbouring seconds of an IMU at rest differ by far less: the worst of phones reach a tenth.
constexpr double kMovingRate = 0.01;         // rad/s
constexpr double kMovingAcceleration = 0.1;  // m/s^2
constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};

// First and one past last of the longest run without a gap.
std::pair<std::size_t, std::size_t> LongestStretch(const std::vector<ImuSample>& imu) {
  std::vector<Timestamp> intervals;
  for (std::size_t i = 1; i < imu.size(); ++i) {
    intervals.push_back(imu[i].timestamp - imu[i - 1].timestamp);
  }
  std::vector<Timestamp> sorted = intervals;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  std::pair<std::size_t, std::size_t> longest = {0, 0};
  std::size_t begin = 0;
  for (std::size_t i = 1; i <= imu.size(); ++i) {
    if (i < imu.size() && intervals[i - 1] <= *middle + *middle / 2) continue;
    if (i - begin > longest.second - longest.first) longest = {begin, i};
    begin = i;
  }
  return longest;
}

double DeviationNear(const std::vector<AllanPoint>& curve, double tau_s) {
  double best = 0.0;
  double distance = 1e300;
  for (const AllanPoint& point : curve) {
    if (std::abs(std::log(point.tau_s / tau_s)) >= distance) continue;
    distance = std::abs(std::log(point.tau_s / tau_s));
    best = point.deviation;
  }
  return best;
}

double MeanOfAxes(const std::array<AxisAllan, 3>& axes, NoiseEstimate AllanFit::*noise) {
  double squares = 0.0;
  for (const AxisAllan& axis : axes) squares += std::pow((axis.fit.*noise).value, 2) / 3.0;
  return std::sqrt(squares);
}

nlohmann::ordered_json NoiseJson(const NoiseEstimate& noise) {
  return {{"value", noise.value}, {"sigma", noise.sigma}};
}

nlohmann::ordered_json SensorJson(const std::array<AxisAllan, 3>& axes, const std::string& unit) {
  nlohmann::ordered_json json;
  json["unit"] = unit;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    const AllanFit& fit = axes[i].fit;
    json[kAxes[i]] = {{"white_density", NoiseJson(fit.white)},
                      {"bias_walk_density", NoiseJson(fit.walk)},
                      {"bias_instability", NoiseJson(fit.instability)},
                      {"lowest_deviation", fit.lowest_deviation},
                      {"lowest_deviation_tau_s", fit.lowest_tau_s},
                      {"misfit", fit.misfit}};
  }
  return json;
}

nlohmann::ordered_json DensitiesJson(const ImuNoise& noise) {
  return {{"gyroscope_noise_density", noise.gyroscope_density},
          {"gyroscope_random_walk", noise.gyroscope_random_walk},
          {"accelerometer_noise_density", noise.accelerometer_density},
          {"accelerometer_random_walk", noise.accelerometer_random_walk}};
}

std::string Scientific(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.3e", value);
  return text;
}

std::string Cell(const NoiseEstimate& noise) {
  return Scientific(noise.value) + " +- " + Scientific(noise.sigma);
}

}  // namespace

ImuNoise ImuAllan::Noise() const {
  return {.gyroscope_density = MeanOfAxes(gyroscope, &AllanFit::white),
          .accelerometer_density = MeanOfAxes(accelerometer, &AllanFit::white),
          .gyroscope_random_walk = MeanOfAxes(gyroscope, &AllanFit::walk),
          .accelerometer_random_walk = MeanOfAxes(accelerometer, &AllanFit::walk)};
}

ImuAllan AnalyzeImu(const std::vector<ImuSample>& imu, const std::string& file) {
  std::pair<std::size_t, std::size_t> stretch = {0, imu.size()};
  if (imu.size() >= 2) stretch = LongestStretch(imu);
  const std::size_t begin = stretch.first;
  const std::size_t end = stretch.second;
  const std::size_t count = end - begin;
  if (count < kFewestSamples) {
    throw InputError(file, 0, "",
                     "the longest stretch without a gap has " + std::to_string(count) +
                         " samples; an Allan deviation needs at least " +
                         std::to_string(kFewestSamples));
  }
  ImuAllan allan;
  allan.start = imu[begin].timestamp;
  allan.end = imu[end - 1].timestamp;
  allan.samples = static_cast<int>(count);
  allan.left_out = static_cast<int>(imu.size() - count);
  allan.rate_hz = static_cast<double>(count - 1) / SecondsBetween(allan.start, allan.end);
  std::vector<double> signal(count);
  for (int axis = 0; axis < 3; ++axis) {
    const auto analyze = [&](Eigen::Vector3d ImuSample::*member, AxisAllan* result) {
      for (std::size_t i = 0; i < count; ++i) signal[i] = (imu[begin + i].*member)[axis];
      result->curve = AllanDeviation(signal, allan.rate_hz);
      result->fit = FitAllan(result->curve);
    };
    analyze(&ImuSample::omega_m, &allan.gyroscope[static_cast<std::size_t>(axis)]);
    analyze(&ImuSample::a_m, &allan.accelerometer[static_cast<std::size_t>(axis)]);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    allan.moves = allan.moves || DeviationNear(allan.gyroscope[i].curve, 1.0) > kMovingRate ||
                  DeviationNear(allan.accelerometer[i].curve, 1.0) > kMovingAcceleration;
  }
  return allan;
}

std::string AllanCsv(const ImuAllan& allan) {
  std::string text =
      "#tau [s],clusters,gyro x [rad/s],gyro y,gyro z,accelerometer x [m/s^2],accelerometer y,"
      "accelerometer z,fit gyro x [rad/s],fit gyro y,fit gyro z,fit accelerometer x [m/s^2],"
      "fit accelerometer y,fit accelerometer z\n";
  const std::vector<AllanPoint>& taus = allan.gyroscope[0].curve;
  for (std::size_t i = 0; i < taus.size(); ++i) {
    AppendNumber(taus[i].tau_s, &text);
    text += ',';
    AppendNumber(taus[i].clusters, &text);
    for (const bool fitted : {false, true}) {
      for (const auto* sensor : {&allan.gyroscope, &allan.accelerometer}) {
        for (const AxisAllan& axis : *sensor) {
          text += ',';
          AppendNumber(fitted ? axis.fit.Deviation(taus[i].tau_s) : axis.curve[i].deviation, &text);
        }
      }
    }
    text += '\n';
  }
  return text;
}

nlohmann::ordered_json AllanJson(const ImuAllan& allan, const ImuNoise& told) {
  nlohmann::ordered_json json;
  json["start_ns"] = allan.start;
  json["end_ns"] = allan.end;
  json["samples"] = allan.samples;
  json["left_out_samples"] = allan.left_out;
  json["rate_hz"] = allan.rate_hz;
  json["moves"] = allan.moves;
  json["gyroscope"] = SensorJson(allan.gyroscope, "rad/s");
  json["accelerometer"] = SensorJson(allan.accelerometer, "m/s^2");
  json["mean_of_axes"] = DensitiesJson(allan.Noise());
  json["told"] = DensitiesJson(told);
  return json;
}

std::string AllanText(const ImuAllan& allan, const ImuNoise& told) {
  TextTable table({"axis", "white density", "bias walk density", "bias instability", "misfit"});
  const auto add = [&](const std::string& title, const std::array<AxisAllan, 3>& axes,
                       double told_white, double told_walk) {
    table.AddSection(title);
    for (std::size_t i = 0; i < axes.size(); ++i) {
      const AllanFit& fit = axes[i].fit;
      table.AddRow({kAxes[i], Cell(fit.white), Cell(fit.walk), Cell(fit.instability),
                    Number(fit.misfit, 1)});
    }
    table.AddRow({"mean", Scientific(MeanOfAxes(axes, &AllanFit::white)),
                  Scientific(MeanOfAxes(axes, &AllanFit::walk)),
                  Scientific(MeanOfAxes(axes, &AllanFit::instability)), ""});
    table.AddRow({"told", Scientific(told_white), Scientific(told_walk), "", ""});
  };
  add("gyroscope [rad/s/sqrt(Hz), rad/s^2/sqrt(Hz), rad/s]", allan.gyroscope,
      told.gyroscope_density, told.gyroscope_random_walk);
  add("accelerometer [m/s^2/sqrt(Hz), m/s^3/sqrt(Hz), m/s^2]", allan.accelerometer,
      told.accelerometer_density, told.accelerometer_random_walk);
  std::string text = std::to_string(allan.samples) + " samples, " +
                     Number(SecondsBetween(allan.start, allan.end), 1) + " s at " +
                     Number(allan.rate_hz, 1) + " Hz\n" + table.Text();
  if (allan.left_out > 0) {
    text += std::to_string(allan.left_out) +
            " samples left out: the longest stretch without a gap is used\n";
  }
  if (allan.moves) {
    text += "the rig moves: these are no densities of the IMU; record it at rest, motors off\n";
  }
  return text;
}

std::string AllanScript(const ImuAllan& allan, const ImuNoise& told, const std::string& title) {
  const ImuNoise found = allan.Noise();
  std::string quoted;
  for (const char c : title) quoted += c == '\'' ? std::string("''") : std::string(1, c);
  std::string text =
      "# gnuplot allan.gp, in this folder: draws allan.csv as allan.svg, allan.pdf and allan.png.\n"
      "set datafile separator ','\n"
      "set logscale xy\n"
      "set format xy '10^{%T}'\n"
      "set grid xtics ytics lc rgb '#dddddd' lt 1\n"
      "set xlabel 'averaging time {/Symbol t} [s]'\n"
      "set key top center samplen 2 spacing 1.1\n"
      "set bmargin 3.5\n"
      "do for [form in 'svg pdf png'] {\n"
      "  if (form eq 'svg') { set terminal svg size 1000,450 font 'Liberation Sans,13' }\n"
      "  if (form eq 'pdf') { set terminal pdfcairo size 7.2in,3.3in font 'Liberation Sans,9' }\n"
      "  if (form eq 'png') { set terminal pngcairo size 1500,680 font 'Liberation Sans,15' }\n"
      "  set output 'allan.'.form\n"
      "  set multiplot layout 1,2 title '" +
      quoted + "' noenhanced\n";
  const auto plot = [&text](const std::array<AxisAllan, 3>& axes, const std::string& sensor,
                            const std::string& unit, int column, double white, double walk,
                            double told_white, double told_walk) {
    double low = 1e300;
    double high = 0.0;
    for (const AxisAllan& axis : axes) {
      for (const AllanPoint& point : axis.curve) {
        if (point.deviation > 0.0) low = std::min(low, point.deviation);
        high = std::max(high, point.deviation);
      }
    }
    if (high <= 0.0) low = high = 1.0;
    text += "  set ylabel '" + sensor + " [" + unit + "]'\n  set yrange [" +
            FormatNumber(std::pow(10.0, std::floor(std::log10(0.5 * low)))) + ":" +
            FormatNumber(std::pow(10.0, std::ceil(std::log10(3.0 * high)))) + "]\n  plot \\\n";
    const auto line = [&](const std::string& formula, const std::string& style,
                          const std::string& name, bool last) {
      text.append("    ").append(formula).append(" with lines ").append(style);
      text.append(" title '").append(name).append(last ? "'\n" : "', \\\n");
    };
    line("sqrt(" + FormatNumber(told_white) + "**2/x+" + FormatNumber(told_walk) + "**2*x/3)",
         "lw 5 lc rgb '#d8d8d8'", "as sensor.yaml tells", false);
    const std::array<const char*, 3> colors = {"#0072b2", "#d55e00", "#009e73"};
    for (int axis = 0; axis < 3; ++axis) {
      const std::string color = colors[static_cast<std::size_t>(axis)];
      text += "    'allan.csv' using 1:" + std::to_string(column + axis) +
              " with points pt 7 ps 0.45 lc rgb '" + color + "' title '" +
              kAxes[static_cast<std::size_t>(axis)] +
              "', \\\n    'allan.csv' using 1:" + std::to_string(column + axis + 6) +
              " with lines lw 1 lc rgb '" + color + "' notitle, \\\n";
    }
    line(FormatNumber(white) + "/sqrt(x)", "lw 1.5 dt 2 lc rgb '#555555'",
         "white " + Scientific(white), false);
    line(FormatNumber(walk) + "*sqrt(x/3)", "lw 1.5 dt 4 lc rgb '#555555'",
         "walk " + Scientific(walk), true);
  };
  plot(allan.gyroscope, "gyroscope", "rad/s", 3, found.gyroscope_density,
       found.gyroscope_random_walk, told.gyroscope_density, told.gyroscope_random_walk);
  plot(allan.accelerometer, "accelerometer", "m/s^2", 6, found.accelerometer_density,
       found.accelerometer_random_walk, told.accelerometer_density, told.accelerometer_random_walk);
  text +=
      "  unset multiplot\n"
      "  unset output\n"
      "}\n";
  return text;
}

}  // namespace duet
