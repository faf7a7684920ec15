// SPDX-License-Identifier: Apache-2.0
// protocol emg: what it shows of a simulated subject's friction, what it withholds and refuses.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>

#include "support/c3d_file.h"
#include "support/command.h"
#include "support/paths.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing_support::CommandResult;
using testing_support::read_file;
using testing_support::run_condyle;

class Emg : public testing::Test {
 protected:
  // A subject that chews without food, with some noise of the EMG.
  void SetUp() override {
    const std::string scenario = folder_.write(
        "chewing.toml",
        "duration_s = 20\n[task]\nrest_position_m = -0.002\namplitude_m = 0.015\n"
        "amplitude_spread = 0.12\ncycle_rate_Hz = 1.15\nrate_spread = 0.08\ndwell_share = 0.1\n"
        "[friction]\nviscous_Ns_m = 2\n[emg]\nrate_Hz = 200\nnoise = 0.001\n");
    const auto result = run_condyle({"simulate", scenario, "--out", recording_});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  CommandResult identify(std::vector<std::string> options = {}, std::string muscles = kMuscles) {
    std::vector<std::string> arguments = {"protocol", "emg",       recording_, "--emg",
                                          emg_,       "--muscles", muscles};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return run_condyle(arguments);
  }
  // The muscle file with `more` at its end.
  std::string muscles_with(const std::string& more) {
    return folder_.write("muscles.toml", read_file(kMuscles) + more);
  }

  inline static const std::string kMuscles =
      testing_support::source_path("/host_sim/muscles/artisynth.toml");
  testing_support::TemporaryFolder folder_;
  std::string recording_ = folder_ / "bow.csv", emg_ = folder_ / "bow.emg.csv";
};

TEST_F(Emg, WithholdsFrictionWhereTheForceMayBeWrong) {
  const auto result = identify();
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output,
              AllOf(HasSubstr("research use only"), HasSubstr("0.17 kg (sd 0.03), assumed"),
                    HasSubstr("friction                      WITHHELD; assumed 0.05 Ns/m (sd 20)"),
                    HasSubstr("which a longer recording does not average out"),
                    HasSubstr("smallest difference of friction"), HasSubstr("8 muscles"),
                    Not(HasSubstr("note"))));
}

TEST_F(Emg, ShowsItWhereTheUserAsksForLess) {
  const std::string values = folder_ / "values.json", rows = folder_ / "rows.csv";
  const auto result = identify({"--friction-resolution-Ns-m", "60", "--out", values});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("derived, by the assumed mass"));
  const auto json = nlohmann::json::parse(read_file(values));
  const auto& friction = json["friction_Ns_m"];
  EXPECT_EQ(friction["provenance"], "derived");
  EXPECT_EQ(friction["limit"], "");
  EXPECT_EQ(json["mass_kg"]["provenance"], "assumed");
  EXPECT_THAT(json["note"].get<std::string>(), HasSubstr("research use only"));
  const double value = friction["value"], deviation = friction["standard_deviation"];
  EXPECT_LT(std::abs(value - 2), 1.96 * deviation);
  EXPECT_LT(deviation, 30);

  ASSERT_EQ(identify({"--friction-resolution-Ns-m", "60", "--out", rows}).exit_code, 0);
  const auto table = testing_support::read_table(rows);
  EXPECT_EQ(table.rows, 1200U);
  EXPECT_EQ(table.columns.at("friction_limit").front(), "no_emg");
  EXPECT_EQ(table.columns.at("friction_provenance").front(), "assumed");
  EXPECT_EQ(table.columns.at("friction_provenance").back(), "derived");
}

TEST_F(Emg, TakesFewerMusclesAndOtherColumns) {
  std::string text = read_file(emg_);
  const std::string header = text.substr(0, text.find('\n'));
  std::string other = "time_s";
  for (int i = 1; i <= 8; ++i) other += fmt::format(",emg_{}", i);
  const std::string path = folder_.write("columns.csv", other + text.substr(header.size()));
  const std::string muscles =
      folder_.write("two.toml",
                    "[muscles.closers]\ncolumn = \"emg_1\"\nmaximum_force_N = 800\narm = -0.035\n"
                    "[muscles.openers]\ncolumn = \"emg_7\"\nmaximum_force_N = 70\narm = 0.095\n"
                    "[identification]\nfriction_resolution_Ns_m = 60\n");
  const auto result =
      run_condyle({"protocol", "emg", recording_, "--emg", path, "--muscles", muscles});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("2 muscles"), HasSubstr("gain of openers")));
}

// Raw EMG: noise as strong as the envelopes, in volts.
TEST_F(Emg, TakesRawEmg) {
  std::istringstream envelopes(read_file(emg_));
  std::string line, raw;
  std::getline(envelopes, line);
  raw = line + "\n";
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::int64_t count = 0;
  while (std::getline(envelopes, line)) {
    for (int i = 0; i < 5; ++i) {
      raw += fmt::format("{}", static_cast<double>(count++) / 1000);
      std::istringstream fields(line.substr(line.find(',') + 1));
      for (std::string field; std::getline(fields, field, ',');) {
        raw += fmt::format(",{:.6g}", 1e-3 * std::stod(field) * normal(random));
      }
      raw += '\n';
    }
  }
  emg_ = folder_.write("raw.csv", raw);
  const auto result = identify({"--raw", "--raw-maximum", "0.0008"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, AllOf(HasSubstr("at 1000 Hz, 8 muscles, raw"), HasSubstr("WITHHELD"),
                                   HasSubstr("rows of EMG left out: a value is not known")));
  EXPECT_THAT(identify({"--raw"}).errors, HasSubstr("maximum of anterior_digastric is not known"));
}

TEST_F(Emg, TakesAnalogueChannelsOfC3dAsItTakesCsv) {
  std::istringstream csv(read_file(emg_));
  std::string line, field, renamed = "time_s";
  std::getline(csv, line);
  const std::string rows = read_file(emg_).substr(line.size());
  testing_support::C3dContent file;
  file.names = {"jaw"};
  file.samples = 2;  // 200 Hz beside frames at 100 Hz
  for (int i = 1; i <= 8; ++i) {
    file.channels.push_back(fmt::format("emg_{}", i));
    renamed += "," + file.channels.back();
  }
  file.channel_units.assign(8, "V");
  file.channel_scale.assign(8, 1);
  file.channel_offset.assign(8, 0);
  for (int row = 0; std::getline(csv, line); ++row) {
    if (row % 2 == 0) {
      file.frames.push_back({{0, 0, 300}});
      file.analog.emplace_back();
    }
    std::istringstream fields(line);
    for (int column = 0; std::getline(fields, field, ','); ++column) {
      if (column > 0) file.analog.back().push_back(std::stod(field));
    }
  }
  file.analog.back().resize(16);
  const std::string muscles =
      folder_.write("two.toml",
                    "[muscles.closers]\ncolumn = \"emg_1\"\nmaximum_force_N = 800\narm = -0.035\n"
                    "[muscles.openers]\ncolumn = \"emg_7\"\nmaximum_force_N = 70\narm = 0.095\n"
                    "[identification]\nfriction_resolution_Ns_m = 1000\n");
  const auto values_of = [&](const std::string& emg) {
    emg_ = emg;
    const std::string values = folder_ / "values.json";
    const auto result = identify({"--out", values}, muscles);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return nlohmann::json::parse(read_file(values))["friction_Ns_m"];
  };
  const auto from_csv = values_of(folder_.write("renamed.csv", renamed + rows));
  const auto from_c3d = values_of(folder_.write("emg.c3d", file.bytes()));
  // C3D keeps 24 bits of each number.
  const double deviation = from_csv["standard_deviation"];
  EXPECT_NEAR(from_c3d["value"], from_csv["value"], 1e-2 * deviation);
  EXPECT_EQ(from_c3d["provenance"], from_csv["provenance"]);
}

TEST_F(Emg, RefusesWhatItCannotUse) {
  const auto expect = [](const CommandResult& result, const char* words) {
    EXPECT_EQ(result.exit_code, 2) << words;
    EXPECT_THAT(result.errors, HasSubstr(words));
  };
  const std::string good = emg_, text = read_file(good);
  expect(identify({"--out", folder_ / "values.txt"}), "neither .json nor .csv");
  expect(identify({"--out", emg_}), "bow.emg.csv");
  expect(identify({}, folder_ / "none.toml"), "none.toml");
  expect(identify({}, folder_.write("empty.toml", "")), "lacks a muscle");
  expect(identify({}, muscles_with("masss = 1\n")), "unknown key 'masss'");
  expect(identify({}, muscles_with("[muscles.masseter]\narm = 1\n")), "the maximum is 8");
  expect(identify({}, folder_.write("arm.toml", "[muscles.a]\nmaximum_force_N = 5\n")),
         "no arm of a");
  expect(identify({}, folder_.write("column.toml", "[muscles.a]\narm = 0.01\n")),
         "no column 'a_envelope'");
  expect(
      identify({"--raw", "--raw-maximum", "1"}, muscles_with("[envelope]\nhigh_pass_Hz = 120\n")),
      "cannot be filtered");
  emg_ = folder_.write("bad.csv", text + "20,1,2\n");
  expect(identify(), "the row has 3 columns, the header names 9");
  emg_ = folder_.write("bad.csv", text + "20,1,2,x,4,5,6,7,8\n");
  expect(identify(), "column anterior_temporalis_envelope: 'x' is not a number");
  emg_ = folder_.write("bad.csv", text + "20,1,2,nan,4,5,6,7,8\n");
  EXPECT_EQ(identify().exit_code, 2);
  EXPECT_THAT(identify({"--faults", "event"}).output, HasSubstr("1 values of EMG are missing"));
  emg_ = folder_.write("late.csv", text.substr(0, text.find('\n')) +
                                       "\n100,0,0,0,0,0,0,0,0\n100.005,0,0,0,0,0,0,0,0\n"
                                       "100.01,0,0,0,0,0,0,0,0\n");
  expect(identify(), "no EMG at the times of");
  emg_ = folder_.write("short.csv", text.substr(0, text.find('\n') + 1));
  expect(identify(), "fewer than three rows");
  EXPECT_NE(identify({"--error-share", "nan"}).exit_code, 0);
}

}  // namespace
}  // namespace condyle
