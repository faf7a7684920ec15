// SPDX-License-Identifier: Apache-2.0
#include "readings/reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

namespace condyle::host {
namespace {

constexpr const char* kTaskNames[kTaskKinds] = {"opening", "protrusion", "left", "right",
                                                "chewing", "border",     "rest"};

// What noise explains of a contradiction, in standard deviations.
constexpr double kExplained = 2;
// Of the rest, what the interval contains: the narrow window hides part of the movement too.
constexpr double kTimesContradiction = 3;
// Share of hidden values that a mean may lack; how far these may lie from it, over the farthest
// known one.
constexpr double kMostHidden = 0.1, kTimesFarthest = 2;
// The most that one value adds to a shared contradiction, in standard deviations.
constexpr double kMostShared = 3;

// The most repetitions that are worth advising.
constexpr double kMostAdvised = 100;

// To two digits, never up.
double rounded_down(double share) {
  const double digits = std::pow(10, std::floor(std::log10(share)) - 1);
  return std::floor(share / digits * (1 + 1e-12)) * digits;
}

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
  return std::hypot(kHalf95 * std::sqrt(variance), systematic());
}

double UncertainValue::systematic() const {
  return std::hypot(std::hypot(doubt, of_contradiction()), corrections[0], corrections[1]);
}

double UncertainValue::of_contradiction() const {
  const double explained = kExplained * contradiction_sd;
  const double rest = std::max(contradiction * contradiction - explained * explained, 0.0);
  return kTimesContradiction * std::max(std::sqrt(rest), shared_contradiction);
}

void UncertainValue::scale_systematic(double factor) {
  doubt *= factor;
  contradiction *= factor;
  contradiction_sd *= factor;
  shared_contradiction *= factor;
  scale_corrections(factor);
}

void UncertainValue::scale_corrections(double factor) {
  for (double& correction : corrections) correction *= factor;
}

void UncertainValue::set_half_interval(double half) {
  noise_sd = half / kHalf95;
  doubt = 0;
  corrections = {};
  contradiction = contradiction_sd = shared_contradiction = 0;
  fixed.clear();
}

UncertainValue mean_of(const std::vector<UncertainValue>& strokes) {
  UncertainValue mean;
  double count = 0, hidden = 0, variance = 0, contradiction_variance = 0;
  std::array<double, 2> squares{};
  for (const UncertainValue& stroke : strokes) {
    if (!std::isfinite(stroke.value)) {
      if (stroke.is_hidden && ++hidden == 1) mean.missing = stroke.missing;
      if (mean.missing.empty()) mean.missing = stroke.missing;
      continue;
    }
    if (count == 0) {
      mean.value = 0;
      mean.fixed.assign(stroke.fixed.size(), 0);
    }
    ++count;
    mean.value += stroke.value;
    mean.doubt += stroke.doubt;
    mean.contradiction += stroke.contradiction;
    contradiction_variance += stroke.contradiction_sd * stroke.contradiction_sd;
    for (std::size_t i = 0; i < squares.size(); ++i) {
      mean.corrections[i] += stroke.corrections[i];
      squares[i] += stroke.corrections[i] * stroke.corrections[i];
    }
    variance += stroke.noise_sd * stroke.noise_sd;
    for (std::size_t i = 0; i < stroke.fixed.size(); ++i) mean.fixed[i] += stroke.fixed[i];
  }
  if (count == 0) return mean;
  if (hidden > kMostHidden * (count + hidden)) {
    mean.value = JawReading::kNone;
    mean.missing =
        fmt::format("not known for {:.0f} of {:.0f}, which may differ from the others: {}", hidden,
                    count + hidden, mean.missing);
    return mean;
  }
  mean.missing.clear();
  mean.repetitions = static_cast<int>(count);
  mean.value /= count;
  mean.doubt /= count;
  mean.contradiction /= count;
  mean.contradiction_sd = std::sqrt(contradiction_variance) / count;
  for (std::size_t i = 0; i < squares.size(); ++i) {
    double& correction = mean.corrections[i];
    correction =
        std::copysign(std::max(std::abs(correction), std::sqrt(squares[i])), correction) / count;
  }
  mean.noise_sd = std::sqrt(variance) / count;
  for (double& change : mean.fixed) change /= count;
  if (hidden == 0) return mean;
  double farthest = 0;
  for (const UncertainValue& stroke : strokes) {
    if (std::isfinite(stroke.value)) {
      farthest = std::max(farthest, std::abs(stroke.value - mean.value));
    }
  }
  mean.doubt = std::hypot(mean.doubt, kTimesFarthest * farthest * hidden / (count + hidden));
  return mean;
}

UncertainValue difference_of(UncertainValue value, const UncertainValue& other) {
  if (!std::isfinite(other.value)) value.missing = other.missing;
  value.value -= other.value;
  value.noise_sd = std::hypot(value.noise_sd, other.noise_sd);
  value.doubt += other.doubt;
  value.contradiction = std::abs(value.contradiction) + std::abs(other.contradiction);
  value.contradiction_sd += other.contradiction_sd;
  for (std::size_t i = 0; i < value.corrections.size(); ++i) {
    value.corrections[i] = std::abs(value.corrections[i]) + std::abs(other.corrections[i]);
  }
  for (std::size_t i = 0; i < value.fixed.size() && i < other.fixed.size(); ++i) {
    value.fixed[i] -= other.fixed[i];
  }
  return value;
}

void share_contradictions(const std::vector<UncertainValue*>& repeated) {
  double count = 0, squares = 0, variances = 0;
  for (const UncertainValue* value : repeated) {
    // Without noise it is in the interval already (abrupt parts).
    if (!std::isfinite(value->value) || value->contradiction_sd == 0) continue;
    ++count;
    const double size =
        std::min(std::abs(value->contradiction), kMostShared * value->contradiction_sd);
    squares += size * size;
    variances += value->contradiction_sd * value->contradiction_sd;
  }
  if (count < 2) return;
  // Of the mean of the squares of `count` normal errors: mean and standard deviations.
  const double explained = (1 + kExplained * std::sqrt(2 / count)) * variances / count;
  const double shared = std::sqrt(std::max(squares / count - explained, 0.0));
  for (UncertainValue* value : repeated) value->shared_contradiction = shared;
}

std::string what_narrows(const UncertainValue& value, double limit, std::string_view repeated) {
  double fixed = 0;
  for (const double change : value.fixed) fixed += change * change;
  fixed *= kHalf95 * kHalf95;
  const double noise = kHalf95 * kHalf95 * value.noise_sd * value.noise_sd;
  const double smoothing = value.systematic() * value.systematic(), all = limit * limit;
  // Windows do not become shorter with the rate, and less noise only shows more of it.
  if (value.of_contradiction() > limit / 2) {
    if (std::hypot(value.corrections[0], value.corrections[1]) > limit) {
      return "smoothing over 0.1 s and noise may leave a larger error; only a slower movement with "
             "less noise would narrow it";
    }
    return "the movement stops or turns too abruptly for the smoothing over 0.1 s; only a movement "
           "that does so more slowly would narrow it";
  }
  const double least = all / 10;  // with less room, one part alone would have to vanish
  if (const double room = all - fixed - smoothing; room > least) {
    const double most = std::ceil(value.repetitions * noise / room);
    if (value.repetitions > 0 && most <= kMostAdvised) {
      return fmt::format("{:.0f} {} like these would narrow it to the limit", most, repeated);
    }
    return fmt::format("{:.2g} of the instrument's noise would narrow it to the limit",
                       rounded_down(std::sqrt(room / noise)));
  }
  if (const double room = all - noise - smoothing; room > least) {
    return fmt::format(
        "landmarks and reference position located {:.1f} times as exactly would narrow it to the "
        "limit",
        std::ceil(10 * std::sqrt(fixed / room)) / 10);
  }
  if (all > noise + fixed) return "a higher sampling rate or less noise would narrow it";
  std::string needed;
  const auto add = [&](double part, const char* words) {
    if (part > all / 3) needed += (needed.empty() ? "" : " and ") + std::string(words);
  };
  add(noise, "less noise");
  add(fixed, "more exactly located landmarks");
  add(smoothing, "a higher sampling rate");
  return needed + " would narrow it";
}

JawReading judged(const ReadingDefinition& definition, const UncertainValue& value,
                  std::string_view repeated) {
  JawReading reading;
  reading.definition = &definition;
  const double half = value.half_interval();
  if (!std::isfinite(value.value) || !std::isfinite(half)) {
    reading.reason = value.missing.empty() ? "it could not be computed" : value.missing;
  } else if (half > definition.largest_half_interval) {
    const std::string unit =
        definition.unit == "1" ? std::string() : fmt::format(" {}", definition.unit);
    reading.reason = fmt::format("the interval would be +-{:.2g}{}, the limit is +-{:g}{}: {}",
                                 half, unit, definition.largest_half_interval, unit,
                                 what_narrows(value, definition.largest_half_interval, repeated));
  } else {
    reading.value = value.value;
    reading.low = value.value - half;
    reading.high = value.value + half;
    reading.provenance = ReadingProvenance::measured;
  }
  return reading;
}

}  // namespace condyle::host
