// SPDX-License-Identifier: Apache-2.0
// Texts inside recordings that are markup, script or control characters: the report shows them as
// text. Its elements are those of the same recording with harmless texts.
#include <gmock/gmock.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "condyle/hal/log/session_log.h"
#include "hosted/files/clean_text.h"
#include "support/c3d_file.h"
#include "support/command.h"
#include "support/session.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::CommandResult;
using testing_support::read_file;
using testing_support::run_condyle;
using testing_support::TemporaryFolder;

const std::vector<std::string>& hostile_texts() {
  static const std::vector<std::string> texts = [] {
    std::string text = "R<b>";
    while (text.size() < 240) text += text;
    text.resize(240);
    return std::vector<std::string>{"<img src=x onerror=alert(1)>",
                                    "\"><svg/onload=alert(2)>",
                                    "'onfocus='alert(3)",
                                    "</script><script>alert(4)</script>",
                                    "</dd><!--<script>",
                                    "</table><plaintext>",
                                    "&lt;i&gt;&#60;u&#62;&amp",
                                    "{}{0}%s%n\\u003c",
                                    "=1+1|'calc'!A0",
                                    "__proto__",
                                    "m\xe2\x80\xaegnp.\xe2\x81\xa6s",
                                    "e\x1b[2J\x07\xc2\x9b",
                                    "bad\xff\xc0\x80",
                                    text};
  }();
  return texts;
}

// Everything between < and > outside the script's data: what a browser takes for markup.
std::string markup_of(const std::string& page) {
  std::string markup;
  for (std::size_t at = page.find("<section"); at != std::string::npos; at = page.find('<', at)) {
    const std::size_t end = page.find('>', at);
    if (page.compare(at, 9, "</section") == 0) break;
    markup += page.substr(at, end + 1 - at) + "\n";
    at = end;
  }
  return markup;
}

// Nothing that turns the direction of writing or controls a terminal, and no invalid UTF-8.
bool is_clean(const std::string& text) {
  return host::clean_lines(text) == text;
}

// The begin of `text` as a string of JSON, without its quotation marks.
std::string shown_in_json(const std::string& text) {
  const std::string quoted = nlohmann::json(host::clean_line(text).substr(0, 40)).dump();
  return quoted.substr(1, quoted.size() - 2);
}

class HostileTexts : public testing::Test {
 protected:
  // The page of a recording that condyle reads.
  std::string report(const std::string& recording, std::vector<std::string> more = {}) {
    const std::string out = folder_ / "report.html";
    more.insert(more.begin(), {"report", recording, "--out", out});
    const CommandResult result = run_condyle(more);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_TRUE(is_clean(result.output + result.errors));
    std::string page = read_file(out);
    EXPECT_TRUE(is_clean(page));
    return page;
  }
  // A page as it is with harmless texts, which shows `text`.
  static void expect_text(const std::string& page, const std::string& harmless,
                          const std::string& text) {
    EXPECT_EQ(markup_of(page), markup_of(harmless)) << text;
    const std::string begin = "id=\"condyle-report-1\">";
    const std::size_t at = page.find(begin) + begin.size();
    const std::string data = page.substr(at, page.find("</script>", at) - at);
    EXPECT_THAT(data, Not(HasSubstr("<")));
    EXPECT_THAT(nlohmann::json::parse(data).dump(-1, ' ', false), HasSubstr(shown_in_json(text)))
        << "is not in the data";
  }
  TemporaryFolder folder_;
};

// Nine points of a jaw that opens; all have names of their own.
std::string c3d_with(const std::vector<std::string>& names) {
  testing_support::C3dContent file;
  file.names = names;
  for (int k = 0; k < 600; ++k) {
    const double angle = k < 200 ? 0 : 0.2 * (1 - std::cos((k - 200) * 0.02));
    std::vector<testing_support::C3dPlace> places;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto n = static_cast<double>(i);
      const double y = 40 + 9 * std::cos(n), z = 30 * std::sin(2 * n);
      const double noise = 0.02 * std::sin(37.7 * (k + 1) * (n + 1));
      places.push_back({20 * std::cos(3 * n) + noise,
                        y * std::cos(angle) - z * std::sin(angle) - noise,
                        y * std::sin(angle) + z * std::cos(angle) + noise});
    }
    file.frames.push_back(places);
  }
  return file.bytes();
}

TEST_F(HostileTexts, NamesOfMarkersInC3d) {
  const std::vector<std::string>& texts = hostile_texts();
  std::vector<std::string> names;
  for (std::size_t i = 0; i < texts.size(); ++i) names.push_back("marker" + std::to_string(i));
  const std::string harmless = report(folder_.write("harmless.c3d", c3d_with(names)));
  const std::string path = folder_.write("hostile.c3d", c3d_with(texts));
  const std::string page = report(path);
  for (const std::string& text : texts) expect_text(page, harmless, text);
  const CommandResult info = run_condyle({"info", path});
  EXPECT_EQ(info.exit_code, 0) << info.errors;
  EXPECT_TRUE(is_clean(info.output));
}

TEST_F(HostileTexts, NamesOfColumnsInCsv) {
  const auto table = [this](const std::string& file, const std::string& name) {
    std::string quoted;
    for (const char c : name) quoted += c == '"' ? "\"\"" : std::string(1, c);
    std::string text = "time_s,x1_mm,y1_mm,z1_mm,\"" + quoted + "\"\n";
    for (int k = 0; k < 300; ++k) {
      text += std::to_string(k * 0.01) + "," + std::to_string(std::sin(k * 0.05)) + ",0," +
              std::to_string(10 * std::cos(k * 0.05)) + ",1\n";
    }
    return folder_.write(file, text);
  };
  for (const std::string& name : hostile_texts()) {
    // Columns that are not known, and files that are not text, are refused in words that are text.
    const std::string path = table("hostile.csv", name);
    const CommandResult refused = run_condyle({"report", path, "--out", folder_ / "report.html"});
    EXPECT_EQ(refused.exit_code, 2) << name;
    EXPECT_TRUE(is_clean(refused.errors + refused.output)) << name;
    EXPECT_FALSE(std::ifstream(folder_ / "report.html").is_open());
  }
}

hal::SessionHeader header_with(const std::string& device, const std::string& version) {
  hal::SessionHeader header = testing_support::make_header();
  header.software_version = version.substr(0, 60);
  header.parameters_toml.clear();
  header.sources[0].name = "facebow";
  std::string quoted;
  for (const char c : device)
    quoted += c == '"' || c == '\\' ? std::string{'\\', c} : std::string{c};
  header.sources[0].profile_toml = "name = \"" + quoted +
                                   "\"\nvendor_id = 0x1209\nproduct_id = 1\nrate_Hz = 100\n"
                                   "[report]\nminimum_size_bytes = 6\n[coordinates]\n"
                                   "kind = \"one_point\"\noffset_bytes = 0\nwidth_bits = 16\n"
                                   "type = \"signed\"\nunit = \"um\"\nscale = 4\n";
  return header;
}

std::string log_with(const std::string& path, const hal::SessionHeader& header,
                     const std::vector<std::string>& markers) {
  hal::SessionLogWriter log;
  EXPECT_EQ(log.open(path, header), hal::SessionLogFailure::none);
  for (int k = 0; k < 400; ++k) {
    hal::RawReport report;
    report.host_time_ns = header.start_monotonic_ns + k * TimeNs{10'000'000};
    report.size = 6;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto count = static_cast<std::int16_t>(
          std::lround(2500 * std::sin(0.05 * k + static_cast<double>(axis))));
      report.bytes[2 * axis] = static_cast<std::uint8_t>(count & 0xff);
      report.bytes[2 * axis + 1] = static_cast<std::uint8_t>(count >> 8);
    }
    EXPECT_TRUE(log.write(0, report));
    const auto i = static_cast<std::size_t>(k / 20);
    if (k % 20 == 0 && i < markers.size()) {
      EXPECT_TRUE(log.write_event(0, report.host_time_ns, hal::SessionEvent::note, markers[i]));
    }
  }
  EXPECT_EQ(log.close(), hal::SessionLogFailure::none);
  return path;
}

TEST_F(HostileTexts, NamesOfDevicesAndMarkersInSessionLogs) {
  std::vector<std::string> markers = hostile_texts();
  for (std::string& marker : markers) marker = marker.substr(0, hal::kMaxEventText);
  const std::string harmless =
      report(log_with(folder_ / "harmless.mcap", header_with("device", "1.0"),
                      std::vector<std::string>(markers.size(), "marker")));
  int number = 0;
  for (const std::string& text : hostile_texts()) {
    // TOML has no such characters, so a device cannot be named by them.
    const bool is_toml =
        text.find('\x1b') == std::string::npos && text.find('\xff') == std::string::npos;
    const std::string path = log_with(folder_ / ("hostile" + std::to_string(++number) + ".mcap"),
                                      header_with(is_toml ? text : "device", text), markers);
    const std::string page = report(path);
    expect_text(page, harmless, text);
    const CommandResult info = run_condyle({"info", path});
    EXPECT_TRUE(is_clean(info.output + info.errors)) << text;
  }
}

// No program of condyle writes such a code; a log that has it is refused.
TEST_F(HostileTexts, CodesOfSubjects) {
  for (const std::string& text : hostile_texts()) {
    hal::SessionHeader header = header_with("device", "1.0");
    header.subject_code = text;
    hal::SessionLogWriter log;
    const std::string path = folder_ / "subject.mcap";
    if (text == "__proto__") continue;  // letters and _ alone: a code as any other
    EXPECT_NE(log.open(path, header), hal::SessionLogFailure::none) << text;
    EXPECT_FALSE(std::ifstream(path).is_open()) << text;
  }
}

}  // namespace
}  // namespace condyle
