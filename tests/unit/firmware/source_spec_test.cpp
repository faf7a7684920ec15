// SPDX-License-Identifier: Apache-2.0
#include "hosted/devices/source_spec.h"

#include <gtest/gtest.h>

#include <string>

#include "support/temporary_folder.h"

namespace condyle::host {
namespace {

TEST(SourceSpec, IsKindAndFile) {
  for (const SourceKind kind :
       {SourceKind::hid, SourceKind::usb, SourceKind::file, SourceKind::synth, SourceKind::sim}) {
    const auto spec = parse_source(source_kind_name(kind) + std::string(":a:b.toml"));
    ASSERT_TRUE(spec);
    EXPECT_EQ(spec->kind, kind);
    EXPECT_EQ(spec->file, "a:b.toml");
  }
  EXPECT_EQ(parse_source("hid:")->file, "");
  for (const char* text : {"", "hid", "a.csv", ":a", "HID:a", "serial:a"}) {
    EXPECT_FALSE(parse_source(text)) << text;
    EXPECT_EQ(source_of(text).kind, SourceKind::file);
    EXPECT_EQ(source_of(text).file, text);
  }
}

TEST(ReportFile, IsKnownByItsFirstBytes) {
  const testing_support::TemporaryFolder folder;
  const auto of = [&](std::string_view content) {
    return report_file_at(folder.write("file", std::string(content)));
  };
  EXPECT_EQ(of("\x89MCAP0\r\n and more"), ReportFile::session_log);
  EXPECT_EQ(of("\xd4\xc3\xb2\xa1 and more"), ReportFile::capture);
  EXPECT_EQ(of("\x0a\x0d\x0d\x0a"), ReportFile::capture);
  EXPECT_EQ(of("\x89MCAP"), ReportFile::none);
  EXPECT_EQ(of("time_s,position_m\n"), ReportFile::none);
  EXPECT_EQ(of(""), ReportFile::none);
  EXPECT_EQ(report_file_at(folder / "missing"), ReportFile::none);
}

}  // namespace
}  // namespace condyle::host
