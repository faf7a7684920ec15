// SPDX-License-Identifier: Apache-2.0
// `condyle report`: the numbers of `condyle analyse`, nothing from elsewhere, and text as text.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "support/command.h"
#include "support/paths.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing_support::run_condyle;
using testing_support::source_path;
using testing_support::TemporaryFolder;

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

// The content of the element that begins with `opening`.
std::string element(const std::string& page, const std::string& opening, const std::string& end) {
  const std::size_t begin = page.find(opening);
  if (begin == std::string::npos) return {};
  const std::size_t content = begin + opening.size();
  return page.substr(content, page.find(end, content) - content);
}

class Report : public testing::Test {
 protected:
  void SetUp() override {
    const auto result =
        run_condyle({"simulate", source_path("/host_sim/scenarios/clinical_session.toml"), "--out",
                     folder_ / "session.csv"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  std::string path(const std::string& name) const { return folder_ / name; }
  std::vector<std::string> with_files(const std::string& command,
                                      const std::string& recording) const {
    return {command,   path(recording),          "--landmarks", path("session.landmarks.toml"),
            "--tasks", path("session.tasks.csv")};
  }

  TemporaryFolder folder_;
};

TEST_F(Report, HoldsTheReadingsOfAnalyse) {
  auto words = with_files("analyse", "session.csv");
  words.emplace_back("--json");
  const auto analysed = run_condyle(words);
  ASSERT_EQ(analysed.exit_code, 0) << analysed.errors;
  words = with_files("report", "session.csv");
  words.insert(words.end(), {"--out", path("report.html")});
  const auto reported = run_condyle(words);
  ASSERT_EQ(reported.exit_code, 0) << reported.errors;
  const std::string page = text_of(path("report.html"));
  const std::string data =
      element(page, "<script type=\"application/json\" id=\"condyle-report-1\">", "</script>");
  EXPECT_EQ(nlohmann::json::parse(data).at("readings"), nlohmann::json::parse(analysed.output));
  EXPECT_LE(page.size(), 1'500'000U);
}

TEST_F(Report, NeedsNothingFromElsewhere) {
  auto words = with_files("report", "session.csv");
  words.insert(words.end(), {"--out", path("report.html")});
  ASSERT_EQ(run_condyle(words).exit_code, 0);
  const std::string page = text_of(path("report.html"));
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
  const std::string page = text_of(path("report.html"));
  EXPECT_THAT(page, Not(HasSubstr("<script>alert(1)")));
  EXPECT_THAT(page, HasSubstr("a&lt;script&gt;alert(1)&lt;b&gt;&#39;&amp;&quot;.csv"));
}

TEST_F(Report, OfTwoRecordingsKeepsTheGoodOne) {
  const auto result = run_condyle(
      {"report", path("session.csv"), path("missing.csv"), "--out", path("report.html")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_THAT(result.errors, HasSubstr("missing.csv"));
  EXPECT_THAT(text_of(path("report.html")), HasSubstr("id=\"recording-1\""));
}

TEST_F(Report, LeavesNoFileAfterAnError) {
  const auto result = run_condyle({"report", path("missing.csv"), "--out", path("report.html")});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(path("report.html")));
}

}  // namespace
}  // namespace condyle
