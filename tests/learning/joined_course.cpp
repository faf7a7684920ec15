// SPDX-License-Identifier: Apache-2.0
#include "learning/joined_course.h"

#include <algorithm>
#include <cmath>

#include "simulation/reference_motion.h"
#include "support/random.h"

namespace condyle::testing_support {
namespace {

constexpr const char* kMotions[kParts] = {"prescribed",   "rest",       "free_opening",
                                          "side_to_side", "prescribed", "protrusion",
                                          "clench",       "prescribed"};

}  // namespace

Course changing_course(SuddenChange change, double rate_Hz, double noise_m, std::uint64_t seed) {
  Random random(seed);
  host::MotionTask task;
  task.amplitude_m = 0.010 + 0.010 * random.uniform();
  task.cycle_rate_Hz = 0.9 + 0.8 * random.uniform();
  task.amplitude_spread = 0.05;
  task.rate_spread = 0.03;
  host::ReferenceMotion motion(
      task, {[&random] { return random.normal(); }, [&random] { return random.uniform(); }});
  const auto count = static_cast<std::size_t>((kChange_s + 5) * rate_Hz);
  const auto changed = static_cast<std::size_t>(kChange_s * rate_Hz);
  std::vector<host::MotionPoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back(motion.at(static_cast<double>(i) / rate_Hz));
  }
  Course course;
  course.rate_Hz = rate_Hz;
  for (std::size_t i = 0; i < count; ++i) {
    host::MotionPoint now = points[i];
    if (i > changed) {
      const host::MotionPoint& then = points[changed];
      switch (change) {
        case SuddenChange::stops:
          now = {then.position_m, 0, 0};
          break;
        case SuddenChange::doubles:
          now = {then.position_m + 2 * (now.position_m - then.position_m), 2 * now.velocity_m_s,
                 2 * now.acceleration_m_s2};
          break;
        case SuddenChange::reverses:
          now = points[2 * changed - i];
          now.velocity_m_s = -now.velocity_m_s;
          break;
      }
    }
    course.add(static_cast<double>(i) / rate_Hz, now.position_m + noise_m * random.normal(),
               now.velocity_m_s, now.acceleration_m_s2);
  }
  return course;
}

Course joined_course(double rate_Hz, double noise_m, std::uint64_t seed) {
  Course joined;
  joined.rate_Hz = rate_Hz;
  double end_m = 0, begin_s = 0;
  for (int part = 0; part < kParts; ++part, begin_s += kPart_s) {
    const Course course = simulate_course(
        {.scenario = kMotions[part], .rate_Hz = rate_Hz, .noise_m = noise_m, .duration_s = kPart_s},
        seed + static_cast<std::uint64_t>(part));
    const double shift_m = end_m - course.samples.front().coordinates[0];
    const auto count =
        std::min(course.samples.size(), static_cast<std::size_t>(std::lround(kPart_s * rate_Hz)));
    for (std::size_t i = 0; i < count; ++i) {
      end_m = course.samples[i].coordinates[0] + shift_m;
      joined.add(begin_s + static_cast<double>(i) / rate_Hz, end_m, course.velocity_m_s[i],
                 course.acceleration_m_s2[i]);
    }
  }
  return joined;
}

}  // namespace condyle::testing_support
