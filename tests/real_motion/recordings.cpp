// SPDX-License-Identifier: Apache-2.0
#include "real_motion/recordings.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "real_motion/order_statistics.h"
#include "support/random.h"
#include "support/table.h"

namespace condyle::testing_support {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

// Columns time_s, x, y, z (mm); an empty field is a missing position.
MotionRecording read(const std::filesystem::path& path) {
  MotionRecording recording;
  recording.position_m.resize(3);
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

MotionRecording thinned(const MotionRecording& recording, std::size_t every) {
  MotionRecording thin = recording;
  const auto keep = [every](Values& values) {
    Values kept;
    for (std::size_t i = 0; i < values.size(); i += every) kept.push_back(values[i]);
    values = kept;
  };
  keep(thin.time_s);
  for (auto& axis : thin.position_m) keep(axis);
  return thin;
}

MotionRecording rounded(MotionRecording recording, double step_m) {
  for (auto& axis : recording.position_m) {
    for (double& position_m : axis) position_m = step_m * std::nearbyint(position_m / step_m);
  }
  return recording;
}

void add_faults(MotionRecording& recording, unsigned seed) {
  const double T = recording.step_s();
  const auto samples = [T](double duration_s) { return static_cast<std::size_t>(duration_s / T); };
  Random random(seed);
  const auto between = [&random](double low, double high) {
    return low + (high - low) * random.uniform();
  };
  enum { glitch, dropout, frozen, double_glitch, kinds };
  int kind = glitch;
  const std::size_t apart = std::max(samples(1.1), std::size_t{30});
  for (std::size_t i = samples(1.0); i + samples(0.8) < recording.size(); i += apart) {
    const std::size_t dropped = std::max(samples(between(0.1, 0.3)), std::size_t{1});
    const double share = between(0.1, 1);
    for (auto& position_m : recording.position_m) {
      const auto [low, high] = finite_range(position_m);
      const double size_m = std::max(share * (high - low), 2e-3);
      const double offset_m = random.uniform() < 0.5 ? size_m : -size_m;
      const auto from = position_m.begin() + static_cast<std::ptrdiff_t>(i);
      if (kind == dropout) std::fill_n(from, dropped, kNone);
      if (kind == frozen) std::fill_n(from, samples(0.5), *from);
      if (kind == glitch || kind == double_glitch) from[0] += offset_m;
      if (kind == double_glitch) from[1] += offset_m;
    }
    kind = (kind + 1) % kinds;
  }
}

}  // namespace

bool MotionRecording::is_measured(std::size_t i) const {
  return std::all_of(position_m.begin(), position_m.end(),
                     [i](const auto& axis) { return std::isfinite(axis[i]); });
}

double MotionRecording::step_s() const {
  Values steps;
  for (std::size_t i = 1; i < size(); ++i) steps.push_back(time_s[i] - time_s[i - 1]);
  return median(steps);
}

std::vector<MotionRecording> read_real_recordings() {
  std::vector<MotionRecording> recordings;
  const std::filesystem::path list = reference_data("motion/meta.json");
  if (list.empty()) return recordings;
  for (const auto& entry : nlohmann::json::parse(std::ifstream(list))) {
    // Those under the GPL (Carstens AG501) are left out.
    const std::string licence = entry.at("licence");
    if (entry.at("split") != "open" || licence.starts_with("GPL")) continue;
    const std::string name = entry.at("name");
    recordings.push_back(read(list.parent_path() / "open" / (name + ".csv")));
    recordings.back().name = name;
    const std::string instrument = entry.at("instrument"), laboratory = entry.at("lab");
    recordings.back().instrument = instrument + ", " + laboratory;
    const std::string repository = entry.at("repo");
    recordings.back().source = "[" + repository + "](https://github.com/" + repository + ") (" +
                               licence.substr(0, licence.find(' ')) + ")";
  }
  return recordings;
}

const char* name_of(Treatment treatment) {
  constexpr const char* kNames[] = {"as recorded",         "every second sample",
                                    "every fourth sample", "rounded to 0.1 mm",
                                    "rounded to 0.01 mm",  "with faults"};
  return kNames[static_cast<std::size_t>(treatment)];
}

bool TreatedRecording::is_spoiled(std::size_t axis, std::size_t i) const {
  return !(std::abs(recording.position_m[axis][i] - clean.position_m[axis][i]) < 1e-12);
}

TreatedRecording treat(const MotionRecording& recording, Treatment treatment, unsigned seed) {
  const auto treated = [&]() -> MotionRecording {
    switch (treatment) {
      case Treatment::every_second:
        return thinned(recording, 2);
      case Treatment::every_fourth:
        return thinned(recording, 4);
      case Treatment::rounded_0_1_mm:
        return rounded(recording, 1e-4);
      case Treatment::rounded_0_01_mm:
        return rounded(recording, 1e-5);
      case Treatment::none:
      case Treatment::faults:
        break;
    }
    return recording;
  }();
  TreatedRecording result{treated, treated, treatment == Treatment::faults};
  if (result.has_faults) add_faults(result.recording, seed);
  return result;
}

}  // namespace condyle::testing_support
