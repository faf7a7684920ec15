// SPDX-License-Identifier: Apache-2.0
#include "options/analysis_options.h"

#include <fmt/format.h>

#include <cmath>

#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

constexpr double kFarthestPoint_mm = 1000;

CommandLine group_of(CommandLine command) {
  return command.group("What is read and followed");
}

}  // namespace

void add_followed_options(CommandLine line, FollowedChoice& choice, JawPoints jaw_points) {
  const CommandLine command = group_of(line);
  const Option point = command.add_option("--point", choice.followed.point, "Point to follow")
                           .within(1, 3)
                           .show_default();
  const auto take_axis = [&choice](const std::string& axis) {
    choice.followed.axis = static_cast<Axis>(axis[0] - 'x');
    choice.axis_given = true;
  };
  command.on_option("--axis", take_axis, "Axis to follow")
      .one_of({"x", "y", "z"})
      .show_default("z");
  if (jaw_points == JawPoints::no) return;
  command
      .add_option("--jaw-point-mm", choice.jaw_point_mm,
                  "X Y Z of a point fixed to the jaw, in the frame of the three points (origin "
                  "point 1, x from point 3 to 2, z in their plane towards the middle of 2 and 3)")
      .values(3)
      .number_in({-kFarthestPoint_mm, kFarthestPoint_mm})
      .excludes(point);
}

void add_faults_option(CommandLine line, RecordingOptions& reading) {
  const auto take_faults = [&reading](const std::string& policy) {
    reading.faults = policy == "event" ? FaultPolicy::event : FaultPolicy::refuse;
  };
  group_of(line)
      .on_option("--faults", take_faults, "What to do with missing, non-finite and reversed rows")
      .one_of({"refuse", "event"})
      .show_default("refuse");
}

void add_recording_options(CommandLine line, RecordingChoice& choice, JawPoints jaw_points) {
  add_followed_options(line, choice, jaw_points);
  add_faults_option(line, choice.reading);
  add_reading_options(group_of(line), choice.reading);
}

void add_reading_options(CommandLine command, RecordingOptions& reading, FrameRate frame_rate) {
  command
      .add_option("--ignore-column", reading.ignored_columns,
                  "CSV column to ignore; may be given several times")
      .one_value_each();
  command
      .add_option("--marker", reading.markers,
                  "Marker to read, by name; three of one rigid body give its pose")
      .one_value_each();
  command
      .add_option("--columns=NEW=OLD,...", reading.columns,
                  "Names for the columns of a CSV file: time_s=T,position_mm=jaw")
      .one_value_each()
      .separated_by(',');
  if (frame_rate == FrameRate::yes) {
    command
        .add_option("--rate-Hz", reading.rate_Hz,
                    "Frames per second of a text file whose rows have no time")
        .number_in({1e-3, 1e6});
  }
  command.add_option("--profile=FILE", reading.profile,
                     fmt::format("{}; a capture needs it, a session log has one", kProfileMeaning));
  const auto take_unit = [&reading](const std::string& unit) {
    reading.units_per_metre = unit == "mm" ? 1000 : 1;
  };
  command.on_option("--unit", take_unit, "Unit of the coordinates, whatever the file states")
      .one_of({"mm", "m"});
  command.on_option(
      "--missing=NUMBER,...", [&reading](const std::string& text) { reading.missing.state(text); },
      "Numbers that stand for a missing place where they are on all axes, such as -1,-999; none: "
      "all are places");
  command.add_option("--movement", reading.movement, "Movement of a Zebris XML file")
      .within(1, 1'000'000)
      .show_default();
}

void add_estimator_options(CommandLine line, EstimatorChoice& choice) {
  const CommandLine command = line.group("Estimator");
  command.add_option("--estimator", choice.name, "Which estimator runs")
      .one_of({"recommended", "published"})
      .show_default();
  command
      .add_option(
          "--lag", choice.lag,
          "Fixed lag in samples: a larger lag gives more accurate, later estimates (recommended)")
      .within(0, 16)
      .show_default();
  command.add_option("--parameters=FILE", choice.parameters,
                     "TOML file with the parameters of the estimator");
}

void add_learned_options(CommandLine line, LearnedFiles& files) {
  const CommandLine command = line.group("Estimator");
  command.add_option("--learned=FILE", files.begin_with,
                     "Begin with what an earlier recording of this subject has taught: a file of "
                     "--learned-out, or a session log");
  command.add_option("--learned-out=FILE", files.out,
                     "JSON file for what this recording teaches, for --learned");
}

PoseChoice PoseOptions::choice() const {
  PoseChoice choice;
  choice.twist_axis = static_cast<Axis>(twist_axis[0] - 'x');
  for (std::size_t i = 0; i + 3 < point_words.size(); i += 4) {
    JawPoint point{.name = point_words[i]};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::string& word = point_words[i + 1 + axis];
      double coordinate_mm = 0;
      if (parse_number(word, coordinate_mm) != NumberStatus::ok ||
          std::abs(coordinate_mm) > kFarthestPoint_mm) {
        throw InputError("--pose-point " + point.name,
                         quote(word) + " is not a coordinate from -1000 to 1000 mm",
                         "give NAME X Y Z, such as incisor 0 80 -30");
      }
      point.jaw_m[static_cast<Eigen::Index>(axis)] = coordinate_mm * 1e-3;
    }
    choice.add_point("--pose-point", point);
  }
  return choice;
}

void add_pose_options(CommandLine line, PoseOptions& options) {
  const CommandLine command = line.group("Whole pose");
  const Option pose = command.add_option(
      "--pose=FILE", options.file,
      "CSV file for the estimates of position and orientation of the jaw, from three points or a "
      "pose");
  command
      .add_option("--pose-point", options.point_words,
                  "NAME X Y Z (mm) of a point fixed to the jaw, in the frame of --jaw-point-mm, "
                  "whose motion is written too; may be given several times")
      .values_each(4)
      .needs(pose);
  command
      .add_option("--twist-axis", options.twist_axis,
                  "Axis of the instrument about which the jaw's turn counts as twist")
      .one_of({"x", "y", "z"})
      .show_default()
      .needs(pose);
}

void add_cycle_options(CommandLine line, CycleOptions& options) {
  const CommandLine command = line.group("Chewing cycles");
  const Option cycles = command.add_option(
      "--cycles=FILE", options.file,
      "CSV file for the chewing cycles of the followed point, as they end; follow the axis along "
      "which the jaw opens and closes");
  command
      .add_option("--closing", options.closing,
                  "Direction of the followed axis in which the jaw closes")
      .one_of({"positive", "negative"})
      .show_default()
      .needs(cycles);
}

void add_drive_options(CommandLine line, DriveStatement& drive) {
  const CommandLine command = line.group("Measured drive");
  command
      .add_option("--drive-missing", drive.missing_share,
                  "Largest share of the total force that the drive may miss; default: not known")
      .number_in({0, 1});
  command
      .add_option("--drive-gain-sd", drive.gain_sd,
                  "Relative uncertainty of the drive's gain (0.01)")
      .number_in({0, 1});
  command
      .add_option("--position-scale-sd", drive.position_scale_sd,
                  "Relative uncertainty of the scale of the positions (0)")
      .number_in({0, 1});
  command
      .add_option("--drive-angle-sd-deg", drive.axis_angle_sd_deg,
                  "Uncertainty of the angle between the drive's axis and the followed one (0)")
      .number_in({0, 57});
  command
      .add_option(
          "--drive-noise-N", drive.noise_sd_N,
          "Stated noise of each sample of the drive, for comparison with the noise found (0.01)")
      .number_in({1e-9, 1e3});
  command.add_option("--drive-delay-ms", drive.delay_ms, "Delay of the drive's time stamps (0)")
      .number_in({-1000, 1000});
  command.add_option("--drive-delay-sd-ms", drive.delay_sd_ms, "Uncertainty of that delay (5)")
      .number_in({0, 1000});
  command.add_flag(
      "--drive-fit-delay", drive.fits_delay,
      "Also estimate the delay, starting from these values, instead of widening the intervals");
  command
      .add_option("--coulomb-sd-N", drive.coulomb_sd_N,
                  "Estimate Coulomb friction separately; its expected size")
      .number_in({0, 1e6});
  constexpr const char* contact = "are not used: teeth or food may touch there";
  command
      .add_option("--contact-above-mm", drive.contact_above_mm,
                  fmt::format("Positions above {}", contact))
      .number_in({-1e6, 1e6});
  command
      .add_option("--contact-below-mm", drive.contact_below_mm,
                  fmt::format("Positions below {}", contact))
      .number_in({-1e6, 1e6});
}

}  // namespace condyle::host
