// SPDX-License-Identifier: Apache-2.0
// `condyle report`: what it draws otherwise, leaves out, or withholds.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <utility>

#include "replay/report_page.h"
#include "support/table.h"

namespace condyle {
namespace {

using testing::HasSubstr;
using testing_support::data_of;
using testing_support::read_file;
using testing_support::run_condyle;
using testing_support::source_path;

using ReportCharts = testing_support::ReportTest;

// The first estimates are assumed, as `replay` says, and the charts draw them otherwise.
TEST_F(ReportCharts, MarksWhatIsAssumed) {
  ASSERT_EQ(
      run_condyle({"replay", path("session.csv"), "--lag", "3", "--out", path("e.csv")}).exit_code,
      0);
  auto words = with_files("report", "session.csv");
  words.insert(words.end(), {"--out", path("report.html")});
  ASSERT_EQ(run_condyle(words).exit_code, 0);
  const auto estimates = testing_support::read_table(path("e.csv"));
  const auto series = data_of(read_file(path("report.html"))).at("recordings").at(0).at("series");
  ASSERT_EQ(series.at("samples_per_point"), 1);
  for (const auto& chart : series.at("charts")) {
    const auto& provenance =
        estimates.columns.at(chart.at("key").get<std::string>() + "_provenance");
    std::vector<bool> marked(provenance.size());
    for (const auto& stretch : chart.at("curves").at(2).at("assumed")) {  // z, which replay follows
      for (std::size_t i = stretch.at(0); i <= stretch.at(1); ++i) marked.at(i) = true;
    }
    std::size_t assumed = 0;
    for (std::size_t i = 0; i < provenance.size(); ++i) {
      EXPECT_EQ(marked[i], provenance[i] == "assumed") << chart.at("key") << ' ' << i;
      if (marked[i]) ++assumed;
    }
    EXPECT_GT(assumed, 0U);
    EXPECT_LT(assumed, 20U);
  }
}

// The count of what is withheld stands before any number, with a link to the names.
TEST_F(ReportCharts, BeginWithWhatIsWithheld) {
  std::string scenario = read_file(source_path("/host_sim/scenarios/clinical_session.toml"));
  for (const auto& [key, value] :
       {std::pair{"noise_m = ", "0.0001 # "}, {"noise_rad = ", "0.002 # "}}) {
    scenario.insert(scenario.find(key) + std::string(key).size(), value);
  }
  ASSERT_EQ(run_condyle(
                {"simulate", folder_.write("coarse.toml", scenario), "--out", path("session.csv")})
                .exit_code,
            0);
  auto words = with_files("report", "session.csv");
  words.insert(words.end(), {"--out", path("report.html")});
  ASSERT_EQ(run_condyle(words).exit_code, 0);
  const std::string page = read_file(path("report.html"));
  std::set<std::string> withheld;
  const auto readings = data_of(page).at("readings");
  for (const auto& recording : readings.at("recordings")) {
    for (const auto& reading : recording.at("readings")) {
      if (reading.at("provenance") != "withheld" || !reading.at("stroke").is_null()) continue;
      withheld.insert(reading.at("task").get<std::string>() +
                      reading.at("side").get<std::string>() +
                      reading.at("reading").get<std::string>());
    }
  }
  ASSERT_GT(withheld.size(), 3U);
  const std::string title =
      "<strong>" + std::to_string(withheld.size()) + " readings are withheld</strong>";
  EXPECT_LT(page.find(title), page.find("<h3"));
  EXPECT_THAT(page, HasSubstr("<a href=\"#recording_1_withheld\">"));
  EXPECT_THAT(page, HasSubstr("<div id=\"recording_1_withheld\">"));
}

// Each row that is left out makes a step of two; ten in a row make one gap.
TEST_F(ReportCharts, DrawsGaps) {
  std::ifstream whole(path("session.csv"));
  std::ofstream cut(path("cut.csv"));
  std::string line;
  for (int row = 0; std::getline(whole, line); ++row) {
    if (row != 500 && row != 900 && (row < 2000 || row >= 2010)) cut << line << '\n';
  }
  cut.close();
  auto words = with_files("report", "cut.csv");
  words.insert(words.end(), {"--out", path("report.html")});
  const auto result = run_condyle(words);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::string page = read_file(path("report.html"));
  EXPECT_THAT(page, HasSubstr("3 gaps longer than 1.5 usual steps without a usable sample: 0.2 s"));
  EXPECT_THAT(page, HasSubstr("the longest 0.183 s"));
  EXPECT_THAT(page, HasSubstr("not drawn: 1 step of more than 50 ms"));
  // The path is in two pieces in three planes of the incisor and two of each condyle.
  const auto pieces = [](const std::string& text) {
    int count = 0;
    const std::string piece = "<polyline class=\"path left\"";
    for (std::size_t at = text.find(piece); at != std::string::npos; ++count) {
      at = text.find(piece, at + 1);
    }
    return count;
  };
  words = with_files("report", "session.csv");
  words.insert(words.end(), {"--out", path("whole.html")});
  ASSERT_EQ(run_condyle(words).exit_code, 0);
  EXPECT_EQ(pieces(page), pieces(read_file(path("whole.html"))) + 3 + 2 * 2);
}

// Each of 100 tasks takes 20 s. The drawing of a recording says so, and that of all sessions.
TEST_F(ReportCharts, SayWhichTasksAreNotDrawn) {
  std::ofstream tasks(path("many.csv"));
  tasks << "task,begin_s,end_s\n";
  for (int i = 0; i < 100; ++i) tasks << "border,48,68\n";
  tasks.close();
  ASSERT_EQ(run_condyle({"simulate", source_path("/host_sim/scenarios/clinical_session.toml"),
                         "--seed", "2", "--out", path("second.csv")})
                .exit_code,
            0);
  const auto result =
      run_condyle({"report", "--landmarks", path("session.landmarks.toml"), "--tasks",
                   path("many.csv"), "--session", "a=" + path("session.csv"), "--session",
                   "b=" + path("second.csv"), "--out", path("report.html")});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::string page = read_file(path("report.html"));
  const std::string note = "Only 25 of 100 tasks are drawn. Of 25 tasks, only parts are drawn.</p>";
  EXPECT_THAT(page, HasSubstr("<p>" + note));
  EXPECT_THAT(page, HasSubstr("<p>" + path("session.csv") + ": " + note));
  EXPECT_THAT(page, HasSubstr("<p>" + path("second.csv") + ": " + note));
}

// One axis has no readings, but gaps as well: rows that are not there and a position that is not.
TEST_F(ReportCharts, DrawsGapsOfOneAxis) {
  std::ifstream whole(source_path("/host_sim/recordings/chewing_60hz.csv"));
  std::ofstream cut(path("cut.csv"));
  std::string line;
  for (int row = 0; std::getline(whole, line); ++row) {
    if (row == 300) line.resize(line.find(',') + 1);
    if (row != 150 && (row < 500 || row >= 510)) cut << line << '\n';
  }
  cut.close();
  const auto result = run_condyle({"report", path("cut.csv"), "--out", path("report.html")});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::string page = read_file(path("report.html"));
  EXPECT_THAT(page, HasSubstr("No readings:"));
  EXPECT_THAT(page, HasSubstr("3 gaps longer than 1.5 usual steps without a usable sample: 0.2 s"));
  EXPECT_THAT(page, HasSubstr("the longest 0.183 s"));
}

// Of many markers without a choice nothing can be shown.
TEST_F(ReportCharts, OfMarkersThatAreNoBodyNamesThem) {
  std::string text = "time_s";
  for (const char* point : {"a", "b", "c", "d"}) {
    for (const char axis : {'x', 'y', 'z'}) text += std::string(",") + point + "_" + axis + "_mm";
  }
  text += "\n";
  for (int row = 0; row < 400; ++row) {
    text += std::to_string(row * 0.01);
    for (int k = 0; k < 12; ++k) {
      text += "," + std::to_string(40.0 * k * k + 20 * std::sin(0.02 * row * (k % 5 + 1)));
    }
    text += "\n";
  }
  const std::string file = folder_.write("markers.csv", text);
  const auto result = run_condyle({"report", file, "--out", path("report.html")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("4 points, a, b, c, d, are not one rigid body"));
  EXPECT_THAT(result.errors, HasSubstr("--marker NAME"));
  EXPECT_FALSE(std::filesystem::exists(path("report.html")));
  EXPECT_EQ(run_condyle({"report", file, "--marker", "b", "--out", path("report.html")}).exit_code,
            0);
}

}  // namespace
}  // namespace condyle
