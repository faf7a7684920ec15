// SPDX-License-Identifier: Apache-2.0
#include "recordings/csv_problems.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosted/files/input_error.h"
#include "hosted/files/nearest_word.h"
#include "hosted/files/number_text.h"
#include "recordings/point_list.h"

namespace condyle::host {
namespace {

using Quantity = ColumnMeaning::Quantity;

bool is_place(Quantity quantity) {
  return quantity == Quantity::point || quantity == Quantity::one_axis;
}

bool is_instant(Quantity quantity) {
  return quantity == Quantity::time || quantity == Quantity::frame;
}

}  // namespace

void HeaderProblems::add(const std::string& column, const std::string& problem,
                         const std::string& mend) {
  problems_.push_back({column, problem, mend});
}

void HeaderProblems::add_whole(const std::string& problem, const std::string& mend) {
  problems_.push_back({"", problem, mend});
}

void HeaderProblems::add_unknown(const std::string& column, const RecordingOptions& options) {
  if (options.reads_drive_alone) {
    add(column, "the column is not known",
        fmt::format("take it out of the file; {} is read", options.drive_column));
    return;
  }
  static const std::vector<std::string> kKnown = {
      "time_s",  "time_ms", "time",    "position_mm", "position_m", "x_mm",    "y_mm",
      "z_mm",    "p1_x_mm", "p1_y_mm", "p1_z_mm",     "p2_x_mm",    "p2_y_mm", "p2_z_mm",
      "p3_x_mm", "p3_y_mm", "p3_z_mm", "drive_N",     "frame"};
  const std::string nearest = nearest_word(column, kKnown);
  const std::string meant = nearest.empty() ? "" : fmt::format(" (did you mean {}?)", nearest);
  add(column, "the column is not known" + meant,
      fmt::format("rename it, after converting its unit, say what it is with --columns '{}={}', or "
                  "leave it out with --ignore-column '{}'; {}",
                  nearest.empty() ? "position_mm" : nearest, column, column, kColumns));
}

void HeaderProblems::add_repeated(const std::string& column,
                                  const std::vector<std::string>& columns,
                                  const RecordingOptions& options) {
  std::string mend = "take one of them out of the file";
  if (std::count(columns.begin(), columns.end(), column) > 1) {
    mend = "give the columns different names";  // --ignore-column would leave out both
  } else if (!options.reads_drive_alone) {
    mend = fmt::format("leave one of them out, for example with --ignore-column {}", quote(column));
  }
  add(column, "another column contains the same quantity", mend);
}

void HeaderProblems::throw_if_any() const {
  if (problems_.empty()) return;
  const auto where = [this](const Problem& problem) {
    return problem.column.empty() ? place_
                                  : fmt::format("{}: column {}", place_, quote(problem.column));
  };
  if (problems_.size() == 1) {
    throw InputError(where(problems_[0]), problems_[0].text, problems_[0].mend);
  }
  std::vector<std::string> texts;
  for (const Problem& problem : problems_) {
    texts.push_back(problem.column.empty()
                        ? problem.text
                        : fmt::format("column {}: {}", quote(problem.column), problem.text));
  }
  std::vector<std::string> unread;
  const auto same = [&](const Problem& problem) {
    return problem.text.starts_with("the column is not known");
  };
  for (const Problem& problem : problems_) {
    if (same(problem)) unread.push_back(fmt::format("--ignore-column '{}'", problem.column));
  }
  std::string mend = problems_.back().mend;
  if (!unread.empty()) {
    mend = fmt::format(
        "say what the columns are with --columns NEW=OLD, such as --columns 'time_s={}', or leave "
        "them out: {}; {}",
        problems_[0].column.empty() ? "T" : problems_[0].column,
        short_list(unread, " ", [](const std::string& word) { return word; }), kColumns);
    if (!same(problems_.back())) mend = problems_.back().mend + "; " + mend;
  }
  throw InputError(
      place_,
      fmt::format("{} problems: {}", texts.size(),
                  short_list(texts, "; ", [](const std::string& text) { return text; })),
      mend);
}

void refuse_time(const std::string& place, const std::string& name,
                 const std::vector<double>& values, const std::string& reason) {
  if (std::none_of(values.begin(), values.end(),
                   [](double value) { return std::isfinite(value); })) {
    throw InputError(place, "its values are not numbers",
                     fmt::format("write the times in seconds, or leave it out with "
                                 "--ignore-column {} and give --rate-Hz",
                                 quote(name)));
  }
  throw InputError(
      place, fmt::format("its unit is not stated, and {}", reason),
      fmt::format("give --columns 'time_s={}' or --columns 'time_ms={}', or --rate-Hz if it counts "
                  "frames",
                  name, name));
}

void refuse_stated_time(const std::string& place, const std::string& name, const TimesDoubt& doubt,
                        const std::string& stated_unit) {
  const std::string other =
      fmt::format("leave it out with --ignore-column '{}', and give --rate-Hz", name);
  throw InputError(
      place, doubt.problem,
      doubt.unit.empty()
          ? other
          : fmt::format("give --columns 'time_{}={}' or --columns 'time_{}={}', the unit that is "
                        "right; if it counts frames, {}",
                        doubt.unit, name, stated_unit, name, other));
}

std::optional<std::string> MappedColumns::name_of(std::size_t index) const {
  for (const Column& column : columns_) {
    if (column.index == index) return column.name;
  }
  return std::nullopt;
}

bool MappedColumns::replaces(Quantity quantity) const {
  return std::any_of(columns_.begin(), columns_.end(), [quantity](const Column& column) {
    return column.quantity == quantity || (is_place(column.quantity) && is_place(quantity)) ||
           (is_instant(column.quantity) && is_instant(quantity));
  });
}

MappedColumns mapped_columns(const std::vector<std::string>& given,
                             const std::vector<std::string>& names) {
  MappedColumns mapped;
  for (const std::string& pair : given) {
    const std::size_t equals = pair.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == pair.size()) {
      throw InputError("--columns", fmt::format("{} is not NEW=OLD", quote(pair)),
                       "give for example --columns time_s=T,position_mm=jaw");
    }
    const std::string name = pair.substr(0, equals), old = pair.substr(equals + 1);
    const ColumnMeaning meaning = meaning_of(name, "", "drive_N");
    if (meaning.quantity == Quantity::unknown || meaning.has_bad_unit) {
      throw InputError("--columns", fmt::format("{} is not a name of a column", quote(name)),
                       std::string(kColumns));
    }
    const auto found = std::find(names.begin(), names.end(), old);
    if (found == names.end()) {
      const std::string nearest = nearest_word(old, names);
      throw InputError("--columns", fmt::format("the file has no column {}", quote(old)),
                       nearest.empty() ? "its columns are " + list_of_points(names)
                                       : fmt::format("did you mean {}?", quote(nearest)));
    }
    const auto index = static_cast<std::size_t>(found - names.begin());
    if (mapped.name_of(index)) {
      throw InputError("--columns", fmt::format("names the column {} twice", quote(old)),
                       "give each column once");
    }
    mapped.columns_.push_back({index, name, meaning.quantity});
  }
  return mapped;
}

}  // namespace condyle::host
