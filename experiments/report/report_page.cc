#include <string>
#include <string_view>

#include "experiments/report/page_text.h"
#include "experiments/report/report.h"
#include "experiments/report/report_data.h"
#include "experiments/report/table_html.h"
#include "experiments/report/web_bundle.h"

namespace duet {
namespace {

constexpr std::size_t kShortHash = 16;
constexpr std::size_t kSentencesShown = 7;  ///< of the summary, before a reader asks for more

std::string Element(const std::string& tag, std::string_view text, const std::string& more = "") {
  return "<" + tag + (more.empty() ? "" : " " + more) + ">" + EscapeHtml(text) + "</" + tag + ">\n";
}

std::string SectionStart(const std::string& id, const std::string& title) {
  return "<section id=\"" + id + "\" aria-labelledby=\"" + id + "-title\">\n<h2 id=\"" + id +
         "-title\">" + title + "</h2>\n";
}

std::string Head(const Report& report, const WebBundle& bundle) {
  // Nothing but this page's own script and style, and pictures that are in it: no network.
  const std::string policy = "default-src 'none'; img-src data:; style-src " +
                             ContentHash(bundle.style) + "; script-src " +
                             ContentHash(bundle.script);
  std::string html =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"" +
      policy + "\">\n" + Element("title", report.title + " \xE2\x80\x93 Duet") + "<style>";
  html += bundle.style;
  html += "</style>\n</head>\n";
  return html;
}

bool HasTables(const Report& report) { return !report.texts.empty() || !report.tables.empty(); }

std::string PageHeader(const Report& report) {
  std::string html =
      "<a class=\"skip\" href=\"#main\">Skip to the report</a>\n<header class=\"page\">\n";
  html += Element("p", "Duet, report of a " + report.kind, "class=\"kind\"");
  html += Element("h1", report.title);
  if (!report.question.empty()) html += Element("p", report.question, "class=\"question\"");
  html += "<nav class=\"contents\" aria-label=\"Contents\">\n";
  const auto link = [&html](const char* id, const char* text) {
    html += std::string("<a href=\"#") + id + "\">" + text + "</a>\n";
  };
  link("summary", "Summary");
  link("explore", "Runs in space and over time");
  if (HasTables(report)) link("tables", "Tables");
  if (!report.figures.empty()) link("figures", "Figures");
  link("records", "Records");
  return html + "</nav>\n</header>\n";
}

// Sentences [begin, end) as a list.
std::string SentenceList(const Report& report, std::size_t begin, std::size_t end) {
  std::string html = "<ul class=\"summary\">\n";
  for (std::size_t i = begin; i < end; ++i) html += Element("li", report.summary[i]);
  return html + "</ul>\n";
}

std::string Summary(const Report& report) {
  const std::size_t count = report.summary.size();
  // One more is no longer than the line that would hide it.
  const std::size_t shown = count > kSentencesShown + 1 ? kSentencesShown : count;
  std::string html = SectionStart("summary", "Summary") + SentenceList(report, 0, shown);
  if (shown < count) {
    html += "<details><summary>" + std::to_string(count - shown) + " more sentences</summary>\n" +
            SentenceList(report, shown, count) + "</details>\n";
  }
  if (!report.overview.columns.empty()) html += TableHtml(report.overview);
  return html + "</section>\n";
}

std::string Explorer() {
  return SectionStart("explore", "Runs in space and over time") +
         "<div id=\"explorer\"></div>\n<noscript><p class=\"note\">This part needs JavaScript; "
         "the rest of the page does not.</p></noscript>\n</section>\n";
}

std::string Tables(const Report& report) {
  if (!HasTables(report)) return "";
  std::string html = SectionStart("tables", "Tables");
  std::string said;  // a metric's two tables have the same verdict
  for (StudyTable table : report.tables) {
    if (table.verdict == said) {
      table.verdict.clear();
    } else {
      said = table.verdict;
    }
    html += Element("h3", table.title) + TableHtml(table);
  }
  for (const ReportText& text : report.texts) {
    html += Element("h3", text.title) + Element("pre", text.text, "tabindex=\"0\"");
  }
  return html + "</section>\n";
}

// As pictures: their styles, names and scripts (there should be none) stay their own.
std::string Figures(const Report& report) {
  if (report.figures.empty()) return "";
  std::string html = SectionStart("figures", "Figures") + "<div class=\"figures\">\n";
  for (const ReportFigure& figure : report.figures) {
    html += "<figure id=\"figure-" + EscapeHtml(figure.name) + "\">\n<img alt=\"" +
            EscapeHtml(figure.name) + "\" src=\"data:" + EscapeHtml(figure.media_type) +
            ";base64," + Base64(figure.bytes) + "\">\n" + Element("figcaption", figure.title) +
            "</figure>\n";
  }
  return html + "</div>\n</section>\n";
}

std::string Records(const Report& report, const WebBundle& bundle) {
  std::string html = "<footer class=\"page\">\n" + SectionStart("records", "Records");
  for (const std::string& line : report.foot) html += Element("p", line);
  html +=
      "<details><summary>What this page was made from</summary>\n<div class=\"table-box\"><table>\n"
      "<thead><tr><th scope=\"col\">record</th><th scope=\"col\">program</th>"
      "<th scope=\"col\">tracks, SHA-256</th><th scope=\"col\">settings, SHA-256</th>"
      "<th scope=\"col\">outcome</th></tr></thead>\n<tbody>\n";
  for (const ReportRun& run : report.runs) {
    html += "<tr>" + Element("th", run.record.generic_string(), "scope=\"row\"") +
            Element("td", run.program) +
            Element("td", run.run.tracks_sha256.substr(0, kShortHash)) +
            Element("td", run.settings_sha256.substr(0, kShortHash)) +
            Element("td", run.run.failed ? "failed: " + run.run.reason : "done") + "</tr>\n";
  }
  html += "</tbody></table></div></details>\n";
  html += "<details><summary>Libraries in this page</summary>\n" +
          Element("pre", bundle.licences, "tabindex=\"0\"") + "</details>\n";
  return html + "</section>\n</footer>\n";
}

}  // namespace

std::string ReportPage(const Report& report) {
  const WebBundle bundle = GetWebBundle();
  std::string html = Head(report, bundle) + "<body>\n" + PageHeader(report) +
                     "<main id=\"main\">\n" + Summary(report) + Explorer() + Tables(report) +
                     Figures(report) + "</main>\n" + Records(report, bundle);
  html += "<script type=\"application/json\" id=\"report-data\">" +
          EscapeScriptJson(ReportDataJson(report)) + "</script>\n<script>";
  html += bundle.script;
  return html + "</script>\n</body>\n</html>\n";
}

}  // namespace duet
