// SPDX-License-Identifier: Apache-2.0
// Tests of readers over the fake facebow in umockdev's test bed.
#pragma once

#include <gmock/gmock.h>

#include <ostream>
#include <string>
#include <vector>

#include "hil/play.h"
#include "support/paths.h"

namespace condyle::hil {

/// A program that reads the fake facebow.
struct Reader {
  const char* name;         ///< in the tests' names
  const char* personality;  ///< hidraw or libusb
  std::vector<std::string> program;

  friend void PrintTo(const Reader& reader, std::ostream* out) { *out << reader.name; }
};

/// The plainest ones.
inline const Reader kPlainHidapi{
    "hidraw", "hidraw", {testing_support::program_path("read_hidapi")}};
inline const Reader kPlainLibusb{
    "libusb", "libusb", {testing_support::program_path("read_libusb")}};
/// condyle's back ends.
inline const Reader kHidapiSource{
    "HidapiSource", "hidraw", {testing_support::program_path("read_reports"), "hidapi"}};
inline const Reader kLibusbSource{
    "LibusbSource", "libusb", {testing_support::program_path("read_reports"), "libusb"}};

inline std::string reader_name(const testing::TestParamInfo<Reader>& test) {
  return test.param.name;
}

/// Tests with a reader.
class FakeFacebow : public testing::TestWithParam<Reader> {
 protected:
  void SetUp() override {
    if (!has_umockdev()) GTEST_SKIP() << "umockdev is not installed";
  }
  std::string personality() const { return GetParam().personality; }
  bool is_usb() const { return personality() == "libusb"; }

  /// Plays so many reports to a reader that stops at the last, which is spared by all faults. The
  /// device stays until then.
  Played play_reports(std::int64_t count, std::vector<std::string> options,
                      std::int64_t counter_jumps = 0,
                      const std::vector<std::string>& reader_options = {}) const {
    options.insert(options.end(), {"--count", std::to_string(count), "--linger-s", kGuard_s});
    std::vector<std::string> program = GetParam().program;
    program.insert(program.end(), {std::to_string(count - 1 + counter_jumps), kGuard_s});
    program.insert(program.end(), reader_options.begin(), reader_options.end());
    return play(personality(), options, program);
  }
};

/// Both sides count the same, report by report.
inline void expect_exact(const Played& played) {
  ASSERT_EQ(played.exit_code, 0) << played.text;
  ASSERT_TRUE(played.account.is_object() && played.reader.is_object()) << played.text;
  EXPECT_TRUE(played.account.value("balances", false)) << played.text;
  EXPECT_EQ(played.reader_count("intact"), played.account_count("delivered_intact")) << played.text;
  EXPECT_EQ(played.reader_count("bad"), played.account_count("delivered_altered")) << played.text;
  EXPECT_EQ(played.reader_count("intact") + played.reader_count("lost"),
            played.account_count("made") + played.account_count("counter_jumped"))
      << played.text;
}

}  // namespace condyle::hil
