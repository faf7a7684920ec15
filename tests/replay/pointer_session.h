// SPDX-License-Identifier: Apache-2.0
// A recording of jaw, head and a pointer that touches the landmarks.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

namespace condyle::testing_support {

using Point = std::array<double, 3>;

// Turned about the left-right axis through the origin, then shifted (mm).
inline Point moved(const Point& p, double angle_rad, const Point& shift) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return {c * p[0] + s * p[2] + shift[0], p[1] + shift[1], -s * p[0] + c * p[2] + shift[2]};
}

inline constexpr Point kJaw[] = {{90, 20, -50}, {90, -20, -50}, {120, 0, -40}, {100, 5, -70}};
inline constexpr Point kHead[] = {{80, 30, 80}, {80, -30, 80}, {60, 0, 120}};
inline constexpr Point kPointer[] = {{0, 20, 140}, {0, -20, 140}, {25, 0, 160}};
inline constexpr Point kLandmarks[] = {{0, 50, 0},   {0, -50, 0},   {95, 0, -40},
                                       {-10, 55, 2}, {-10, -55, 2}, {75, 33, 2}};
inline const std::vector<std::string> kNames = {"condyle_left", "condyle_right", "incisor_lower",
                                                "plane_left",   "plane_right",   "plane_front"};
inline constexpr double kOpening_rad = 0.3;

// Jaw, head and pointer at 50 Hz. The head turns by up to 15 deg all the time, unless it is still;
// then the tip is a point too, T. The pointer's tip
// is in a hole until 9 s and then on each landmark for 1.5 s; the jaw rests until 20 s, and opens
// twice until 30 s.
inline std::string pointer_session(bool is_still = false) {
  std::string csv = "time_s";
  for (const char* name : {"J1", "J2", "J3", "J4", "H1", "H2", "H3", "S1", "S2", "S3"}) {
    for (const char axis : {'x', 'y', 'z'}) csv += fmt::format(",{}_{}_mm", name, axis);
  }
  if (is_still) csv += ",T_x_mm,T_y_mm,T_z_mm";
  csv += "\n";
  for (int k = 0; k < 1500; ++k) {
    const double time_s = k * 0.02;
    const double nod_rad = is_still ? 0 : 0.26 * std::sin(0.7 * time_s);
    const double sway = is_still ? 0 : 1;
    const Point shift = {sway * 10 * std::sin(0.5 * time_s), sway * 8 * std::cos(0.4 * time_s),
                         300};
    const double phase = time_s < 20 ? 0 : (time_s - 20) / 5 * 2 * M_PI;
    const double opening_rad = kOpening_rad * (1 - std::cos(phase)) / 2;
    csv += fmt::format("{:.3f}", time_s);
    const auto write = [&](const Point& p) {
      // Digits as an instrument has them.
      csv += fmt::format(",{:.4f},{:.4f},{:.4f}", p[0], p[1], p[2]);
    };
    for (const Point& p : kJaw) write(moved(moved(p, opening_rad, {0, 0, 0}), nod_rad, shift));
    for (const Point& p : kHead) write(moved(p, nod_rad, shift));
    Point tip = {200, 100, 50};
    if (time_s > 9) {
      tip = moved(kLandmarks[std::min(5, static_cast<int>((time_s - 9) / 1.5))], nod_rad, shift);
    }
    for (const Point& p : kPointer) {
      // Tilts about the left-right axis, and about the one in front.
      Point tilted = moved(p, 0.5 * std::sin(2.1 * time_s), {0, 0, 0});
      const double a = 0.5 * std::sin(1.3 * time_s), y = tilted[1], z = tilted[2];
      tilted = {tilted[0], std::cos(a) * y - std::sin(a) * z, std::sin(a) * y + std::cos(a) * z};
      write({tilted[0] + tip[0], tilted[1] + tip[1], tilted[2] + tip[2]});
    }
    if (is_still) write(tip);
    csv += "\n";
  }
  return csv;
}

}  // namespace condyle::testing_support
