// SPDX-License-Identifier: Apache-2.0
#include "estimation/learned_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "condyle/estimator/motion/kernel_regression.h"
#include "condyle/estimator/sensors/recommended_parameters.h"
#include "condyle/hal/log/session_log_reader.h"
#include "hosted/files/input_error.h"
#include "hosted/files/text_file.h"

namespace condyle::host {
namespace {

constexpr double kMostRateRatio = 1.25;
constexpr double kLargest = 1e6;
using Regression = KernelRegression<double, 1>;

bool is_mcap(const std::string& path) {
  std::array<char, hal::kMcapMagic.size()> begin{};
  std::ifstream file(path, std::ios::binary);
  file.read(begin.data(), begin.size());
  return file && std::equal(begin.begin(), begin.end(), hal::kMcapMagic.begin(),
                            [](char a, auto b) { return static_cast<std::uint8_t>(a) == b; });
}

std::size_t size_of(const std::string& name, std::size_t kernels) {
  const std::size_t weights = Regression::kLinear + kernels;
  if (name == "position_square_m2") return 1;
  if (name == "squares") return Regression::kOutputs;
  if (name == "centres") return kernels * Regression::kPlace;
  if (name == "use") return kernels;
  return name == "covariance" ? weights * (weights + 1) / 2 : weights;
}

// What is wrong with the values `name`; empty: nothing.
std::string problem_of(const std::string& name, const std::vector<double>& values,
                       std::size_t kernels) {
  const std::size_t size = size_of(name, kernels);
  if (values.size() != size) {
    return fmt::format("has {} values of {}, not {}", values.size(), name, size);
  }
  for (const double value : values) {
    if (!(std::abs(value) <= kLargest)) return fmt::format("has a value of {} beyond 1e6", name);
  }
  const bool is_square = name == "squares" || name == "position_square_m2";
  for (std::size_t i = 0; is_square && i < size; ++i) {
    if (!(values[i] > 0)) return fmt::format("has a value of {} that is not above 0", name);
  }
  for (std::size_t i = 0; name == "covariance" && i * (i + 3) / 2 < size; ++i) {
    if (!(values[i * (i + 3) / 2] > 0)) return "has a variance that is not above 0";
  }
  return {};
}

LearnedAxis axis_in(const nlohmann::json& json, const std::string& path, double most_kernels) {
  const char* const mend = "write it anew with --learned-out";
  LearnedAxis axis;
  axis.kernels = json.at("kernels").get<int>();
  if (axis.kernels < 0) throw InputError(path, "has a negative number of kernels", mend);
  if (axis.kernels > most_kernels) {
    throw InputError(path, fmt::format("has {} kernels", axis.kernels),
                     fmt::format("give [learning] kernels = {} or more, at most {}", axis.kernels,
                                 kMostKernels));
  }
  for (const char* const name : {"position_square_m2", "squares", "centres", "use",
                                 "velocity_weights", "acceleration_weights", "covariance"}) {
    auto values = json.at(name).get<std::vector<double>>();
    const std::string problem = problem_of(name, values, static_cast<std::size_t>(axis.kernels));
    if (!problem.empty()) throw InputError(path, problem, mend);
    axis.values[name] = std::move(values);
  }
  return axis;
}

LearnedMotion parse_learned(const std::string& text, const std::string& path, int axis_count,
                            double step_s, double most_kernels, int lag) {
  const char* const mend = "give a session log, or a file that --learned-out has written";
  LearnedMotion learned;
  try {
    const auto json = nlohmann::json::parse(text);
    if (json.at("format") != kLearnedFormat) {
      throw InputError(path, fmt::format("is not of format {}", kLearnedFormat), mend);
    }
    learned.rate_Hz = json.at("rate_Hz").get<double>();
    learned.lag = json.value("lag", 0);
    for (const nlohmann::json& axis : json.at("axes")) {
      learned.axes.push_back(axis_in(axis, path, most_kernels));
    }
  } catch (const nlohmann::json::exception&) {
    throw InputError(path, "does not hold what a recording has taught", mend);
  }
  if (learned.axes.size() != static_cast<std::size_t>(axis_count)) {
    throw InputError(path,
                     fmt::format("was learned along {} axes, and this recording has {}",
                                 learned.axes.size(), axis_count),
                     "learn from a recording of the same kind");
  }
  if (learned.lag != lag) {
    throw InputError(path,
                     fmt::format("was learned with a lag of {} samples, and this recording is "
                                 "estimated with {}",
                                 learned.lag, lag),
                     lag == 0 ? fmt::format("give --lag {}, or learn without a lag", learned.lag)
                              : fmt::format("learn with --lag {}", lag));
  }
  const double ratio = learned.rate_Hz * step_s;
  if (step_s > 0 && !(ratio < kMostRateRatio && ratio > 1 / kMostRateRatio)) {
    throw InputError(path,
                     fmt::format("was learned at {:.4g} Hz, and this recording has {:.4g} Hz",
                                 learned.rate_Hz, 1 / step_s),
                     "learn from a recording of the same rate");
  }
  return learned;
}

}  // namespace

void LearnedFiles::refuse_unless(bool learns) const {
  if (learns || !are_given()) return;
  throw InputError(begin_with.empty() ? "--learned-out" : "--learned", "needs learning",
                   "give no lag of 16, nor [learning] kernels = 0, nor the published cascade; or "
                   "leave it out");
}

bool begins_as_session(const RecordingInfo& info, const EstimatorChoice& estimator,
                       const LearnedFiles& files) {
  return !info.begun_with_json.empty() && files.begin_with.empty() &&
         estimator.parameters.empty() && estimator.lag == 0 && !estimator.is_published();
}

LearnedMotion read_learned(const std::string& path, int axis_count, double step_s,
                           double most_kernels, int lag) {
  std::string text;
  if (!is_mcap(path)) {
    text = read_text_file(path);
  } else if (hal::read_learned_text(path, text) != hal::Status::ok || text.empty()) {
    throw InputError(path, "does not hold what a session has taught",
                     "give a complete log that condyle record has written with learning on, or "
                     "replay it with --learned-out FILE and give that file");
  }
  return parse_learned(text, path, axis_count, step_s, most_kernels, lag);
}

LearnedMotion first_learned(const LearnedFiles& files, const RecordingInfo& info,
                            const EstimatorChoice& estimator, const std::string& recording,
                            int axis_count, double step_s, double most_kernels) {
  if (!files.begin_with.empty()) {
    return read_learned(files.begin_with, axis_count, step_s, most_kernels, estimator.lag);
  }
  if (!begins_as_session(info, estimator, files)) return {};
  return parse_learned(info.begun_with_json, recording, axis_count, 0, most_kernels, 0);
}

}  // namespace condyle::host
