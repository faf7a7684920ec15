// SPDX-License-Identifier: Apache-2.0
#include "recordings/filled_numbers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

constexpr double kFar_m = 0.1, kJump_m = 0.01, kFarOnAxis_m = 0.05, kFarAtBegin_m = 0.5;
// A jaw that stops or turns at N does so within three of its last steps, or half a millimetre.
constexpr double kSteps = 3, kStill_m = 0.5e-3;
constexpr std::array<double, 8> kUsual{-1, -9, 99, -99, 999, -999, 9999, -9999};

bool is_usual(double number) {
  return std::find(kUsual.begin(), kUsual.end(), number) != kUsual.end();
}

}  // namespace

void MissingNumbers::state(const std::string& words) {
  text = words;
  numbers.clear();
  if (words == "none") return;
  std::string_view rest = words;
  for (bool is_last = false; !is_last;) {
    const std::size_t comma = rest.find(',');
    is_last = comma == std::string_view::npos;
    double number = 0;
    if (parse_number(rest.substr(0, comma), number) != NumberStatus::ok) {
      throw InputError("--missing " + words,
                       fmt::format("{} is not a number", quote(rest.substr(0, comma))),
                       "give the numbers that stand for a missing place, such as -1,-999, or none");
    }
    numbers.push_back(number);
    if (!is_last) rest.remove_prefix(comma + 1);
  }
}

bool MissingNumbers::has(double number) const {
  return std::find(numbers.begin(), numbers.end(), number) != numbers.end();
}

double FilledNumbers::in_unit(double value_m, double units_per_metre) {
  const double number = value_m * units_per_metre, whole = std::round(number);
  // The number as it stands in the file, which the conversion to metres rounds.
  return std::abs(number - whole) <= 1e-9 * std::abs(whole) ? whole : number;
}

void FilledNumbers::Track::move_to(const Eigen::Vector3d& place_m) {
  step_m = last_m.allFinite() ? (place_m - last_m).norm() : 0;
  last_m = place_m;
  is_at_zero_from_begin = is_at_zero_from_begin && place_m.isZero(0);
}

bool FilledNumbers::leaves_zero(const Eigen::Vector3d& place_m, const Track& track) const {
  return missing_.text.empty() && track.is_at_zero_from_begin && track.last_m.allFinite() &&
         place_m.norm() > kJump_m;
}

FilledNumbers::Verdict FilledNumbers::judge(const Eigen::Vector3d& place_m, const Track& track,
                                            double units_per_metre) const {
  const double number = in_unit(place_m[0], units_per_metre);
  if (!missing_.text.empty()) return missing_.has(number) ? Verdict::missing : Verdict::place;
  const Eigen::Vector3d& last_m = track.last_m;
  if (!last_m.allFinite()) return is_usual(number) ? Verdict::missing : Verdict::place;
  const double distance_m = (place_m - last_m).norm();
  if (distance_m > kFar_m) return Verdict::missing;
  if (!is_usual(number) && number != 0) return Verdict::place;
  const bool has_decimals = std::any_of(last_m.begin(), last_m.end(), [&](double value_m) {
    const double value = in_unit(value_m, units_per_metre);
    return value != std::round(value);
  });
  if (has_decimals && is_usual(number)) {
    return distance_m > kJump_m ? Verdict::missing : Verdict::unclear;
  }
  // Rounding to whole units moves a place by up to one on each axis.
  const double rounding_m = has_decimals ? kStill_m : 2 * std::sqrt(3) / units_per_metre;
  if (distance_m <= kSteps * track.step_m + rounding_m) return Verdict::place;
  return number == 0 ? Verdict::missing : Verdict::unclear;
}

void FilledNumbers::refuse(double number, const std::string& place) {
  throw InputError(
      place,
      fmt::format("{0:g} on all three axes may be a place, or stand for a missing one", number),
      fmt::format("give --missing {:g} if it is missing, or --missing none", number));
}

void FilledNumbers::refuse_beginning(const std::string& place) {
  throw InputError(
      place,
      "a point jumps away from 0 0 0, where it was from the beginning: it may not have "
      "been seen until here",
      "give --missing 0 if it was not seen, or --missing none");
}

bool FilledNumbers::is_missing(double value_m, double units_per_metre) {
  if (!std::isfinite(value_m)) return false;
  const double number = in_unit(value_m, units_per_metre);
  const bool is_missing =
      !missing_.text.empty()
          ? missing_.has(number)
          : is_usual(number) && std::abs(number) >= 99 &&
                (std::isfinite(last_of_axis_m_) ? std::abs(value_m - last_of_axis_m_) > kFarOnAxis_m
                                                : std::abs(value_m) > kFarAtBegin_m);
  if (is_missing) {
    count(number);
  } else {
    last_of_axis_m_ = value_m;
  }
  return is_missing;
}

void FilledNumbers::add_notes(std::vector<std::string>& notes) const {
  for (const auto& [number, samples] : counts_) {
    notes.push_back(
        fmt::format("{:g} on all axes counts as a missing place: {} time{}{}", number, samples,
                    samples == 1 ? "" : "s",
                    !missing_.text.empty() ? "" : " (--missing none reads it as a place)"));
  }
}

void drop_equal(std::vector<std::vector<double>>& columns) {
  if (columns.size() != 3) return;
  const std::size_t rows = std::min({columns[0].size(), columns[1].size(), columns[2].size()});
  for (std::size_t i = 0; i < rows; ++i) {
    if (columns[0][i] != columns[1][i] || columns[0][i] != columns[2][i]) continue;
    for (auto& column : columns) column[i] = std::nan("");
  }
}

}  // namespace condyle::host
