// SPDX-License-Identifier: Apache-2.0
// Scenario of a jaw that moves with six degrees of freedom.
//
// Frames, right-handed, X anterior, Y left, Z up, origin midway between the condylar points at the
// reference position:
//   jaw frame of the fossae   the condylar paths are given in it
//   head frame A              turned from it about Y by plane_tilt_deg; its plane Z = 0 is parallel
//                             to the reference plane. Poses and readings are given in it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "simulation/instrument.h"

namespace condyle::host {

enum class JawSide : std::uint8_t { none, left, right };
/// "left", "right" or empty.
const char* jaw_side_name(JawSide side);

/// Path of a condyle along its fossa: z = -(tan(inclination) x - curvature x^2). When it orbits, it
/// also moves inwards by shift (1 - exp(-x / 0.4 mm)) + x tan(progressive shift).
struct CondylarPath {
  double inclination_deg = 52;  ///< at the reference position, to the frame of the fossae
  double curvature_per_mm = 0.035;
  double immediate_shift_mm = 0.4;
  double progressive_shift_deg = 8;
  double fischer_deg = 0;  ///< inclination when it orbits, beyond inclination_deg
};

/// The subject.
struct JawAnatomy {
  double half_width_mm = 50;  ///< of a condylar point from the midline
  double incisor_x_mm = 95, incisor_z_mm = -40;
  double plane_tilt_deg = 0;  ///< of the reference plane; positive: its front end is lower
  double plane_back_x_mm = -10, plane_back_y_mm = 55;  ///< its points (porions), in its own plane
  double plane_front_x_mm = 75, plane_front_y_mm = 33;
  CondylarPath left, right;
};

enum class JawTaskKind : std::uint8_t { rest, opening, protrusion, left, right, border, chewing };
inline constexpr std::size_t kJawTaskKinds = 7;
/// "rest", "opening", ...
std::string jaw_task_name(JawTaskKind kind);

/// How the jaw chews. Sizes refer to a cycle of mean size.
struct ChewingPattern {
  double cycle_s = 0.8;
  double opening_share = 0.45;         ///< of the cycle's duration
  double lateral_advance_mm = 4;       ///< of the orbiting condyle before the other
  JawSide first_side = JawSide::left;  ///< working side of the first cycle
  bool alternates = false;             ///< the working side changes from cycle to cycle
  double reversed_share = 0;           ///< of cycles that open on the working side
  double closed_acceleration = 0.6;    ///< at the closed instants, 1: as of a sine
  int cycles_in_sequence = 8;
  double pause_s = 1;    ///< after each part
  bool swallows = true;  ///< after a sequence: one opening of 1 to 3 mm
  double speech_s = 2;   ///< after a sequence: movements of 2 to 5 mm at 3 to 5 Hz; 0: none
};

/// One task. `default_task` gives typical sizes.
struct JawTask {
  JawTaskKind kind = JawTaskKind::rest;
  double duration_s = 5;      ///< of rest; chewing starts no sequence that would end after it
  int strokes = 3;            ///< of opening, protrusion, left, right; sweeps of border
  double advance_mm = 0;      ///< greatest x of a translating condyle
  double angle_deg = 0;       ///< greatest opening angle
  double stroke_s = 1.5;      ///< one way
  double hold_s = 0.3;        ///< at the greatest excursion
  double rest_s = 0.5;        ///< between strokes
  double size_spread = 0.08;  ///< relative standard deviation over strokes or cycles
  double duration_spread = 0.1;
  ChewingPattern chewing;
};
JawTask default_task(JawTaskKind kind);

/// How instrument, fork and head stand to each other.
struct JawMounting {
  double rotation_deg[3] = {};        ///< instrument's frame to A, about x, then y, then z of A
  double translation_mm[3] = {};      ///< of A's origin in the instrument's frame
  double fork_mm[3] = {100, 0, -50};  ///< centroid of the fork's points in A
  double fork_rotation_deg[3] =
      {};                 ///< from x left, y up, z anterior; about x, then y, then z of A
  bool is_upper = false;  ///< the fork is on the head: each displacement is inverted
};

/// Standard deviations of the stated landmarks, along each axis.
struct LandmarkErrors {
  double condyle_sd_mm = 0, incisor_sd_mm = 0, plane_sd_mm = 0;
};

/// Published noise levels of jaw trackers: (m, rad).
inline constexpr double kFineNoise_m = 2e-5, kFineNoise_rad = 8e-4;
inline constexpr double kCoarseNoise_m = 1.82e-4, kCoarseNoise_rad = 2.2e-3;

/// The scenario. `motion_seed` draws the sizes and durations of the movements; the instrument's and
/// the landmarks' errors have another seed, so that runs with different errors share the truth.
struct JawScenario {
  std::string name;
  std::uint64_t motion_seed = 1;
  std::uint64_t seed = 1;           ///< of the errors, if the user gives none
  double gap_s = 1;                 ///< of rest before, between and after tasks
  double translation_delay = 0.15;  ///< share of an opening stroke that is a pure rotation
  double working_share = 0.03;      ///< advance of the working condyle as a share of the other's
  JawAnatomy anatomy;
  std::vector<JawTask> tasks;  ///< in this order; of each kind at most one
  FacebowModel facebow{.noise_m = kFineNoise_m, .noise_rad = kFineNoise_rad};
  JawMounting mounting;
  LandmarkErrors landmarks;
};

}  // namespace condyle::host
