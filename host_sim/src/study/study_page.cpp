// SPDX-License-Identifier: Apache-2.0
// The study's page: recordings that need a look, scatter of repeats, and each reading of all
// subjects. It has no script.
#include <fmt/format.h>

#include <algorithm>

#include "report/html_text.h"
#include "study/group_level.h"
#include "study/study_plot.h"

namespace condyle::host {
namespace {

constexpr const char* kStyle = R"(
body { font: 15px/1.45 system-ui, sans-serif; color: #1a1a1a; background: #fff; margin: 1.5em auto;
  max-width: 70em; padding: 0 1em }
h1 { font-size: 1.5em } h2 { font-size: 1.2em; margin-top: 2em }
table { border-collapse: collapse; margin: .7em 0 } th, td { border-bottom: 1px solid #bbb;
  padding: .2em .8em .2em 0; text-align: left; vertical-align: top }
td.number { text-align: right; font-variant-numeric: tabular-nums }
.banner { border-left: 4px solid #444; background: #f2f2f2; padding: .5em 1em }
.plots { display: flex; flex-wrap: wrap; gap: 1em }
figure { margin: 0 } figcaption { font-size: .85em; max-width: 260px }
svg text { font: 11px system-ui, sans-serif; fill: #1a1a1a }
@media print { body { max-width: none } figure { break-inside: avoid } }
)";

// Of these a page stays readable; the tables hold all.
constexpr std::size_t kMostLooks = 50, kMostPlots = 60, kLeastSubjects = 3;

struct Look {
  const StudyOutcome* outcome;
  std::string why;
  double shown_share;  // of the readings that recordings of its task usually show
};

// The recordings with problems, then those that show least.
std::vector<Look> looks_of(const StudyTables& tables) {
  std::map<std::string, std::vector<double>> shown;
  for (const StudyOutcome& outcome : tables.outcomes) {
    if (outcome.problem.empty()) {
      shown[outcome.recording.task].push_back(static_cast<double>(outcome.shown));
    }
  }
  for (auto& [task, counts] : shown) std::sort(counts.begin(), counts.end());
  std::vector<Look> looks;
  for (const StudyOutcome& outcome : tables.outcomes) {
    if (!outcome.problem.empty()) {
      looks.push_back({&outcome, outcome.problem, -1});
      continue;
    }
    const std::vector<double>& counts = shown[outcome.recording.task];
    const double usual = counts[counts.size() / 2], own = static_cast<double>(outcome.shown);
    if (own >= 0.8 * usual && outcome.shown > 0) continue;
    looks.push_back({&outcome,
                     fmt::format("{} readings shown, {} withheld; recordings of this task usually "
                                 "show {:.0f}",
                                 outcome.shown, outcome.withheld, usual),
                     usual > 0 ? own / usual : 0});
  }
  std::stable_sort(looks.begin(), looks.end(),
                   [](const Look& a, const Look& b) { return a.shown_share < b.shown_share; });
  return looks;
}

std::string looks_table(const StudyTables& tables) {
  const std::vector<Look> looks = looks_of(tables);
  if (looks.empty()) return "<p>None: every recording shows what its task usually shows.</p>\n";
  std::string text =
      "<table>\n<tr><th>recording</th><th>subject</th><th>session</th><th>task</th>"
      "<th>why</th></tr>\n";
  for (std::size_t i = 0; i < std::min(looks.size(), kMostLooks); ++i) {
    const StudyRecording& recording = looks[i].outcome->recording;
    text += fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td><td>{}</td><td>{}</td></tr>\n",
                        html_text(recording.recording), html_text(recording.subject),
                        html_text(recording.session), html_text(recording.task),
                        html_text(looks[i].why));
  }
  text += "</table>\n";
  if (looks.size() > kMostLooks) {
    text += fmt::format("<p>And {} more; those with problems are in problems.csv.</p>\n",
                        looks.size() - kMostLooks);
  }
  return text;
}

std::string scatter_table(const StudyTables& tables) {
  std::string text =
      "<table>\n<tr><th>reading</th><th>subjects</th><th>sd within sessions (95 %); smallest "
      "detectable change</th><th>sd between sessions (95 %); smallest detectable "
      "change</th></tr>\n";
  for (const auto& [key, reading] : tables.readings) {
    const std::string repeats = scatter_text(reading.repeats, reading.unit);
    const std::string retests = scatter_text(reading.retests, reading.unit);
    text += fmt::format("<tr><td>{}</td><td class=\"number\">{}</td><td>{}</td><td>{}</td></tr>\n",
                        html_text(reading_title(key)), reading.subjects,
                        repeats.empty() ? "not known: no repeats" : html_text(repeats),
                        retests.empty() ? "not known: one session" : html_text(retests));
  }
  return text + "</table>\n";
}

std::string plots(const StudyTables& tables) {
  std::string text;
  std::size_t count = 0, boxes = 0;
  for (const auto& [key, reading] : tables.readings) {
    if (reading.subjects < kLeastSubjects || count == kMostPlots) continue;
    text += study_plot(reading_title(key), reading.unit, sessions_of(tables, reading));
    ++count;
    if (reading.subjects > kMostSubjectsDrawn) ++boxes;
  }
  if (count == 0) {
    return fmt::format("<p>None: no reading is shown for {} subjects or more.</p>\n",
                       kLeastSubjects);
  }
  std::string words;
  if (boxes < count) {
    words =
        "<p>Each line is a subject, each point the mean of a session's recordings, each bar the "
        "mean of their 95 % intervals.</p>\n";
  }
  if (boxes > 0) {
    words += fmt::format(
        "<p>A reading of more than {} subjects has a box for each session. The box holds the "
        "middle half of the subjects' means, its thick line is their median, the bar holds the "
        "middle 95 %, and the points are the lowest and the highest subject.</p>\n",
        kMostSubjectsDrawn);
  }
  return words + "<div class=\"plots\">\n" + text + "</div>\n";
}

}  // namespace

std::string study_page(const StudyTables& tables) {
  std::string text = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src "
      "'unsafe-inline'\">\n<meta name=\"viewport\" content=\"width=device-width\">\n"
      "<title>Study of jaw motion</title>\n<style>{}</style></head><body>\n"
      "<h1>Study of jaw motion</h1>\n"
      "<p class=\"banner\">Research use only. Not a diagnosis. No reading is compared with a norm."
      "</p>\n",
      kStyle);
  const auto analysed =
      std::count_if(tables.outcomes.begin(), tables.outcomes.end(),
                    [](const StudyOutcome& outcome) { return outcome.problem.empty(); });
  text += fmt::format("<p>{} of {} recordings were analysed, by condyle {}.</p>\n", analysed,
                      tables.outcomes.size(), CONDYLE_VERSION);
  text += "<h2>Recordings to look at first</h2>\n" + looks_table(tables);
  text += "<h2>All subjects</h2>\n" + plots(tables);
  text +=
      "<h2>Scatter</h2>\n<p>Standard deviation, pooled over subjects, and the smallest change "
      "from one recording to another that exceeds it at 95 %. The scatter between sessions "
      "includes real changes of the subjects, the day, and mounting the instrument anew. "
      "Bland and Altman, BMJ 312 (1996) 1654.</p>\n" +
      scatter_table(tables);
  return text + "</body></html>\n";
}

}  // namespace condyle::host
