// SPDX-License-Identifier: Apache-2.0
// The page at /, and the recorded sessions that it lists and downloads.
#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <stdexcept>

#include "box/outlets/live_page.h"
#include "box/running_box.h"

namespace condyle::box {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing_support::get;
using testing_support::HttpAnswer;
using testing_support::post;
using testing_support::RunningBox;
using testing_support::wait_for;
using Json = nlohmann::json;

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

Json list(const RunningBox& running) {
  return Json::parse(get(running.port, "/v1/sessions").body, nullptr, false);
}

// Records a short session; the name of its log.
std::string record(RunningBox& running) {
  EXPECT_EQ(post(running.port, "/v1/session/start", "{}").status, 200);
  EXPECT_TRUE(wait_for([&] { return running.box->status().session.reports_written > 100; }));
  const HttpAnswer stopped = post(running.port, "/v1/session/stop", "{}");
  EXPECT_EQ(stopped.status, 200) << stopped.body;
  const std::string file = Json::parse(stopped.body)["done"];
  return std::filesystem::path(file).filename().string();
}

TEST(LivePage, NeedsNoTokenAndEverythingElseDoes) {
  RunningBox running;
  running.configuration.token = "0123456789abcdef";
  running.start();
  const HttpAnswer page = get(running.port, "/");
  EXPECT_EQ(page.status, 200);
  EXPECT_EQ(page.body, live_page().text);
  EXPECT_THAT(page.head, HasSubstr("Content-Security-Policy: default-src 'none';"));
  EXPECT_THAT(page.body, Not(HasSubstr(running.configuration.token)));
  for (const char* path : {"/v1/status", "/v1/estimates", "/v1/sessions", "/v1/sessions/a.mcap",
                           "/v1/sessions/a.mcap/report"}) {
    EXPECT_EQ(get(running.port, path).status, 401) << path;
  }
}

TEST(LivePage, LoadsNothingFromElsewhere) {
  const WebPage& page = live_page();
  EXPECT_THAT(page.content_policy, HasSubstr("default-src 'none'"));
  EXPECT_THAT(page.content_policy, HasSubstr("frame-ancestors 'none'"));
  EXPECT_THAT(page.content_policy, Not(HasSubstr("unsafe")));
  const std::regex address("(src|href)=\"([^\"]*)\"");
  for (std::sregex_iterator it(page.text.begin(), page.text.end(), address), end; it != end; ++it) {
    EXPECT_EQ((*it)[2].str().rfind("data:", 0), 0U) << it->str();
  }
#ifdef CONDYLE_HAS_LIVE_PAGE
  EXPECT_THAT(page.content_policy, HasSubstr("connect-src 'self'"));
  EXPECT_THAT(page.content_policy, HasSubstr("script-src 'sha256-"));
  EXPECT_THAT(page.text, HasSubstr("id=\"connection\""));
  EXPECT_THAT(page.text, HasSubstr("Permission is hereby granted"));  // uPlot's licence
#else
  EXPECT_THAT(page.text, HasSubstr("The live page was left out"));
  EXPECT_THAT(page.text, Not(HasSubstr("<script")));
#endif
}

// A force without it would mean nothing.
TEST(LivePage, IsToldTheAssumedMass) {
  RunningBox running;
  running.configuration.parameters.assumed_mass_kg = 0.375;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  const Json status = Json::parse(get(running.port, "/v1/status").body, nullptr, false);
  EXPECT_EQ(status["estimator"]["assumed_mass_kg"], 0.375);
}

TEST(RecordedSessions, AreListedAndDownloaded) {
  RunningBox running;
  running.start();
  ASSERT_TRUE(running.is_estimating());
  EXPECT_EQ(list(running)["sessions"], Json::array());
  const std::string name = record(running);
  std::ofstream(running.folder.path() / "notes.txt") << "private";
  std::filesystem::create_symlink("/etc/hostname", running.folder.path() / "link.mcap");
  std::filesystem::create_directory(running.folder.path() / "folder.mcap");
  const Json listed = list(running);
  EXPECT_EQ(listed["format"], "condyle-box-sessions-1");
  EXPECT_EQ(listed["reports"], false);
  ASSERT_EQ(listed["sessions"].size(), 1U);
  EXPECT_EQ(listed["sessions"][0]["name"], name);
  EXPECT_EQ(listed["sessions"][0]["recording"], false);
  const std::string bytes = bytes_of(running.folder.path() / name);
  EXPECT_EQ(listed["sessions"][0]["bytes"], bytes.size());
  const HttpAnswer log = get(running.port, "/v1/sessions/" + name);
  EXPECT_EQ(log.status, 200);
  EXPECT_TRUE(log.body == bytes);
  EXPECT_THAT(log.head, HasSubstr("attachment; filename=\"" + name + "\""));
  for (const char* other : {"notes.txt", "link.mcap", "folder.mcap", "missing.mcap", "..", "",
                            "%2e%2e%2fbox.toml", "..%2f..%2fetc%2fpasswd", "a%00.mcap", ".mcap"}) {
    EXPECT_EQ(get(running.port, std::string("/v1/sessions/") + other).status, 404) << other;
  }
  EXPECT_EQ(get(running.port, "/v1/sessions/" + name + "/report").status, 404);
}

TEST(RecordedSessions, AreNotHadWhileTheyAreRecorded) {
  RunningBox running;
  running.configuration.make_report = [](const std::string&) { return std::string("<p>"); };
  running.start();
  ASSERT_TRUE(running.is_estimating());
  ASSERT_EQ(post(running.port, "/v1/session/start", "{}").status, 200);
  const Json listed = list(running);
  ASSERT_EQ(listed["sessions"].size(), 1U);
  EXPECT_EQ(listed["sessions"][0]["recording"], true);
  const std::string path = "/v1/sessions/" + listed["sessions"][0]["name"].get<std::string>();
  EXPECT_EQ(get(running.port, path).status, 409);
  EXPECT_EQ(get(running.port, path + "/report").status, 409);
}

TEST(RecordedSessions, HaveReportsWhereTheProgramMakesThem) {
  RunningBox running;
  running.configuration.make_report = [](const std::string& file) -> std::string {
    if (file.find("bad") != std::string::npos) throw std::runtime_error("no position moves");
    return "<p>" + std::filesystem::path(file).filename().string() + std::string(300'000, 'x');
  };
  running.start();
  ASSERT_TRUE(running.is_estimating());
  const std::string name = record(running);
  std::ofstream(running.folder.path() / "bad.mcap") << "x";
  EXPECT_EQ(list(running)["reports"], true);
  const HttpAnswer report = get(running.port, "/v1/sessions/" + name + "/report");
  EXPECT_EQ(report.status, 200);
  EXPECT_EQ(report.body, "<p>" + name + std::string(300'000, 'x'));
  EXPECT_THAT(report.head, HasSubstr(name.substr(0, name.size() - 5) + ".html\""));
  const HttpAnswer bad = get(running.port, "/v1/sessions/bad.mcap/report");
  EXPECT_EQ(bad.status, 422);
  EXPECT_THAT(bad.body, HasSubstr("no position moves"));
}

// A reader that goes away holds nothing: later ones find room.
TEST(RecordedSessions, OutliveReadersThatGoAway) {
  RunningBox running;
  running.configuration.make_report = [](const std::string&) {
    return std::string(50'000'000, 'x');
  };
  running.start();
  std::ofstream(running.folder.path() / "a.mcap") << "x";
  for (int i = 0; i < 20; ++i) {
    testing_support::Connection leaves(running.port);
    ASSERT_TRUE(leaves.send("GET /v1/sessions/a.mcap/report HTTP/1.1\r\nHost: localhost\r\n\r\n"));
    ASSERT_NE(leaves.receive(), "");
    leaves.abort();
    ASSERT_TRUE(wait_for([&] { return get(running.port, "/v1/sessions").status == 200; }));
  }
  running.stop();
}

}  // namespace
}  // namespace condyle::box
