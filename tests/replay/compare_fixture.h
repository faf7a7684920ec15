// SPDX-License-Identifier: Apache-2.0
// Recordings of a simulated subject for the tests of compare.
#pragma once

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <sstream>
#include <string>
#include <vector>

#include "support/command.h"
#include "support/temporary_folder.h"

namespace condyle::testing_support {

class CompareTest : public testing::Test {
 protected:
  // A point mass that chews for 20 s; the drive as a column where asked for.
  std::string record(int seed, double amplitude_m = 0.015, double rate_Hz = 60,
                     bool with_drive = false) {
    const std::string name = fmt::format("r{}_{}_{}", seed, amplitude_m, rate_Hz);
    const std::string scenario = folder_.write(
        name + ".toml",
        fmt::format("duration_s = 20\n[subject]\nmotion = \"point_mass\"\ndrive = \"force\"\n"
                    "mass_kg = 0.25\nsupport_stiffness_N_m = 20\nsupport_rest_m = -0.010\n"
                    "[task]\nrest_position_m = 0.0\namplitude_m = {}\namplitude_spread = 0.05\n"
                    "cycle_rate_Hz = 1.3\nrate_spread = 0.08\n[friction]\nviscous_Ns_m = 0.022\n"
                    "[facebow]\nrate_Hz = {}\n[drive]\nrate_Hz = 60\nnoise_N = 0.01\n",
                    amplitude_m, rate_Hz));
    const std::string path = folder_ / (name + ".csv");
    const auto result =
        run_condyle({"simulate", scenario, "--seed", std::to_string(seed), "--out", path});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return with_drive ? join_drive(name) : path;
  }

  // Both have the same times.
  std::string join_drive(const std::string& name) {
    std::istringstream positions(read_file(folder_ / (name + ".csv")));
    std::istringstream drives(read_file(folder_ / (name + ".drive.csv")));
    std::string joined, position, drive;
    while (std::getline(positions, position) && std::getline(drives, drive)) {
      const std::size_t comma = drive.find(',');
      EXPECT_EQ(drive.substr(0, comma), position.substr(0, position.find(',')));
      joined += position + drive.substr(comma) + "\n";
    }
    return folder_.write(name + ".joined.csv", joined);
  }

  static std::string session(const std::string& name, const std::vector<std::string>& files) {
    return fmt::format("{}={}", name, fmt::join(files, ","));
  }

  static void refuse(const std::vector<std::string>& arguments, const std::string& words) {
    std::vector<std::string> all = {"compare"};
    all.insert(all.end(), arguments.begin(), arguments.end());
    const CommandResult result = run_condyle(all);
    EXPECT_EQ(result.exit_code, 2) << words;
    EXPECT_THAT(result.errors, testing::HasSubstr(words));
    EXPECT_EQ(result.output, "");
  }

  TemporaryFolder folder_;
};

}  // namespace condyle::testing_support
