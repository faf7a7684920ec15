// SPDX-License-Identifier: Apache-2.0
// `condyle inspect` and `condyle doctor` with the fake facebow plugged in.
#include <gmock/gmock.h>

#include "hil/play.h"
#include "support/paths.h"

namespace condyle::hil {
namespace {

using testing::HasSubstr;

class Inspect : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!has_umockdev()) GTEST_SKIP() << "umockdev is not installed";
  }
  // A device that goes away `linger_s` after 100 reports, looked at for `duration_s`.
  Played inspect(std::vector<std::string> options, const std::string& linger_s = "0",
                 const std::string& duration_s = kGuard_s) const {
    std::vector<std::string> program = {testing_support::program_path("condyle"),
                                        "inspect",
                                        "--backend",
                                        std::string(GetParam()) == "libusb" ? "libusb" : "hidapi",
                                        "--duration-s",
                                        duration_s};
    program.insert(program.end(), options.begin(), options.end());
    return play(GetParam(),
                {"--count", "100", "--by-consumption", "--rate-Hz", "500", "--linger-s", linger_s},
                program);
  }
};

// Without a profile: where counter and clock are.
TEST_P(Inspect, ShowsWhatAnUnknownDeviceSends) {
  const Played played = inspect({"--device", "1209:0001"});
  ASSERT_EQ(played.exit_code, 0) << played.text;
  EXPECT_THAT(played.text, HasSubstr("report 1, input, 232 bits"));
  EXPECT_THAT(played.text, HasSubstr("report 1: 29 bytes, 100 reports; "));
  EXPECT_THAT(played.text, HasSubstr("byte 1 to 4, little-endian: increases by 1 per report"));
  EXPECT_THAT(played.text, HasSubstr("byte 5 to 8, little-endian: increases by 2000 per report"));
  EXPECT_THAT(played.text, HasSubstr("the device was disconnected"));
}

TEST_P(Inspect, ShowsWhatAProfileMakesOfIt) {
  const Played played =
      inspect({"--profile", testing_support::source_path("/hal/profiles/condyle_facebow.toml")});
  ASSERT_EQ(played.exit_code, 0) << played.text;
  for (const char* words : {"decoded by the profile condyle fake facebow",
                            "100 reports received, 0 lost", "x1", " mm", "device time"}) {
    EXPECT_THAT(played.text, HasSubstr(words));
  }
}

TEST_P(Inspect, EndsWhenItsTimeIsOver) {
  const Played played = inspect({"--device", "1209:0001"}, kGuard_s, "0.1");
  ASSERT_EQ(played.exit_code, 0) << played.text;
  EXPECT_THAT(played.text, testing::Not(HasSubstr("the device was disconnected")));
}

INSTANTIATE_TEST_SUITE_P(Umockdev, Inspect, testing::Values("hidraw", "libusb"),
                         [](const auto& test) { return std::string(test.param); });

class PluggedIn : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_umockdev()) GTEST_SKIP() << "umockdev is not installed";
  }
  static Played run(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), testing_support::program_path("condyle"));
    return play("hidraw", {"--count", "1"}, arguments);
  }
};

TEST_F(PluggedIn, IsListed) {
  const Played played = run({"inspect"});
  ASSERT_EQ(played.exit_code, 0) << played.text;
  EXPECT_THAT(played.text, HasSubstr("1209:0001 condyle fake facebow"));
  EXPECT_THAT(played.text, HasSubstr("serial number FAKE0001"));
  EXPECT_THAT(played.text, HasSubstr("/dev/hidraw0 (permitted)"));
}

TEST_F(PluggedIn, IsSeenByTheDoctor) {
  const Played played = run({"doctor", "--device", "1209:0001"});
  EXPECT_THAT(played.text, HasSubstr("ok        1209:0001 condyle fake facebow is readable"));
  const Played another =
      run({"doctor", "--profile",
           testing_support::source_path("/hal/profiles/self_describing_3_axis.toml")});
  EXPECT_EQ(another.exit_code, 3) << another.text;
  EXPECT_THAT(another.text, HasSubstr("is not plugged in"));
}

}  // namespace
}  // namespace condyle::hil
