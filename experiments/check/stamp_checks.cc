#include "experiments/check/stamp_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

namespace duet {
namespace {

double MedianOf(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

const char* SeverityName(Severity severity) {
  switch (severity) {
    case Severity::kInfo:
      return "info";
    case Severity::kWarning:
      return "warning";
    case Severity::kError:
      return "error";
  }
  return "unknown";
}

std::string Sentence(const char* format, ...) {
  char buffer[512];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(buffer, sizeof(buffer), format, arguments);
  va_end(arguments);
  return buffer;
}

std::string SinceOrigin(Timestamp t, Timestamp origin) {
  return Sentence("%.3f s", SecondsBetween(origin, t));
}

StampStatistics MeasureStamps(const std::vector<Timestamp>& stamps) {
  StampStatistics statistics;
  statistics.count = static_cast<int>(stamps.size());
  if (stamps.size() < 2) return statistics;
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    steps.push_back(SecondsBetween(stamps[i - 1], stamps[i]));
  }
  const double median = MedianOf(steps);
  statistics.span_s = SecondsBetween(stamps.front(), stamps.back());
  statistics.rate_hz = 1.0 / median;
  std::vector<double> deviations;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    if (steps[i] > statistics.longest_s) {
      statistics.longest_s = steps[i];
      statistics.longest_at = stamps[i];
    }
    if (steps[i] > 1.5 * median) {
      ++statistics.gaps;
      statistics.missing += static_cast<int>(std::lround(steps[i] / median)) - 1;
    } else {
      deviations.push_back(std::abs(steps[i] - median));
    }
  }
  if (!deviations.empty()) {
    std::sort(deviations.begin(), deviations.end());
    statistics.jitter_s = deviations[deviations.size() * 95 / 100];
  }
  return statistics;
}

Findings CheckStamps(const std::string& what, const std::vector<Timestamp>& stamps,
                     double told_rate_hz, double usable_gap_s, Timestamp origin) {
  const StampStatistics s = MeasureStamps(stamps);
  Findings findings;
  if (s.count < 2) {
    findings.push_back({Severity::kError, what + ".empty",
                        what + " has " + std::to_string(s.count) + " samples",
                        "Check that the whole recording was copied."});
    return findings;
  }
  findings.push_back({Severity::kInfo,
                      what + ".rate",
                      Sentence("%s: %d samples over %.2f s, %.2f Hz, jitter %.2f ms", what.c_str(),
                               s.count, s.span_s, s.rate_hz, 1e3 * s.jitter_s),
                      "",
                      {{"count", static_cast<double>(s.count)},
                       {"span_s", s.span_s},
                       {"rate_hz", s.rate_hz},
                       {"jitter_s", s.jitter_s}}});
  // Rates are told in round numbers; a fifth off is another setting of the driver.
  if (told_rate_hz > 0.0 && std::abs(s.rate_hz / told_rate_hz - 1.0) > 0.2) {
    findings.push_back({Severity::kWarning,
                        what + ".rate_told",
                        Sentence("%s: sensor.yaml says %g Hz, the stamps %.2f Hz", what.c_str(),
                                 told_rate_hz, s.rate_hz),
                        "Correct rate_hz, or find out whether samples were dropped evenly.",
                        {{"told_hz", told_rate_hz}, {"rate_hz", s.rate_hz}}});
  }
  if (s.jitter_s * s.rate_hz > 0.1) {
    findings.push_back({Severity::kWarning,
                        what + ".jitter",
                        Sentence("%s: steps scatter by %.1f %% of their length", what.c_str(),
                                 100.0 * s.jitter_s * s.rate_hz),
                        "Stamps look like times of arrival: use those of the sensor's clock.",
                        {{"jitter_s", s.jitter_s}}});
  }
  if (s.gaps > 0) {
    const bool unusable = usable_gap_s > 0.0 && s.longest_s > usable_gap_s;
    findings.push_back(
        {unusable ? Severity::kError : Severity::kWarning,
         what + ".gap",
         Sentence("%s: %d gap%s, %d samples missing, the longest %.1f ms at %s", what.c_str(),
                  s.gaps, s.gaps == 1 ? "" : "s", s.missing, 1e3 * s.longest_s,
                  SinceOrigin(s.longest_at, origin).c_str()),
         unusable ? "Frames whose interval holds it can't be used: cut the recording there "
                    "(--start, --duration)."
                  : "Look for what was lost while recording; estimators bridge it.",
         {{"gaps", static_cast<double>(s.gaps)},
          {"missing", static_cast<double>(s.missing)},
          {"longest_s", s.longest_s}}});
  }
  return findings;
}

Findings CheckSynchrony(const std::vector<Timestamp>& first, const std::vector<Timestamp>& second) {
  Findings findings;
  if (first.size() < 2 || second.size() < 2) return findings;
  const Timestamp begin = std::max(first.front(), second.front());
  const Timestamp end = std::min(first.back(), second.back());
  if (begin > end) {
    findings.push_back({Severity::kError, "cameras.overlap",
                        "the two cameras have no time in common", "Use one camera (--cameras 0)."});
    return findings;
  }
  const double period_s = 1.0 / MeasureStamps(first).rate_hz;
  int equal = 0;
  int inside = 0;
  std::vector<double> offsets_s;
  for (const Timestamp t : first) {
    if (t < begin || t > end) continue;
    ++inside;
    auto next = std::lower_bound(second.begin(), second.end(), t);
    double best_s = 1e9;
    for (auto it = next == second.begin() ? next : next - 1; it != second.end() && it <= next;
         ++it) {
      const double offset_s = SecondsBetween(t, *it);
      if (std::abs(offset_s) < std::abs(best_s)) best_s = offset_s;
    }
    if (best_s == 0.0) ++equal;
    if (std::abs(best_s) < 0.5 * period_s) offsets_s.push_back(best_s);
  }
  const double median_s = MedianOf(offsets_s);
  double largest_s = 0.0;
  for (const double offset_s : offsets_s) largest_s = std::max(largest_s, std::abs(offset_s));
  if (equal == inside) {
    findings.push_back({Severity::kInfo,
                        "cameras.synchrony",
                        Sentence("the cameras' stamps are equal (%d pairs)", equal),
                        "",
                        {{"pairs", static_cast<double>(equal)}}});
  } else {
    findings.push_back(
        {Severity::kWarning,
         "cameras.synchrony",
         Sentence("of %d stamps of the first camera %d have an equal one in the second; the median "
                  "offset is %.3f ms, the largest %.3f ms",
                  inside, equal, 1e3 * median_s, 1e3 * largest_s),
         largest_s < 1e-3 && offsets_s.size() == static_cast<std::size_t>(inside)
             ? "The trigger is common but the stamps are not: give each pair one stamp."
             : "Only pairs with equal stamps are used in stereo: repair the stamps, or use one "
               "camera (--cameras 0).",
         {{"median_offset_s", median_s}, {"largest_offset_s", largest_s}}});
  }
  const double outside_s = SecondsBetween(std::min(first.front(), second.front()), begin) +
                           SecondsBetween(end, std::max(first.back(), second.back()));
  if (outside_s > period_s) {
    findings.push_back({Severity::kInfo,
                        "cameras.span",
                        Sentence("one of the cameras alone has %.2f s of the time", outside_s),
                        "Stereo uses what both have.",
                        {{"outside_s", outside_s}}});
  }
  return findings;
}

}  // namespace duet
