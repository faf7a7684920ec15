// SPDX-License-Identifier: Apache-2.0
// The options of the commands that give readings: analyse and report.
#pragma once

#include <string>
#include <vector>

#include "options/command_line.h"
#include "readings/analysis.h"

namespace condyle::host {

/// The options as typed.
struct ReadingOptions : AnalysisChoice {
  std::vector<std::string> task_words;
  std::string tasks_file;
  std::vector<double> reference;
  std::string moving_body = "lower";
  std::string jaw_names, head_names;

  /// The choice that they make. Reads the tasks' file and checks the landmarks' file. Throws
  /// InputError.
  AnalysisChoice choice() const;
};

/// --jaw and --head, as typed, into `jaw` and `head`. `without_jaw`: what is done without --jaw.
void add_body_options(CommandLine command, std::string& jaw, std::string& head,
                      const std::string& without_jaw);
/// The bodies that they name. Throws InputError.
BodyChoice bodies_of(const std::string& jaw, const std::string& head);

/// --landmarks, --task, --tasks, --reference-s, --jaw, --head, --moving and those of
/// add_reading_options.
void add_readings_options(CommandLine command, ReadingOptions& options);

}  // namespace condyle::host
