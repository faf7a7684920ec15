// SPDX-License-Identifier: Apache-2.0
#include "real_motion/recordings.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

#include "consistency/random.h"
#include "replay/table.h"

namespace condyle::testing_support {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Columns time_s, x, y, z (mm); an empty field is a missing position.
RealRecording read(const std::filesystem::path& path) {
  RealRecording recording;
  recording.name = path.stem();
  std::ifstream file(path);
  std::string line, field;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::stringstream fields(line);
    std::getline(fields, field, ',');
    recording.time_s.push_back(std::stod(field));
    for (auto& axis : recording.position_m) {
      field.clear();
      std::getline(fields, field, ',');
      axis.push_back(field.empty() ? kNone : 1e-3 * std::stod(field));
    }
  }
  return recording;
}

RealRecording thinned(const RealRecording& recording, std::size_t every) {
  RealRecording thin;
  thin.name = recording.name;
  for (std::size_t i = 0; i < recording.size(); i += every) {
    thin.time_s.push_back(recording.time_s[i]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      thin.position_m[axis].push_back(recording.position_m[axis][i]);
    }
  }
  return thin;
}

RealRecording rounded(RealRecording recording, double step_m) {
  for (auto& axis : recording.position_m) {
    for (double& position_m : axis) position_m = step_m * std::round(position_m / step_m);
  }
  return recording;
}

void add_faults(TreatedRecording& treated) {
  RealRecording& recording = treated.recording;
  const double T = recording.step_s();
  const auto samples = [T](double duration_s) { return static_cast<std::size_t>(duration_s / T); };
  std::array<double, 3> span_m{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (const double position_m : recording.position_m[axis]) {
      low = std::fmin(low, position_m);
      high = std::fmax(high, position_m);
    }
    span_m[axis] = high - low;
  }
  Random random(1);
  std::size_t kind = 0;
  const std::size_t apart = std::max(samples(1.1), std::size_t{30});
  for (std::size_t i = samples(1.0); i + samples(0.8) + 1 < recording.size(); i += apart) {
    const std::size_t count = kind == 1
                                  ? std::max(samples(0.1 + 0.2 * random.uniform()), std::size_t{1})
                              : kind == 2 ? samples(0.5)
                              : kind == 3 ? 2
                                          : 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      auto& position_m = recording.position_m[axis];
      const double size_m = std::max(span_m[axis] * (0.1 + 0.9 * random.uniform()), 2e-3);
      const double offset_m = random.uniform() < 0.5 ? size_m : -size_m;
      for (std::size_t j = i; j < i + count; ++j) {
        if (kind == 1) position_m[j] = kNone;
        if (kind == 2) position_m[j] = position_m[i];
        if (kind == 0 || kind == 3) position_m[j] += offset_m;
      }
    }
    for (std::size_t j = i + (kind == 2 ? 1 : 0); j < i + count; ++j) treated.is_spoiled[j] = true;
    kind = (kind + 1) % 4;
  }
}

}  // namespace

bool RealRecording::is_measured(std::size_t i) const {
  return std::all_of(position_m.begin(), position_m.end(),
                     [i](const auto& axis) { return std::isfinite(axis[i]); });
}

double RealRecording::step_s() const {
  std::vector<double> steps;
  for (std::size_t i = 1; i < size(); ++i) steps.push_back(time_s[i] - time_s[i - 1]);
  std::nth_element(steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2),
                   steps.end());
  return steps[steps.size() / 2];
}

std::vector<RealRecording> read_real_recordings() {
  const std::filesystem::path one = reference_data("motion/open/aalto_marker1.csv");
  std::vector<RealRecording> recordings;
  if (one.empty()) return recordings;
  for (const auto& entry : std::filesystem::directory_iterator(one.parent_path())) {
    const std::string name = entry.path().filename();
    // Those of the AG501 come under the GPL.
    if (entry.path().extension() != ".csv" || name.starts_with("ag501")) continue;
    recordings.push_back(read(entry.path()));
  }
  std::sort(recordings.begin(), recordings.end(),
            [](const auto& a, const auto& b) { return a.name < b.name; });
  return recordings;
}

const char* name_of(Treatment treatment) {
  constexpr const char* kNames[] = {"as recorded",       "every second", "every fourth",
                                    "rounded to 0.1 mm", "to 0.01 mm",   "faults"};
  return kNames[static_cast<std::size_t>(treatment)];
}

TreatedRecording treat(const RealRecording& recording, Treatment treatment) {
  TreatedRecording treated;
  treated.recording = treatment == Treatment::every_second      ? thinned(recording, 2)
                      : treatment == Treatment::every_fourth    ? thinned(recording, 4)
                      : treatment == Treatment::rounded_0_1_mm  ? rounded(recording, 1e-4)
                      : treatment == Treatment::rounded_0_01_mm ? rounded(recording, 1e-5)
                                                                : recording;
  treated.clean = treated.recording;
  treated.is_spoiled.assign(treated.recording.size(), false);
  if (treatment == Treatment::faults) add_faults(treated);
  return treated;
}

}  // namespace condyle::testing_support
