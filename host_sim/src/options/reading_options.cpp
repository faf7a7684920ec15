// SPDX-License-Identifier: Apache-2.0
#include "options/reading_options.h"

#include <fmt/format.h>

#include "hosted/files/input_error.h"
#include "options/analysis_options.h"

namespace condyle::host {

AnalysisChoice ReadingOptions::choice() const {
  AnalysisChoice choice = *this;
  if (!tasks_file.empty()) choice.tasks = read_tasks(tasks_file);
  for (const Task& task : tasks_of_words(task_words)) choice.tasks.push_back(task);
  if (!reference.empty()) {
    if (!(reference[1] > reference[0])) {
      throw InputError(
          "--reference-s",
          fmt::format("it ends at {:g} s, not after {:g} s", reference[1], reference[0]),
          "give the begin, then the end");
    }
    choice.reference_s = {reference[0], reference[1]};
  }
  choice.moving = moving_body == "upper" ? MovingBody::upper : MovingBody::lower;
  choice.bodies = bodies_of(jaw_names, head_names);
  if (!choice.bodies.head.empty() && choice.moving == MovingBody::upper) {
    throw InputError("--head", "is given with --moving upper",
                     "leave out --moving: with --head the jaw is seen relative to the head");
  }
  if (!landmarks.empty()) static_cast<void>(load_landmarks(landmarks));
  return choice;
}

BodyChoice bodies_of(const std::string& jaw, const std::string& head) {
  BodyChoice bodies;
  if (!jaw.empty()) bodies.jaw = point_names(jaw, "--jaw");
  if (!head.empty()) bodies.head = point_names(head, "--head");
  return bodies;
}

void add_body_options(CommandLine command, std::string& jaw, std::string& head,
                      const std::string& without_jaw) {
  command.add_option("--jaw=A,B,C", jaw,
                     "Points of a CSV file on the lower jaw, three or more; " + without_jaw);
  command.add_option("--head=D,E,F", head,
                     "Points of a CSV file on the head, three or more; the jaw is taken relative "
                     "to it");
}

void add_readings_options(CommandLine command, ReadingOptions& options) {
  command.add_option("--landmarks=FILE", options.landmarks,
                     "TOML file with condyles, lower incisor and reference plane");
  command
      .add_option("--task", options.task_words,
                  "NAME BEGIN END (s): opening, protrusion, left, right, chewing, border or rest; "
                  "repeatable")
      .values_each(3);
  command.add_option("--tasks=FILE", options.tasks_file, "The tasks as CSV: task, begin_s, end_s");
  command
      .add_option("--reference-s", options.reference,
                  "BEGIN END of a rest in the reference position; found if not given")
      .values(2);
  add_body_options(command, options.jaw_names, options.head_names,
                   "all that are not the head's if not given");
  command
      .add_option("--moving", options.moving_body,
                  "Body that the recording tracks: lower jaw, or head seen from the lower jaw")
      .one_of({"lower", "upper"})
      .show_default();
  add_reading_options(command, options.reading);
}

}  // namespace condyle::host
