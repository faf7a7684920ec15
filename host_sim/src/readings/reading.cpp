// SPDX-License-Identifier: Apache-2.0
#include "readings/reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace condyle::host {
namespace {

// 95 % of a normal distribution lie within this many standard deviations.
constexpr double kHalf95 = 1.959964;

constexpr const char* kTaskNames[kTaskKinds] = {"opening", "protrusion", "left", "right",
                                                "chewing", "border",     "rest"};

}  // namespace

const char* name_of(TaskKind kind) {
  return kind == TaskKind::whole ? "" : kTaskNames[static_cast<std::size_t>(kind)];
}

std::vector<std::string_view> task_names() {
  return {std::begin(kTaskNames), std::end(kTaskNames)};
}

const char* name_of(Side side) {
  return side == Side::left ? "left" : side == Side::right ? "right" : "";
}

const char* name_of(ReadingProvenance provenance) {
  return provenance == ReadingProvenance::measured  ? "measured"
         : provenance == ReadingProvenance::derived ? "derived"
                                                    : "withheld";
}

const ReadingDefinition& definition_of(std::string_view name) {
  const auto& all = reading_definitions();
  const auto found = std::find_if(all.begin(), all.end(), [name](const ReadingDefinition& other) {
    return other.name == name;
  });
  if (found == all.end()) throw std::logic_error(fmt::format("no reading {}", name));
  return *found;
}

double UncertainValue::half_interval() const {
  double variance = noise_sd * noise_sd;
  for (const double change : fixed) variance += change * change;
  return std::sqrt(kHalf95 * kHalf95 * variance + smoothing * smoothing);
}

void UncertainValue::set_half_interval(double half) {
  noise_sd = half / kHalf95;
  smoothing = 0;
  fixed.clear();
}

UncertainValue mean_of(const std::vector<UncertainValue>& strokes) {
  UncertainValue mean;
  double count = 0, variance = 0;
  for (const UncertainValue& stroke : strokes) {
    if (!std::isfinite(stroke.value)) {
      if (mean.missing.empty()) mean.missing = stroke.missing;
      continue;
    }
    if (count == 0) {
      mean.value = 0;
      mean.fixed.assign(stroke.fixed.size(), 0);
    }
    ++count;
    mean.value += stroke.value;
    mean.smoothing += stroke.smoothing;
    variance += stroke.noise_sd * stroke.noise_sd;
    for (std::size_t i = 0; i < stroke.fixed.size(); ++i) mean.fixed[i] += stroke.fixed[i];
  }
  if (count == 0) return mean;
  mean.missing.clear();
  mean.value /= count;
  mean.smoothing /= count;
  mean.noise_sd = std::sqrt(variance) / count;
  for (double& change : mean.fixed) change /= count;
  return mean;
}

JawReading judged(const ReadingDefinition& definition, const UncertainValue& value) {
  JawReading reading;
  reading.definition = &definition;
  const double half = value.half_interval();
  if (!std::isfinite(value.value) || !std::isfinite(half)) {
    reading.reason = value.missing.empty() ? "it could not be computed" : value.missing;
  } else if (half > definition.largest_half_interval) {
    const std::string unit =
        definition.unit == "1" ? std::string() : fmt::format(" {}", definition.unit);
    reading.reason = fmt::format("the interval would be +-{:.2g}{}, the limit is +-{:g}{}", half,
                                 unit, definition.largest_half_interval, unit);
  } else {
    reading.value = value.value;
    reading.low = value.value - half;
    reading.high = value.value + half;
    reading.provenance = ReadingProvenance::measured;
  }
  return reading;
}

}  // namespace condyle::host
