// SPDX-License-Identifier: Apache-2.0
#include "simulation/kinematic/jaw_scenario_file.h"

#include <filesystem>

#include "hosted/files/input_error.h"
#include "hosted/files/toml_reader.h"
#include "simulation/facebow_section.h"

namespace condyle::host {
namespace {

constexpr Range kShare{0, 1};
constexpr Range kSpread{0, 0.3};
constexpr Range kPause_s{0, 10};
constexpr std::int64_t kMostSeed = 9'000'000'000'000'000;
constexpr Range kAnyAngle_deg{-180, 180};

void read_condyle(TomlReader& file, const std::string& section, CondylarPath& path) {
  file.number(section, "inclination_deg", path.inclination_deg, "deg", {15, 70});
  file.number(section, "curvature_per_mm", path.curvature_per_mm, "1/mm", {0, 0.2});
  file.number(section, "immediate_shift_mm", path.immediate_shift_mm, "mm", {0, 3});
  file.number(section, "progressive_shift_deg", path.progressive_shift_deg, "deg", {0, 40});
  file.number(section, "fischer_deg", path.fischer_deg, "deg", {-10, 15});
}

void read_subject(TomlReader& file, JawScenario& scenario) {
  const std::string section = "kinematic";
  JawAnatomy& jaw = scenario.anatomy;
  file.number(section, "gap_s", scenario.gap_s, "s", {0.5, 10});
  file.number(section, "translation_delay", scenario.translation_delay, "share", {0, 0.8});
  file.number(section, "working_share", scenario.working_share, "share", {0, 0.3});
  file.number(section, "half_width_mm", jaw.half_width_mm, "mm", {30, 80});
  file.number(section, "incisor_x_mm", jaw.incisor_x_mm, "mm", {50, 150});
  file.number(section, "incisor_z_mm", jaw.incisor_z_mm, "mm", {-100, 0});
  file.number(section, "plane_tilt_deg", jaw.plane_tilt_deg, "deg", {-30, 30});
  file.number(section, "plane_back_x_mm", jaw.plane_back_x_mm, "mm", {-50, 20});
  file.number(section, "plane_back_y_mm", jaw.plane_back_y_mm, "mm", {20, 100});
  file.number(section, "plane_front_x_mm", jaw.plane_front_x_mm, "mm", {40, 150});
  file.number(section, "plane_front_y_mm", jaw.plane_front_y_mm, "mm", {-60, 60});
  read_condyle(file, section, jaw.left);
  jaw.right = jaw.left;
  read_condyle(file, "kinematic.left", jaw.left);
  read_condyle(file, "kinematic.right", jaw.right);
}

void read_chewing(TomlReader& file, ChewingPattern& chewing) {
  const std::string section = jaw_task_name(JawTaskKind::chewing);
  file.number(section, "cycle_s", chewing.cycle_s, "s", {0.3, 3});
  file.number(section, "opening_share", chewing.opening_share, "share", {0.25, 0.75});
  file.number(section, "lateral_advance_mm", chewing.lateral_advance_mm, "mm", {0, 10});
  std::size_t side = 0;
  file.choice(section, "side", side, {"left", "right", "alternating"});
  chewing.first_side = side == 1 ? JawSide::right : JawSide::left;
  chewing.alternates = side == 2;
  file.number(section, "reversed_share", chewing.reversed_share, "share", kShare);
  file.number(section, "closed_acceleration", chewing.closed_acceleration, "share", kShare);
  std::int64_t cycles = chewing.cycles_in_sequence;
  file.integer(section, "cycles_in_sequence", cycles, 1, 1000);
  chewing.cycles_in_sequence = static_cast<int>(cycles);
  file.number(section, "pause_s", chewing.pause_s, "s", kPause_s);
  file.boolean(section, "swallows", chewing.swallows);
  file.number(section, "speech_s", chewing.speech_s, "s", kPause_s);
}

JawTask read_task(TomlReader& file, JawTaskKind kind) {
  JawTask task = default_task(kind);
  const std::string section = jaw_task_name(kind);
  if (kind == JawTaskKind::rest || kind == JawTaskKind::chewing) {
    file.number(section, "duration_s", task.duration_s, "s", {1, 1800});
    if (kind == JawTaskKind::rest) return task;
  } else {
    std::int64_t strokes = task.strokes;
    file.integer(section, "strokes", strokes, 1, 50);
    task.strokes = static_cast<int>(strokes);
    file.number(section, "stroke_s", task.stroke_s, "s", {0.2, 10});
    file.number(section, "rest_s", task.rest_s, "s", kPause_s);
  }
  file.number(section, "advance_mm", task.advance_mm, "mm", {0, 25});
  file.number(section, "angle_deg", task.angle_deg, "deg", {0, 45});
  if (kind == JawTaskKind::border) return task;
  if (kind != JawTaskKind::chewing) file.number(section, "hold_s", task.hold_s, "s", kPause_s);
  file.number(section, "size_spread", task.size_spread, "share", kSpread);
  file.number(section, "duration_spread", task.duration_spread, "share", kSpread);
  return task;
}

void read_mounting(TomlReader& file, JawMounting& mounting) {
  constexpr Range place_mm{-1000, 1000};
  file.numbers("mounting", "rotation_deg", mounting.rotation_deg, 3, "deg", kAnyAngle_deg);
  file.numbers("mounting", "translation_mm", mounting.translation_mm, 3, "mm", place_mm);
  file.numbers("mounting", "fork_mm", mounting.fork_mm, 3, "mm", place_mm);
  file.numbers("mounting", "fork_rotation_deg", mounting.fork_rotation_deg, 3, "deg",
               kAnyAngle_deg);
  std::size_t moving = 0;
  file.choice("mounting", "moving", moving, {"lower", "upper"});
  mounting.is_upper = moving == 1;
}

}  // namespace

bool is_jaw_scenario(const std::string& path) {
  return TomlReader(path).has("", "kinematic");
}

JawScenario load_jaw_scenario(const std::string& path) {
  TomlReader file(path);
  JawScenario scenario;
  scenario.name = std::filesystem::path(path).stem().string();
  std::int64_t seed = 1, motion_seed = 1;
  file.integer("", "seed", seed, 0, kMostSeed);
  file.integer("", "motion_seed", motion_seed, 0, kMostSeed);
  scenario.seed = static_cast<std::uint64_t>(seed);
  scenario.motion_seed = static_cast<std::uint64_t>(motion_seed);
  read_subject(file, scenario);
  for (std::size_t i = 0; i < kJawTaskKinds; ++i) {
    const auto kind = static_cast<JawTaskKind>(i);
    // Reading an absent section makes its keys known to the messages.
    JawTask task = read_task(file, kind);
    if (kind == JawTaskKind::chewing) read_chewing(file, task.chewing);
    if (file.has("", jaw_task_name(kind))) scenario.tasks.push_back(task);
  }
  read_facebow(file, scenario.facebow);
  read_mounting(file, scenario.mounting);
  constexpr Range sd_mm{0, 20};
  file.number("landmarks", "condyle_sd_mm", scenario.landmarks.condyle_sd_mm, "mm", sd_mm);
  file.number("landmarks", "incisor_sd_mm", scenario.landmarks.incisor_sd_mm, "mm", sd_mm);
  file.number("landmarks", "plane_sd_mm", scenario.landmarks.plane_sd_mm, "mm", sd_mm);
  file.finish();
  if (scenario.tasks.empty()) {
    throw InputError(path, "the jaw has no task", "add a section such as [opening]");
  }
  return scenario;
}

}  // namespace condyle::host
