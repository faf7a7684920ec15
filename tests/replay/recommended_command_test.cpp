// SPDX-License-Identifier: Apache-2.0
// The recommended estimator as a user of the command meets it.
#include <gmock/gmock.h>

#include <cmath>
#include <random>

#include "support/command.h"
#include "support/paths.h"
#include "support/table.h"
#include "support/temporary_folder.h"

namespace condyle {
namespace {

using testing::HasSubstr;
using testing_support::CommandResult;
using testing_support::read_file;
using testing_support::read_table;
using testing_support::run_condyle;
using testing_support::Table;
using testing_support::TemporaryFolder;

const std::string kShipped = testing_support::source_path("/host_sim/recordings/chewing_60hz.csv");

TEST(Recommended, IsTheDefaultAndShowsWhatItKnows) {
  const TemporaryFolder folder;
  const std::string out = folder / "estimates.csv", figures = folder / "figures";
  const CommandResult result =
      run_condyle({"replay", kShipped, "--out", out, "--figures", figures});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.errors, testing::IsEmpty());
  for (const char* words :
       {"research use only", "duration    29.9833 s, 1800 samples", "lag         none",
        "recommended: white-jerk motion, noise and jerk learned over 8 s", "mm sd at the end",
        "mean NIS    0.99", "(95 %), measured", "derived: assumed mass times measured acceleration",
        "Friction and mass are not computed: position alone does not determine them"}) {
    EXPECT_THAT(result.output, HasSubstr(words));
  }
  const Table table = read_table(out);
  EXPECT_EQ(table.rows, 1800U);
  EXPECT_EQ(table.header[1], "measured_position_m");
  EXPECT_EQ(table.numbers("measured_position_m"), read_table(kShipped).numbers("position_m"));
  for (const std::string& column : table.header) {
    EXPECT_FALSE(column.starts_with("friction") || column.starts_with("mass")) << column;
  }
  EXPECT_EQ(table.columns.at("velocity_provenance").front(), "assumed");
  EXPECT_EQ(table.columns.at("velocity_provenance").back(), "measured");
  EXPECT_EQ(table.columns.at("acceleration_provenance").back(), "measured");
  EXPECT_EQ(table.columns.at("force_provenance").back(), "derived");
  // The recording's noise is 0.1 mm.
  EXPECT_NEAR(table.numbers("noise_sd_m").back(), 1e-4, 2e-5);
  const auto acceleration = table.numbers("acceleration_m_s2"), force = table.numbers("force_N");
  for (std::size_t i = 0; i < table.rows; ++i) {
    ASSERT_NEAR(force[i], 0.25 * acceleration[i], 1e-12) << i;
  }
  for (const char* name : {"position", "velocity", "force"}) {
    const std::string svg = read_file(figures + "/" + name + ".svg");
    EXPECT_THAT(svg, HasSubstr("research use only"));
    EXPECT_EQ(read_file(figures + "/" + name + ".png").substr(1, 3), "PNG");
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(figures), {}), 6);
}

TEST(Recommended, WithALagEachRowIsStillTheInstantItEstimates) {
  const TemporaryFolder folder;
  const Table recording = read_table(kShipped);
  const auto replay = [&](const std::string& lag) {
    const CommandResult result =
        run_condyle({"replay", kShipped, "--lag", lag, "--out", folder / "e.csv"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    if (lag == "6") {
      EXPECT_THAT(result.output, HasSubstr("lag         6 samples, 100 ms on average"));
    }
    return read_table(folder / "e.csv");
  };
  const Table now = replay("0"), later = replay("6");
  for (const Table* table : {&now, &later}) {
    ASSERT_EQ(table->rows, 1800U);
    EXPECT_EQ(table->numbers("time_s"), recording.numbers("time_s"));
  }
  EXPECT_EQ(now.columns.at("position_m").back(), later.columns.at("position_m").back())
      << "the last row has no later samples to wait for";
  const auto sd_now = now.numbers("velocity_sd_m_s"), sd_later = later.numbers("velocity_sd_m_s");
  // Of the steady state, not of the last rows, which waited for less.
  for (std::size_t i = 300; i < 1790; ++i) ASSERT_LT(sd_later[i], 0.7 * sd_now[i]) << i;
}

TEST(Recommended, TakesEachSampleForWhatItIs) {
  const TemporaryFolder folder;
  std::string rows;
  for (int i = 0; i < 60; ++i) {
    const double t = 0.02 * i;
    const std::string position = std::to_string(0.001 + 1e-5 * (i * 7 % 5));
    if (i == 30) rows += std::to_string(t) + ",nan\n";
    if (i == 31) rows += "," + position + "\n";
    if (i == 32) rows += "0.1," + position + "\n";
    if (i == 33) rows += std::to_string(t) + ",0.05\n";
    if (i < 30 || (i > 33 && i < 50)) rows += std::to_string(t) + "," + position + "\n";
    if (i == 34) rows += std::to_string(t) + "," + position + "\n";  // told twice
  }
  for (int i = 0; i < 20; ++i)
    rows += std::to_string(2 + 0.02 * i) + ",0.00100" + (i % 2 == 0 ? "1\n" : "2\n");
  const CommandResult result =
      run_condyle({"replay", folder.write("r.csv", "time_s,position_m\n" + rows), "--faults",
                   "event", "--out", folder / "e.csv"});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output,
              HasSubstr("1 time_missing, 1 time_reversed, 1 time_repeated, 2 time_gap, 1 "
                        "position_missing, 1 outlier_rejected, 1 state_restarted\n"));
  const Table table = read_table(folder / "e.csv");
  const auto& events = table.columns.at("events");
  const auto& position = table.columns.at("position_m");
  const auto& provenance = table.columns.at("position_provenance");
  EXPECT_EQ(events[30], "position_missing");
  EXPECT_EQ(provenance[30], "derived") << "the motion model carries on";
  EXPECT_EQ(events[31], "time_missing");
  EXPECT_EQ(position[31], "") << "a position without a time says nothing";
  EXPECT_EQ(events[32], "time_reversed");
  EXPECT_EQ(position[32], "");
  EXPECT_THAT(events[33], HasSubstr("outlier_rejected"));
  EXPECT_EQ(provenance[33], "derived");
  EXPECT_EQ(events[35], "time_repeated");
  EXPECT_EQ(position[35], "") << "one measurement told twice is one measurement";
  EXPECT_EQ(events[51], "time_gap|state_restarted");
  EXPECT_EQ(table.columns.at("velocity_provenance")[51], "assumed");
  EXPECT_EQ(table.rows, 71U);
}

// The same motion at Unix time: the same figures, but for the words below them.
TEST(Recommended, FiguresOfFarTimesAreThoseOfNearTimes) {
  const TemporaryFolder folder;
  std::string near = "time_s,position_mm\n", far = near;
  for (int i = 0; i < 300; ++i) {
    const std::string row = "." + std::to_string(1000 + i * 3).substr(1) + "," +
                            std::to_string(5 * std::sin(0.05 * i) + 0.01 * (i * 7 % 5)) + "\n";
    near += "0" + row;
    far += "1763716110" + row;
  }
  const auto figure = [&](const std::string& name, const std::string& rows) {
    const CommandResult result =
        run_condyle({"replay", folder.write("r.csv", rows), "--figures", folder / name});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_THAT(result.output, HasSubstr(name == "far" ? "last values, at 1763716110.897 s\n"
                                                       : "last values, at 0.897 s\n"));
    return read_file(folder / (name + "/velocity.svg"));
  };
  std::string shown = figure("far", far);
  const std::string label = "time since the first sample, which is at 1763716110 s (s)";
  ASSERT_THAT(shown, HasSubstr(label));
  shown.replace(shown.find(label), label.size(), "time (s)");
  EXPECT_EQ(shown, figure("near", near));
}

TEST(Recommended, SaysNothingOfConsistencyFromTooFewSamples) {
  const TemporaryFolder folder;
  const auto summary = [&](int samples, double first_step_share, const char* estimator) {
    std::string rows = "time_s,position_mm\n";
    std::mt19937 generator(11);
    std::normal_distribution<double> noise(0, 0.05);
    for (int i = 0; i < samples; ++i) {
      const double t = 0.01 * i + (i % 2 == 0 ? 0 : 0.01 * first_step_share);
      rows += std::to_string(t) + "," + std::to_string(noise(generator)) + "\n";
    }
    const CommandResult result = run_condyle(
        {"replay", folder.write("r.csv", rows), "--parameters",
         folder.write("p.toml",
                      estimator == std::string("published") ? "sample_time_s = 0.01\n" : ""),
         "--estimator", estimator});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return result.output;
  };
  const auto has = [](const char* words) { return HasSubstr(words); };
  for (const char* estimator : {"recommended", "published"}) {
    for (const int samples : {3, 50}) {
      const std::string text = summary(samples, 0, estimator);
      EXPECT_THAT(text, has("consistency not judged: too few samples"));
      EXPECT_THAT(text, has("95 % by the filter's model, unchecked"));
      for (const char* words :
           {"nan", "mean NIS", "whiteness", "noise floor", "intervals ", "estimated", "(95 %)"}) {
        EXPECT_THAT(text, testing::Not(has(words))) << samples << estimator;
      }
    }
    EXPECT_THAT(summary(300, 0, estimator), has("mean NIS"));
  }
  EXPECT_THAT(summary(3, 0, "recommended"), has("innovations of the 100 required"));
  EXPECT_THAT(summary(300, 0, "recommended"), has("noise floor -0.8"));
  EXPECT_THAT(summary(300, 0.5, "recommended"), has("noise floor not computed"));
}

TEST(Recommended, SaysWhereTheForcesAccelerationComesFrom) {
  const TemporaryFolder folder;
  const auto force = [&](const std::string& last_row) {
    const CommandResult result = run_condyle(
        {"replay", folder.write("r.csv", read_file(kShipped) + last_row), "--faults", "event"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    const auto at = result.output.find("  force ");
    return result.output.substr(at, result.output.find('\n', at) - at);
  };
  EXPECT_THAT(force(""), HasSubstr("derived: assumed mass times measured acceleration"));
  EXPECT_THAT(
      force("30,nan\n"),
      HasSubstr("derived: assumed mass times an acceleration that the motion model predicted"));
}

// Noise that was smoothed before it was recorded is said; white noise is not.
TEST(Recommended, SaysWhereTheMakerSmoothed) {
  const TemporaryFolder folder;
  const auto warning = [&](int smoothed_over) {
    std::mt19937 generator(5);
    std::normal_distribution<double> noise(0, 2e-5);
    std::vector<double> recent(static_cast<std::size_t>(smoothed_over), 0.0);
    std::string rows;
    for (std::size_t i = 0; i < 4000; ++i) {
      recent[i % recent.size()] = noise(generator);
      double sum = 0;
      for (const double value : recent) sum += value;
      const double t = 0.005 * static_cast<double>(i);
      const double position = 0.008 * std::sin(2 * M_PI * 1.2 * t) + sum / smoothed_over;
      rows += std::to_string(t) + "," + std::to_string(position * 1e3) + "\n";
    }
    const CommandResult result =
        run_condyle({"replay", folder.write("r.csv", "time_s,position_mm\n" + rows)});
    EXPECT_EQ(result.exit_code, 0);
    return result.errors;
  };
  EXPECT_THAT(warning(1), testing::IsEmpty());
  EXPECT_THAT(warning(3), HasSubstr("warning: "));
  EXPECT_THAT(warning(3), HasSubstr("its intervals are not reliable"));
}

TEST(Recommended, RefusesWhatIsNotItsOwn) {
  const TemporaryFolder folder;
  const auto expect_refused = [&](std::vector<std::string> more, const char* words) {
    more.insert(more.begin(), {"replay", kShipped, "--out", folder / "e.csv"});
    const CommandResult result = run_condyle(more);
    EXPECT_EQ(result.exit_code, 2) << result.output;
    EXPECT_THAT(result.errors, HasSubstr(words));
    EXPECT_FALSE(std::filesystem::exists(folder / "e.csv"));
  };
  const auto parameters = [&](const char* text) {
    return std::vector<std::string>{"--parameters", folder.write("p.toml", text)};
  };
  expect_refused({"--lag", "17"}, "--lag");
  expect_refused({"--jaw-point-mm", "1", "2", "3"}, "has no three points");
  expect_refused({"--jaw-point-mm", "1", "2"}, "--jaw-point-mm");
  expect_refused({"--jaw-point-mm", "1", "nan", "3"}, "--jaw-point-mm");
  expect_refused({"--lag", "2", "--estimator", "published"},
                 "--lag: is not supported by --estimator published");
  expect_refused(parameters("sample_time_s = 0.02\n"),
                 "p.toml:1:17: belongs to the published estimator's parameters; use it with the "
                 "published estimator only");
  expect_refused(parameters("[motion]\n"), "belongs to the published estimator's parameters");
  expect_refused({"--estimator", "published", "--parameters",
                  folder.write("q.toml", "[noise]\nmemory_s = 5\n")},
                 "belongs to the recommended estimator's parameters");
  expect_refused(parameters("[noise]\njerk_density_m2_s5 = 3\n"),
                 "is estimated while adaptation is \"on\"");
  expect_refused(parameters("[noise]\nadaptation = \"maybe\"\n"), "give \"off\" or \"on\"");
  expect_refused(parameters("[noise]\nposition_sd_m = 0\n"), "position_sd_m = 0 is out of range");
  expect_refused(parameters("[noise]\nlowest_position_sd_m = 0.01\n"),
                 "lowest_position_sd_m is not below highest_position_sd_m");
  expect_refused(parameters("[outliers]\nhuber_sd = 9\n"), "huber_sd is above gate_sd");
  expect_refused(parameters("[outliers]\nhubersd = 9\n"), "unknown key 'hubersd'");
}

TEST(Recommended, TakesNoiseAndJerkAsGivenWhereAsked) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_condyle({"replay", kShipped, "--out", folder / "e.csv", "--parameters",
                   folder.write("p.toml",
                                "assumed_mass_kg = 0.4\n[noise]\nadaptation = \"off\"\n"
                                "position_sd_m = 1e-3\njerk_density_m2_s5 = 2\n")});
  ASSERT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_THAT(result.output, HasSubstr("noise and jerk as given, assumed mass 0.4 kg"));
  EXPECT_THAT(result.output, HasSubstr("noise       1 mm sd, given"));
  EXPECT_THAT(result.output, HasSubstr("intervals   too wide by a factor of about"));
  EXPECT_EQ(read_table(folder / "e.csv").numbers("jerk_density_m2_s5").back(), 2);
}

}  // namespace
}  // namespace condyle
