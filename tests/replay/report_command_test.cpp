// SPDX-License-Identifier: Apache-2.0
// `condyle report`: the numbers of `condyle analyse`, nothing from elsewhere, and text as text.
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "recordings/file_digest.h"
#include "replay/report_page.h"
#include "support/table.h"

namespace condyle {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing_support::data_of;
using testing_support::element;
using testing_support::read_file;
using testing_support::run_condyle;
using testing_support::source_path;

using Report = testing_support::ReportTest;

TEST_F(Report, HoldsTheReadingsOfAnalyse) {
  auto words = with_files("analyse", "session.csv");
  words.emplace_back("--json");
  const auto analysed = run_condyle(words);
  ASSERT_EQ(analysed.exit_code, 0) << analysed.errors;
  words = with_files("report", "session.csv");
  words.insert(words.end(), {"--out", path("report.html")});
  const auto reported = run_condyle(words);
  ASSERT_EQ(reported.exit_code, 0) << reported.errors;
  const std::string page = read_file(path("report.html"));
  EXPECT_EQ(data_of(page).at("readings"), nlohmann::json::parse(analysed.output));
  EXPECT_LE(page.size(), 1'500'000U);
}

// The texts of the cells of class `kind` in `html`.
std::vector<std::string> cells(const std::string& html, const std::string& kind) {
  const std::string opening = "<td class=\"" + kind + "\">";
  std::vector<std::string> texts;
  for (std::size_t at = 0; (at = html.find(opening, at)) != std::string::npos;) {
    at += opening.size();
    texts.push_back(html.substr(at, html.find('<', at) - at));
  }
  return texts;
}

// What a reader sees is the reading, rounded to a place that its interval supports.
TEST_F(Report, ShowsTheReadingsInItsTable) {
  auto words = with_files("report", "session.csv");
  words.insert(words.end(), {"--out", path("report.html")});
  ASSERT_EQ(run_condyle(words).exit_code, 0);
  const std::string page = read_file(path("report.html"));
  const auto shown =
      cells(element(page, "<table data-csv=\"recording_1_readings\">", "</table>"), "n v");
  std::size_t next = 0;
  const auto analysed = data_of(page).at("readings").at("recordings").at(0);
  for (const auto& reading : analysed.at("readings")) {
    if (!reading.at("stroke").is_null() || reading.at("provenance") == "withheld") continue;
    ASSERT_LT(next + 2, shown.size());
    const double half = (reading.at("high").get<double>() - reading.at("low").get<double>()) / 2;
    for (const char* const key : {"value", "low", "high"}) {
      const std::string& text = shown[next++];
      const std::size_t point = text.find('.');
      const double place =
          std::pow(10.0, point == std::string::npos
                             ? 0.0
                             : static_cast<double>(point + 1) - static_cast<double>(text.size()));
      EXPECT_NEAR(std::stod(text), reading.at(key).get<double>(), 0.500001 * place) << reading;
      EXPECT_TRUE(half == 0 || place <= std::max(half, 1e-4)) << reading;
    }
  }
  EXPECT_EQ(next, shown.size());
  EXPECT_GT(next, 100U);
  EXPECT_THAT(page, Not(HasSubstr(">-0.00<")));
}

TEST_F(Report, NeedsNothingFromElsewhere) {
  auto words = with_files("report", "session.csv");
  words.insert(words.end(), {"--out", path("report.html")});
  ASSERT_EQ(run_condyle(words).exit_code, 0);
  const std::string page = read_file(path("report.html"));
  EXPECT_THAT(page, HasSubstr("default-src 'none'"));
  EXPECT_THAT(page, Not(HasSubstr(" src=\"")));
  EXPECT_THAT(page, Not(HasSubstr("<link")));
  EXPECT_THAT(page, HasSubstr("Research use only"));
}

TEST_F(Report, ShowsMarkupInNamesAsText) {
  const std::string hostile = "a<script>alert(1)<b>'&\".csv";
  std::filesystem::copy_file(path("session.csv"), path(hostile));
  auto words = with_files("report", hostile);
  words.insert(words.end(), {"--out", path("report.html")});
  const auto result = run_condyle(words);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::string page = read_file(path("report.html"));
  EXPECT_THAT(page, Not(HasSubstr("<script>alert(1)")));
  EXPECT_THAT(page, HasSubstr("a&lt;script&gt;alert(1)&lt;b&gt;&#39;&amp;&quot;.csv"));
}

TEST_F(Report, NamesFilesByTheirBytesAndShowsWhatTheyState) {
  auto words = with_files("report", "session.csv");
  words.insert(words.end(), {"--out", path("report.html")});
  ASSERT_EQ(run_condyle(words).exit_code, 0);
  const std::string page = read_file(path("report.html"));
  const auto files = data_of(page).at("recordings").at(0).at("identity").at("files");
  ASSERT_EQ(files.size(), 3U);
  const char* const names[] = {"session.csv", "session.landmarks.toml", "session.tasks.csv"};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(files.at(i).at("name"), path(names[i]));
    EXPECT_EQ(files.at(i).at("sha1"), host::file_digest(path(names[i])));
    EXPECT_THAT(page, HasSubstr(files.at(i).at("sha1").get<std::string>()));
  }
  EXPECT_TRUE(data_of(page).at("recordings").at(0).at("identity").at("session").is_null());
  EXPECT_THAT(page, HasSubstr("<td>condyle_left</td>"));
  EXPECT_THAT(page, HasSubstr("<td>jerk_density_m2_s5</td>"));
  EXPECT_THAT(page, HasSubstr("no gap between usable samples"));
  EXPECT_THAT(page, HasSubstr("J. NeuroEng. Rehabil. 12 (2015)"));
}

TEST_F(Report, OfTwoRecordingsKeepsTheGoodOne) {
  const auto result = run_condyle(
      {"report", path("session.csv"), path("missing.csv"), "--out", path("report.html")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("missing.csv"));
  EXPECT_THAT(read_file(path("report.html")), HasSubstr("id=\"recording-1\""));
}

TEST_F(Report, LeavesNoFileAfterAnError) {
  const auto result = run_condyle({"report", path("missing.csv"), "--out", path("report.html")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(path("report.html")));
}

// The fields of a CSV file without quotes, by the names of its columns.
std::vector<std::map<std::string, std::string>> rows_of(const std::string& path) {
  std::ifstream file(path);
  const auto fields = [](const std::string& line) {
    std::vector<std::string> words;
    std::istringstream text(line);
    for (std::string word; std::getline(text, word, ',');) words.push_back(word);
    return words;
  };
  std::string line;
  std::getline(file, line);
  const auto names = fields(line);
  std::vector<std::map<std::string, std::string>> rows;
  while (std::getline(file, line)) {
    const auto words = fields(line);
    auto& row = rows.emplace_back();
    for (std::size_t i = 0; i < names.size() && i < words.size(); ++i) row[names[i]] = words[i];
  }
  return rows;
}

TEST_F(Report, ComparesSessionsAsCompareDoes) {
  for (int i = 1; i <= 4; ++i) {
    ASSERT_EQ(
        run_condyle({"simulate", source_path("/host_sim/scenarios/clinical_session.toml"), "--seed",
                     std::to_string(i), "--out", path("s" + std::to_string(i) + ".csv")})
            .exit_code,
        0);
  }
  const std::vector<std::string> sessions = {
      "--session", "before=" + path("s1.csv") + "," + path("s2.csv"), "--session",
      "<b>after=" + path("s3.csv") + "," + path("s4.csv")};
  std::vector<std::string> words = {"compare", "--out", path("sessions.csv")};
  words.insert(words.end(), sessions.begin(), sessions.end());
  ASSERT_EQ(run_condyle(words).exit_code, 0);
  words = {"report",
           "--out",
           path("report.html"),
           "--landmarks",
           path("session.landmarks.toml"),
           "--tasks",
           path("session.tasks.csv")};
  words.insert(words.end(), sessions.begin(), sessions.end());
  const auto result = run_condyle(words);
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::string page = read_file(path("report.html"));
  EXPECT_THAT(page, Not(HasSubstr("<b>after")));

  const auto data = data_of(page);
  std::map<std::string, nlohmann::json> motion;
  for (const auto& quantity : data.at("sessions").at("motion")) {
    motion[quantity.at("column")] = quantity;
  }
  const auto rows = rows_of(path("sessions.csv"));
  EXPECT_FALSE(rows.empty());
  for (const auto& row : rows) {
    const auto& change = motion.at(row.at("quantity")).at("changes").at(0);
    for (const char* name : {"mean_from", "mean_to", "change", "smallest_change", "probability"}) {
      EXPECT_NEAR(change.at(name).get<double>(), std::stod(row.at(name)),
                  1e-6 * (1e-6 + std::abs(std::stod(row.at(name)))))
          << row.at("quantity") << " " << name;
    }
  }

  // A compared reading has the values of the recordings' own readings.
  std::size_t compared = 0;
  for (const auto& quantity : data.at("sessions").at("readings")) {
    if (quantity.at("quantity") != "opening, opening_mm") continue;
    ++compared;
    std::vector<double> expected;
    for (const auto& recording : data.at("readings").at("recordings")) {
      for (const auto& reading : recording.at("readings")) {
        if (reading.at("reading") == "opening_mm" && reading.at("stroke").is_null()) {
          expected.push_back(reading.at("value"));
        }
      }
    }
    ASSERT_EQ(expected.size(), 4U);
    const auto& values = quantity.at("values");
    EXPECT_EQ(values.at(0).get<std::vector<double>>(),
              std::vector<double>(expected.begin(), expected.begin() + 2));
    EXPECT_EQ(values.at(1).get<std::vector<double>>(),
              std::vector<double>(expected.begin() + 2, expected.end()));
    EXPECT_TRUE(quantity.at("changes").at(0).at("smallest_change").get<double>() > 0);
  }
  EXPECT_EQ(compared, 1U);
}

TEST_F(Report, ShowsFrictionAndMassOfReplay) {
  ASSERT_EQ(run_condyle({"simulate", source_path("/host_sim/scenarios/point_mass.toml"), "--out",
                         path("driven.csv")})
                .exit_code,
            0);
  const std::vector<std::string> drive = {"--drive", path("driven.drive.csv"), "--drive-missing",
                                          "0",       "--drive-delay-sd-ms",    "0.5"};
  // The report's lag of 50 ms at 60 samples a second.
  std::vector<std::string> words = {"replay", path("driven.csv"), "--lag", "3", "--json"};
  words.insert(words.end(), drive.begin(), drive.end());
  const auto replayed = run_condyle(words);
  ASSERT_EQ(replayed.exit_code, 0) << replayed.errors;
  words = {"report", path("driven.csv"), "--out", path("report.html")};
  words.insert(words.end(), drive.begin(), drive.end());
  const auto reported = run_condyle(words);
  ASSERT_EQ(reported.exit_code, 0) << reported.errors;
  const std::string page = read_file(path("report.html"));
  const auto identified = data_of(page).at("recordings").at(0).at("estimates").at("identified");
  EXPECT_EQ(identified, nlohmann::json::parse(replayed.output).at("identified"));
  EXPECT_EQ(identified.at("mass_kg").at("provenance"), "measured");
  EXPECT_THAT(page, HasSubstr("class=\"known\""));

  // Without the statement the mass is not known: the page shows the prior alone, as assumed.
  words = {"report", path("driven.csv"), "--drive", path("driven.drive.csv"),
           "--out",  path("report.html")};
  ASSERT_EQ(run_condyle(words).exit_code, 0);
  const std::string unknown = read_file(path("report.html"));
  EXPECT_THAT(unknown, Not(HasSubstr("class=\"known\"")));
  EXPECT_THAT(unknown, HasSubstr("--drive-missing SHARE"));
  EXPECT_THAT(unknown, Not(HasSubstr("data-chart=\"mass\"")));
}

TEST_F(Report, OfAMinuteAt200HzIsSmall) {
  std::ofstream(path("minute.toml"))
      << "[kinematic]\n[rest]\nduration_s = 3\n[opening]\nstrokes = 3\n[chewing]\n"
         "duration_s = 46\n[facebow]\nrate_Hz = 200\nnoise_m = 0.00002\nnoise_rad = 0.0008\n"
         "[landmarks]\ncondyle_sd_mm = 1\nincisor_sd_mm = 0.5\nplane_sd_mm = 1\n";
  ASSERT_EQ(run_condyle({"simulate", path("minute.toml"), "--out", path("minute.csv")}).exit_code,
            0);
  const auto result =
      run_condyle({"report", path("minute.csv"), "--landmarks", path("minute.landmarks.toml"),
                   "--tasks", path("minute.tasks.csv"), "--out", path("report.html")});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  const std::string page = read_file(path("report.html"));
  const auto data = data_of(page);
  EXPECT_GT(data.at("readings").at("recordings").at(0).at("duration_s").get<double>(), 59);
  EXPECT_LE(page.size(), 1'500'000U);
}

TEST_F(Report, RefusesSessionsAndDrivesThatDoNotFit) {
  const std::string session = path("session.csv");
  const std::vector<std::pair<std::vector<std::string>, const char*>> cases = {
      {{}, "has no recording"},
      {{"--session", "a=" + session}, "one session cannot be compared"},
      {{session, "--session", "a=" + session, "--session", "b=" + session},
       "cannot be combined with recordings outside a session"},
      {{session, "--drive-missing", "0"}, "has no drive"},
      {{session, path("other.csv"), "--drive", path("x.csv")}, "belongs to one recording"}};
  for (const auto& [words, message] : cases) {
    std::vector<std::string> all = {"report"};
    all.insert(all.end(), words.begin(), words.end());
    all.insert(all.end(), {"--out", path("report.html")});
    const auto result = run_condyle(all);
    EXPECT_EQ(result.exit_code, 2) << message;
    EXPECT_THAT(result.errors, HasSubstr(message));
    EXPECT_FALSE(std::filesystem::exists(path("report.html"))) << message;
  }
}

}  // namespace
}  // namespace condyle
