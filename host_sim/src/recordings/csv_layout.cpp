// SPDX-License-Identifier: Apache-2.0
#include "recordings/csv_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "hosted/files/input_error.h"
#include "hosted/files/nearest_word.h"
#include "recordings/csv_columns.h"
#include "recordings/csv_notes.h"
#include "recordings/csv_problems.h"
#include "recordings/csv_units.h"
#include "recordings/csv_unnamed.h"
#include "recordings/file_units.h"
#include "recordings/point_list.h"

namespace condyle::host {
namespace {

using Quantity = ColumnMeaning::Quantity;

constexpr std::size_t kLongestName = 100;

class CsvReading {
 public:
  CsvReading(CsvHeader header, std::vector<std::vector<double>> values, const std::string& path,
             const RecordingOptions& options, bool takes_any_number)
      : path_(path),
        options_(options),
        takes_any_number_(takes_any_number),
        header_(std::move(header)),
        values_(std::move(values)),
        problems_(place()) {}

  TableFile layout() {
    refuse_without_names();
    mapped_ = mapped_columns(options_.columns, header_.names);
    for (std::size_t i = 0; i < header_.names.size(); ++i) add_column(i);
    check_ignored();
    check_repeated();
    check_time();
    check_position();
    problems_.throw_if_any();
    if (header_.has_names || !mapped_.empty()) {
      decide_time();
    } else {
      meanings_ = unnamed_columns(header_, values_, place(), options_);
    }
    decide_length();
    number_points();
    note_what_was_recognised();
    layout_.table.style = header_.style;
    layout_.table.header_lines = header_.lines;
    layout_.table.has_comments = true;
    layout_.table.blank_lines_between = header_.blank_lines_between;
    layout_.info.format = "CSV";
    return std::move(layout_);
  }

 private:
  std::string place() const {
    return header_.line > 0 ? fmt::format("{}:{}", path_, header_.line) : path_;
  }
  std::string place(std::size_t column) const {
    return fmt::format("{}: column {}", place(), quote(header_.names[column]));
  }
  static bool is_place(const ColumnMeaning& meaning) {
    return meaning.quantity == Quantity::point || meaning.quantity == Quantity::one_axis;
  }
  bool has(Quantity quantity) const {
    return std::any_of(meanings_.begin(), meanings_.end(),
                       [quantity](const ColumnMeaning& one) { return one.quantity == quantity; });
  }

  void refuse_without_names() {
    if (!header_.problem.empty()) {
      throw InputError(place(), header_.problem,
                       fmt::format("put the names of the columns, such as time_s,position_m, in "
                                   "the line above the numbers, and # before other lines; {}",
                                   kColumns));
    }
    if (header_.has_split_decimals) {
      throw InputError(place(), "commas separate the columns, and decimals too",
                       "export it with decimal points, or with semicolons between the columns");
    }
    for (const std::string& name : header_.names) {
      if (name.size() <= kLongestName) continue;
      throw InputError(place(), fmt::format("the column name {} is too long", quote(name)),
                       "check that the first line names the columns");
    }
    if (header_.has_names || !options_.columns.empty()) return;
    const std::size_t columns = header_.names.size();
    const bool has_shape = columns >= 3 && (columns % 3 != 0 || options_.rate_Hz);
    if (options_.reads_drive_alone || !has_shape) {
      throw InputError(
          place(), no_names(header_),
          fmt::format("{}give --columns time_s=1, or "
                      "--rate-Hz if the columns are x, y, z of points; {}",
                      header_.is_text ? "add a first line such as time_s,position_m, " : "",
                      kColumns));
    }
  }

  void add_column(std::size_t i) {
    const std::string& name = header_.names[i];
    const std::optional<std::string> given = mapped_.name_of(i);
    ColumnMeaning meaning = given ? meaning_of(*given, "", options_.drive_column)
                                  : meaning_of(name, header_.units[i], options_.drive_column);
    if (!header_.has_names && !given) meaning = {};
    if (name.empty() && is_counter_or_empty(values_[i])) meaning.quantity = Quantity::not_read;
    const bool is_ignored =
        std::any_of(options_.ignored_columns.begin(), options_.ignored_columns.end(),
                    [&](const std::string& other) {
                      return ignores_column(other, name) ||
                             (meaning.quantity == Quantity::point && other.ends_with("_*") &&
                              other.compare(0, other.size() - 2, meaning.point) == 0);
                    });
    const bool is_replaced = !given && mapped_.replaces(meaning.quantity);
    if (is_ignored || is_replaced) {
      meaning = {};
      meaning.quantity = Quantity::not_read;
    } else if (name.starts_with(kEstimatePrefix)) {
      unread_.push_back(name);
    } else if (!header_.is_text && meaning.has_bad_unit && meaning.quantity != Quantity::time) {
      meaning = {};
      unread_.push_back(name);
    } else if (meaning.quantity == Quantity::unknown && header_.has_names) {
      if (mapped_.empty() && header_.is_text) {
        problems_.add_unknown(name, options_);
      } else {
        unread_.push_back(name);
      }
    } else if (meaning.has_bad_unit) {
      problems_.add(
          name, fmt::format("the unit {} is not known here", quote(meaning.unit)),
          fmt::format("say what it is with --columns, such as --columns 'time_ms={}'", name));
    }
    if (options_.reads_drive_alone &&
        (meaning.quantity == Quantity::point || meaning.quantity == Quantity::one_axis)) {
      meaning.quantity = Quantity::not_read;
    }
    if (!meaning.other_unit.empty() && !(is_place(meaning) && options_.units_per_metre)) {
      problems_.add(name,
                    fmt::format("its name states another unit than the line below, {}",
                                quote(meaning.other_unit)),
                    "correct the one that is wrong");
    }
    meanings_.push_back(std::move(meaning));
  }

  void check_ignored() {
    for (const std::string& name : options_.ignored_columns) {
      if (options_.may_lack_ignored) return;
      bool is_known = false;
      for (std::size_t i = 0; i < header_.names.size(); ++i) {
        const ColumnMeaning own =
            meaning_of(header_.names[i], header_.units[i], options_.drive_column);
        is_known = is_known || ignores_column(name, header_.names[i]) ||
                   (own.quantity == Quantity::point && name == own.point + "_*");
      }
      if (is_known) continue;
      const std::string nearest = nearest_word(name, header_.names);
      problems_.add_whole(fmt::format("no column {} to ignore", quote(name)),
                          nearest.empty() ? "check the name given to --ignore-column"
                                          : fmt::format("did you mean {}?", quote(nearest)));
    }
  }

  void check_repeated() {
    std::set<std::tuple<Quantity, std::string, std::size_t>> known;
    for (std::size_t i = 0; i < meanings_.size(); ++i) {
      const ColumnMeaning& one = meanings_[i];
      if (one.quantity == Quantity::unknown || one.quantity == Quantity::not_read) continue;
      if (known.emplace(one.quantity, one.point, one.axis).second) continue;
      problems_.add_repeated(header_.names[i], header_.names, options_);
    }
  }

  void check_time() {
    if (!header_.has_names && mapped_.empty()) return;
    if (has(Quantity::time) || options_.rate_Hz) return;
    if (has(Quantity::frame)) {
      problems_.add_whole("has frame numbers and no time", "give --rate-Hz");
    } else {
      problems_.add_whole("no column time_s",
                          "name the column with the time in seconds, say which it is with "
                          "--columns time_s=NAME, or "
                          "give --rate-Hz");
    }
  }

  void check_position() {
    if (!header_.has_names && mapped_.empty()) return;
    if (options_.reads_drive_alone) {
      if (!has(Quantity::drive)) {
        problems_.add_whole(fmt::format("no column {}", options_.drive_column),
                            "give the column with the measured drive that name");
      }
      return;
    }
    const bool has_axis = has(Quantity::one_axis), has_points = has(Quantity::point);
    if (has_axis != has_points) return;
    problems_.add_whole(has_axis ? "the position columns are not a complete set: position is one "
                                   "axis, the others are points"
                                 : "no position column",
                        "give position_m, or x, y, z of one point or of three");
  }

  void decide_time() {
    for (std::size_t i = 0; i < meanings_.size(); ++i) {
      ColumnMeaning& time = meanings_[i];
      if (time.quantity != Quantity::time) continue;
      const std::string& name = header_.names[i];
      if (time.each > 0 && !options_.rate_Hz) {
        const TimesDoubt doubt = doubt_of_times(values_[i], time.each);
        const bool is_chosen = mapped_.name_of(i).has_value() || options_.reads_drive_alone;
        if (doubt.problem.empty() || (is_chosen && !doubt.is_absurd)) return;
        refuse_stated_time(place(i), name, doubt, time.each == 1 ? "s" : time.unit);
      }
      const UnitGuess guess = guess_time_unit(values_[i]);
      if (options_.rate_Hz) {
        if (time.each > 0 || !guess.is_count) {
          throw InputError(place(i), "the file has times, and --rate-Hz is given",
                           "leave out --rate-Hz, or the column with --ignore-column");
        }
        time.quantity = has(Quantity::frame) ? Quantity::not_read : Quantity::frame;
        return;
      }
      if (guess.each == 0) refuse_time(place(i), name, values_[i], guess.reason);
      time.each = guess.each;
      time.unit = guess.unit;
      warnings_.push_back(fmt::format("the unit of {} is not stated; read as {}: {}", name,
                                      guess.unit, guess.reason));
      return;
    }
  }

  void decide_length() {
    std::map<std::string, std::vector<std::vector<double>>> places, stated_places_m;
    double each = 0;
    std::size_t first = 0;
    for (std::size_t i = meanings_.size(); i-- > 0;) {
      if (!is_place(meanings_[i])) continue;
      if (meanings_[i].each > 0) {
        each = meanings_[i].each;
        for (double& value : values_[i]) value *= each;
        stated_places_m[meanings_[i].point].push_back(values_[i]);
        layout_.info.stated.unit = meanings_[i].unit;
      } else {
        places[meanings_[i].point].push_back(values_[i]);
        first = i;
      }
    }
    std::vector<std::vector<double>> stated_m;
    for (auto& [point, columns] : places) drop_equal(columns);
    for (auto& [point, columns_m] : stated_places_m) {
      drop_equal(columns_m);
      for (auto& column_m : columns_m) stated_m.push_back(std::move(column_m));
    }
    if (options_.units_per_metre) {
      each = 1 / *options_.units_per_metre;
      use_given_unit(options_.units_per_metre, layout_.info);
      for (ColumnMeaning& meaning : meanings_) {
        if (!is_place(meaning)) continue;
        meaning.each = each;
        meaning.unit = layout_.info.stated.unit;
      }
      return;
    }
    if (places.empty()) {
      // In mm no other unit fits a long way better (unit_watch.h).
      const std::string problem =
          each == 1 ? problem_of_places(stated_m) : problem_of_distance(stated_m);
      if (!problem.empty()) {
        throw InputError(place(), problem, "give --unit mm or --unit m, the unit that is right");
      }
      return;
    }
    if (each == 0) {
      const UnitGuess guess = guess_length_unit(places);
      if (guess.each == 0) {
        throw InputError(
            place(first),
            fmt::format("the unit of the positions is not stated, and {}", guess.reason),
            "give --unit mm or --unit m");
      }
      each = guess.each;
      layout_.info.stated.unit = guess.unit;
      warnings_.push_back(fmt::format(
          "the unit of the positions is not stated; read as {}: {} (--unit mm or --unit m decides)",
          guess.unit, guess.reason));
    }
    for (ColumnMeaning& meaning : meanings_) {
      if (is_place(meaning) && meaning.each == 0) meaning.each = each;
    }
  }

  void number_points() {
    CsvPoints points;
    std::vector<ColumnMeaning*> places;
    for (ColumnMeaning& meaning : meanings_) {
      if (meaning.quantity == Quantity::point) places.push_back(&meaning);
    }
    // One coordinate of one point is one axis.
    if (places.size() == 1) {
      single_ = fmt::format("{} of {} is the one axis", "xyz"[places[0]->axis], places[0] -> point);
      places[0]->quantity = Quantity::one_axis;
      places.clear();
    }
    for (const ColumnMeaning* meaning : places) {
      points.add({meaning->point, meaning->axis, {}});
    }
    if (!places.empty()) {
      layout_.info.kind = points.kind(place(), takes_any_number_);
      layout_.table.names = points.names();
      if (layout_.table.names.size() <= 3 && !takes_any_number_) {
        if (std::string note = points.note(); !note.empty()) layout_.info.notes.push_back(note);
      }
    }
    for (std::size_t i = 0; i < meanings_.size(); ++i) {
      layout_.table.columns.push_back(
          table_column(meanings_[i], header_.names[i], points, options_.rate_Hz.has_value()));
    }
    layout_.info.has_drive = has(Quantity::drive);
    layout_.table.rate_Hz = options_.rate_Hz;
  }

  void note_what_was_recognised() {
    std::vector<std::string>& notes = layout_.info.notes;
    const std::string recognised =
        recognised_text(header_, meanings_, options_, !mapped_.empty() || !warnings_.empty());
    if (!recognised.empty()) notes.push_back(recognised);
    if (!header_.titles.empty()) notes.push_back(titles_text(header_));
    if (!single_.empty()) notes.push_back(single_);
    if (!unread_.empty()) {
      notes.push_back(fmt::format("columns that are not read: {}", list_of_points(unread_)));
    }
    notes.insert(notes.end(), warnings_.begin(), warnings_.end());
  }

  std::string path_;
  const RecordingOptions& options_;
  bool takes_any_number_;
  CsvHeader header_;
  std::vector<std::vector<double>> values_;  // of the first rows, a series a column
  MappedColumns mapped_;
  HeaderProblems problems_;
  std::vector<ColumnMeaning> meanings_;
  std::vector<std::string> unread_, warnings_;
  std::string single_;
  TableFile layout_;
};

}  // namespace

TableFile csv_layout(const TableStart& start, const std::string& path,
                     const RecordingOptions& options, bool takes_any_number) {
  CsvHeader header = read_csv_header(start);
  std::vector<std::vector<double>> values = first_values(start, header);
  return CsvReading(std::move(header), std::move(values), path, options, takes_any_number).layout();
}

TableFile column_layout(CsvHeader header, std::vector<std::vector<double>> values,
                        const std::string& path, const RecordingOptions& options,
                        bool takes_any_number) {
  header.is_text = false;
  header.line = header.lines = 0;
  return CsvReading(std::move(header), std::move(values), path, options, takes_any_number).layout();
}

}  // namespace condyle::host
