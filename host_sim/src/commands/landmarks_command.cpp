// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <numbers>

#include "commands/commands.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "hosted/files/nearest_word.h"
#include "hosted/files/number_text.h"
#include "options/analysis_options.h"
#include "options/command_line.h"
#include "options/reading_options.h"
#include "output/output_file.h"
#include "output/report_text.h"
#include "readings/landmark_taking.h"
#include "recordings/session_markers.h"

namespace condyle::host {
namespace {

constexpr double kMarkedTouch_s = 0.5;
constexpr double kFarthestTip_mm = 1000;

struct LandmarksOptions {
  std::string recording, out, pointer, point, jaw, head, kind = "palpated", plane = "not stated";
  std::vector<double> tip_mm, calibration_s, reference_s;
  std::vector<std::string> at_words;
  double touch_sd_mm = 1;
  RecordingOptions reading;
};

std::optional<TimeSpan> interval_of(const std::vector<double>& values, const char* option) {
  if (values.empty()) return std::nullopt;
  if (!(values[1] > values[0])) {
    throw InputError(option,
                     fmt::format("it ends at {:g} s, not after {:g} s", values[1], values[0]),
                     "give the begin, then the end");
  }
  return TimeSpan{values[0], values[1]};
}

double time_of(const std::string& text, const std::string& place) {
  double time_s = 0;
  if (parse_number(text, time_s) != NumberStatus::ok) {
    throw InputError(place, fmt::format("{} is not a time", quote(text)),
                     "give BEGIN END in seconds on the recording's clock");
  }
  return time_s;
}

std::size_t landmark_of(const std::string& name) {
  const std::vector<std::string> names(Landmarks::kNames.begin(), Landmarks::kNames.end());
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    const std::string nearest = nearest_word(name, names);
    throw InputError(
        "--at", fmt::format("{} is not a landmark", quote(name)),
        fmt::format("{}landmarks are {}", nearest.empty() ? "" : "did you mean " + nearest + "? ",
                    fmt::join(names, ", ")));
  }
  return static_cast<std::size_t>(found - names.begin());
}

// A marker named like a landmark is set when the tip is on it.
void take_markers(const std::string& log, LandmarkPlan& plan) {
  for (const SessionMarker& marker : read_markers(log)) {
    for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
      if (trim(marker.text) != Landmarks::kNames[i]) continue;
      const double begin_s = seconds(marker.time_ns);
      plan.at_s[i] = TimeSpan{begin_s, begin_s + kMarkedTouch_s};
    }
  }
}

LandmarkPlan plan_of(const LandmarksOptions& options) {
  LandmarkPlan plan;
  if (options.pointer.empty() == options.point.empty()) {
    throw InputError("--pointer", options.point.empty() ? "is not given" : "is given with --point",
                     "give --pointer A,B,C with --tip or --tip-calibration, or give --point NAME");
  }
  plan.calibration_s = interval_of(options.calibration_s, "--tip-calibration");
  if (!options.pointer.empty()) {
    plan.pointer = point_names(options.pointer, "--pointer");
    if (options.tip_mm.empty() == options.calibration_s.empty()) {
      throw InputError("--pointer", "needs either --tip or --tip-calibration",
                       "give --tip-calibration BEGIN END, in which the tip rests in a hole while "
                       "the pointer tilts to all sides");
    }
  } else if (!options.tip_mm.empty() || plan.calibration_s) {
    throw InputError("--point", "has no tip", "leave out --tip and --tip-calibration");
  }
  if (!options.tip_mm.empty()) plan.tip_m = Eigen::Vector3d::Map(options.tip_mm.data()) * 1e-3;
  plan.point = options.point;
  plan.bodies = bodies_of(options.jaw, options.head);
  plan.reference_s = interval_of(options.reference_s, "--reference-s");
  plan.touch_sd_mm = options.touch_sd_mm;
  plan.kind = options.kind;
  plan.plane = options.plane;
  take_markers(options.recording, plan);
  for (std::size_t i = 0; i + 2 < options.at_words.size(); i += 3) {
    const std::string& name = options.at_words[i];
    const std::string place = "--at " + name;
    plan.at_s[landmark_of(name)] = interval_of(
        {time_of(options.at_words[i + 1], place), time_of(options.at_words[i + 2], place)},
        place.c_str());
  }
  return plan;
}

std::string summary_of(const TakenLandmarks& taken) {
  std::string text;
  if (taken.tip) {
    const Eigen::Vector3d mm = taken.tip->tip_m * 1e3;
    text += fmt::format(
        "tip         {:.2f} {:.2f} {:.2f} mm in the pointer's frame, sd {:.3f} mm; it misfits by "
        "{:.3f} mm, the pointer turned by {:.0f} deg\n",
        mm.x(), mm.y(), mm.z(), taken.tip->sd_m * 1e3, taken.tip->residual_rms_m * 1e3,
        taken.tip->turn_rad * 180 / std::numbers::pi);
  }
  for (std::size_t i = 0; i < Landmarks::kPoints; ++i) {
    const Eigen::Vector3d mm = taken.landmarks.point_m[i] * 1e3;
    text += fmt::format("{:<15} {:8.2f} {:8.2f} {:8.2f} mm, sd {:.3f} mm, scatter {:.3f} mm\n",
                        Landmarks::kNames[i], mm.x(), mm.y(), mm.z(), taken.landmarks.sd_m[i] * 1e3,
                        taken.taken[i].scatter_m * 1e3);
  }
  for (const std::string& note : taken.notes) text += fmt::format("note        {}\n", note);
  return text;
}

int take(const LandmarksOptions& options) {
  const LandmarkPlan plan = plan_of(options);
  refuse_same_files({options.recording}, {options.out});
  RecordingOptions reading = options.reading;
  reading.faults = FaultPolicy::event;  // missing points are counted
  const auto recording = open_with_all_points(options.recording, reading);
  const TakenLandmarks taken =
      take_landmarks(read_named_points(*recording, options.recording), plan, options.recording);
  const std::string text = landmarks_toml(taken, options.recording);
  static_cast<void>(landmarks_from(text, options.out));
  OutputFile file(options.out);
  file.write(text);
  file.close();
  file.commit();
  print_output(banner() + summary_of(taken) + fmt::format("landmarks   {}\n", options.out));
  return kExitOk;
}

}  // namespace

Command add_landmarks(CommandLine app) {
  auto options = std::make_shared<LandmarksOptions>();
  const CommandLine command = app.add_command(
      "landmarks", "Take landmarks from a recording of a pointer", "Analyse recordings");
  command.add_example(
      "condyle landmarks pointer.csv --pointer S,T,U --tip-calibration 1 9 --head D,E,F --jaw "
      "A,B,C "
      "--reference-s 10 12 --at condyle_left 14 15 --at condyle_right 18 19 --at incisor_lower 22 "
      "23 --at plane_left 26 27 --at plane_right 30 31 --at plane_front 34 35 --out landmarks.toml",
      "Find the pointer's tip, then the landmarks, while head and jaw may move.");
  command.add_example(
      "condyle landmarks touched.csv --point M --at condyle_left 4 5 --at condyle_right 8 9 --at "
      "incisor_lower 12 13 --at plane_left 16 17 --at plane_right 20 21 --at plane_front 24 25 "
      "--out landmarks.toml",
      "Hold the tracked point M itself to each landmark.");
  command
      .add_option("RECORDING", options->recording,
                  "CSV with points by name, or a session log of a device with three points p1, p2, "
                  "p3")
      .required();
  command.add_option("--pointer=A,B,C", options->pointer, "Points of the pointer, three or more");
  command
      .add_option("--tip", options->tip_mm,
                  "X Y Z (mm) of its tip, in the frame of its first three points (as for "
                  "--jaw-point-mm of condyle replay)")
      .values(3)
      .number_in({-kFarthestTip_mm, kFarthestTip_mm});
  command
      .add_option("--tip-calibration", options->calibration_s,
                  "BEGIN END (s): the tip rests in a hole, the pointer tilts to all sides")
      .values(2);
  command.add_option("--point=NAME", options->point,
                     "Without a pointer: the point that is held to each landmark");
  command
      .add_option("--at", options->at_words,
                  "NAME BEGIN END (s) in which a landmark is touched: condyle_left, condyle_right, "
                  "incisor_lower, plane_left, plane_right or plane_front; repeatable. In a session "
                  "log a marker with such a name begins 0.5 s")
      .values_each(3);
  add_body_options(command, options->jaw, options->head, "not tracked if not given");
  command
      .add_option("--reference-s", options->reference_s,
                  "BEGIN END of a rest in the reference position; with --jaw or --head")
      .values(2);
  command
      .add_option("--touch-sd-mm", options->touch_sd_mm,
                  "How well the landmarks were found: standard deviation along each axis")
      .number_in({0, 50})
      .show_default();
  command.add_option("--kind", options->kind, "What the condylar points are")
      .one_of({"kinematic", "hinge", "palpated", "arbitrary"})
      .show_default();
  command.add_option("--plane", options->plane, "The reference plane")
      .one_of({"Frankfurt", "Camper", "axis-orbital"});
  add_reading_options(command, options->reading);
  command.group("Output")
      .add_option("-o,--out=FILE", options->out, "TOML file for the landmarks")
      .required();
  return [options] { return take(*options); };
}

}  // namespace condyle::host
