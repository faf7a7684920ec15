// SPDX-License-Identifier: Apache-2.0
#include "recordings/csv_unnamed.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosted/files/input_error.h"
#include "recordings/csv_problems.h"
#include "recordings/csv_units.h"

namespace condyle::host {
namespace {

using Quantity = ColumnMeaning::Quantity;

// Of a time or a count, few steps run backwards.
bool increases(const std::vector<double>& values) {
  std::size_t backward = 0;
  for (std::size_t i = 1; i < values.size(); ++i) backward += values[i] < values[i - 1] ? 1U : 0U;
  return 10 * backward <= values.size();
}

// A time or a count increases by even steps, to one step of rounding. No place does for long.
bool counts_evenly(const std::vector<double>& values) {
  constexpr std::size_t kLeast = 50;
  if (values.size() < kLeast || !std::isfinite(values.front()) || !std::isfinite(values.back())) {
    return false;
  }
  const double step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
  if (!(step > 0)) return false;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double even = values.front() + step * static_cast<double>(i);
    if (std::isfinite(values[i]) && std::abs(values[i] - even) > step) return false;
  }
  return true;
}

class UnnamedColumns {
 public:
  UnnamedColumns(const CsvHeader& header, const std::vector<std::vector<double>>& values,
                 const std::string& place, const RecordingOptions& options)
      : header_(header), values_(values), place_(place), options_(options) {
    meanings_.resize(header.names.size());
  }

  std::vector<ColumnMeaning> meanings() {
    const std::size_t first = meanings_.size() % 3;
    for (std::size_t i = 0; i < first; ++i) decide_leading(i);
    if (!has_time_ && !options_.rate_Hz) {
      throw InputError(
          place_, no_names(header_) + ", and none is a time",
          fmt::format("give --rate-Hz with the frames per second{}; {}",
                      header_.is_text ? ", or add a first line such as time_s,position_m" : "",
                      kColumns));
    }
    for (std::size_t i = first; i < meanings_.size(); ++i) {
      if (counts_evenly(values_[i])) {
        refuse(i, "increases by even steps, as a time or a frame number does and no place");
      }
      meanings_[i].quantity = Quantity::point;
      meanings_[i].point = fmt::format("p{}", (i - first) / 3 + 1);
      meanings_[i].axis = (i - first) % 3;
    }
    return std::move(meanings_);
  }

 private:
  // Time or frame; a second column of either is not read.
  void decide_leading(std::size_t i) {
    const UnitGuess guess = guess_time_unit(values_[i]);
    ColumnMeaning& meaning = meanings_[i];
    meaning.quantity = Quantity::not_read;
    if (!increases(values_[i])) refuse(i, "is neither a time nor a frame number");
    if (guess.is_count && !has_frame_) {
      meaning.quantity = Quantity::frame;
      has_frame_ = true;
    } else if (guess.each > 0 && !has_time_ && !options_.rate_Hz) {
      meaning.quantity = Quantity::time;
      meaning.each = guess.each;
      meaning.unit = guess.unit;
      has_time_ = true;
    }
  }

  [[noreturn]] void refuse(std::size_t column, const std::string& problem) const {
    throw InputError(
        place_,
        fmt::format("{}, and column {} {}", no_names(header_), header_.names[column], problem),
        "say what they are, such as --columns time_s=1,x_mm=2,y_mm=3,z_mm=4, or with --rate-Hz "
        "--columns x_mm=1,y_mm=2,z_mm=3; others are not read");
  }

  const CsvHeader& header_;
  const std::vector<std::vector<double>>& values_;
  const std::string& place_;
  const RecordingOptions& options_;
  std::vector<ColumnMeaning> meanings_;
  bool has_time_ = false, has_frame_ = false;
};

}  // namespace

std::string no_names(const CsvHeader& header) {
  return header.is_text ? "the first line does not name the columns"
                        : "the columns of the matrix have no names";
}

std::vector<ColumnMeaning> unnamed_columns(const CsvHeader& header,
                                           const std::vector<std::vector<double>>& values,
                                           const std::string& place,
                                           const RecordingOptions& options) {
  return UnnamedColumns(header, values, place, options).meanings();
}

}  // namespace condyle::host
