// SPDX-License-Identifier: Apache-2.0
// MAT files of any program: times and positions are matrices that names and sizes tell apart.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "hosted/files/input_error.h"
#include "recordings/csv_columns.h"
#include "recordings/mat_recording.h"
#include "recordings/mat_shapes.h"
#include "recordings/point_list.h"

namespace condyle::host {
namespace {

using Quantity = ColumnMeaning::Quantity;

class PlainMat {
 public:
  PlainMat(const std::vector<MatArray>& variables, const std::string& path,
           const RecordingOptions& options, bool takes_any_number)
      : path_(path), options_(options), takes_any_number_(takes_any_number) {
    std::vector<NamedArray> named;
    for (const MatArray& one : variables) named.push_back({one.name(), one});
    collect("", std::move(named), 0);
  }

  MatTable table() {
    MatGroup group = chosen_group();
    take_from_around(group);
    find_time(group);
    MatTable table;
    if (!read_whole_matrix(group, table)) read_named(group, table);
    if (table.columns.empty()) fail_without_positions();
    if (!has_time_ && !options_.rate_Hz) find_rate(group, table.rows);
    table.file = mat_layout(table.columns, table.rows, std::move(header_), path_, options_,
                            takes_any_number_);
    table.file.info.format = "MAT";
    if (!rate_note_.empty()) table.file.info.notes.push_back(rate_note_);
    if (!others_.empty()) {
      table.file.info.notes.push_back("variables that are not read: " + list_of_points(others_));
    }
    return table;
  }

 private:
  void collect(const std::string& prefix, std::vector<NamedArray> arrays, int depth) {
    constexpr int kDeepest = 4;
    constexpr std::size_t kMostGroups = 1000;
    groups_.push_back({prefix, arrays});
    if (depth == kDeepest || groups_.size() >= kMostGroups) return;
    for (const NamedArray& one : arrays) {
      if (!one.array.is_struct() || one.array.count() != 1) continue;
      std::vector<NamedArray> fields;
      for (const std::string& field : one.array.fields()) {
        fields.push_back({field, one.array.field(field)});
      }
      collect(prefix + one.name + ".", std::move(fields), depth + 1);
    }
  }

  bool is_mapped(const std::string& name) const {
    return std::any_of(options_.columns.begin(), options_.columns.end(),
                       [&](const std::string& pair) {
                         return pair.size() > name.size() && pair.ends_with("=" + name);
                       });
  }

  static Quantity quantity_of(const std::string& name) {
    return meaning_of(name, "", "drive_N").quantity;
  }

  bool has_positions(const MatGroup& group) const {
    return std::any_of(group.arrays.begin(), group.arrays.end(), [&](const NamedArray& one) {
      if (is_mapped(group.prefix + one.name)) return true;
      if (options_.reads_drive_alone) return one.name == options_.drive_column;
      const Quantity quantity = quantity_of(one.name);
      if (is_vector(one.array)) {
        return quantity == Quantity::point || quantity == Quantity::one_axis;
      }
      const std::vector<std::size_t> sizes = one.array.sizes();
      return one.array.is_numeric() && longest(one.array) > 3 &&
             (shape_of(one.array, std::nullopt) || std::min(sizes[0], sizes[1]) >= 3);
    });
  }

  MatGroup chosen_group() {
    // --columns may name the arrays with their struct.
    for (const MatGroup& group : groups_) {
      if (group.prefix.empty()) continue;
      bool is_named = false;
      for (const NamedArray& one : group.arrays) {
        for (std::string& pair : options_.columns) {
          if (!pair.ends_with("=" + group.prefix + one.name)) continue;
          pair.replace(pair.find('=') + 1, group.prefix.size(), "");
          is_named = true;
        }
      }
      if (is_named) return group;
    }
    std::vector<const MatGroup*> found;
    for (const MatGroup& group : groups_) {
      if (has_positions(group)) found.push_back(&group);
    }
    if (found.empty()) fail_without_positions();
    if (found.size() > 1) {
      const std::string names = short_list(found, ", ", [](const MatGroup* one) {
        return one->prefix.empty() ? std::string("the variables themselves")
                                   : one->prefix.substr(0, one->prefix.size() - 1);
      });
      throw InputError(path_, "holds positions in several places: " + names,
                       "say which are meant, such as --columns "
                       "time_s=STRUCT.TIME,position_mm=STRUCT.POSITIONS");
    }
    return *found[0];
  }

  [[noreturn]] void fail_without_positions() const {
    std::vector<std::string> held;
    for (const MatGroup& group : groups_) {
      for (const NamedArray& one : group.arrays) {
        if (one.array.is_numeric()) {
          held.push_back(fmt::format("{}{} ({})", group.prefix, one.name,
                                     fmt::join(one.array.sizes(), " x ")));
        }
      }
    }
    throw InputError(path_,
                     held.empty()
                         ? std::string("holds no matrices of numbers; tables and objects "
                                       "of MATLAB are not read")
                         : "holds no positions that are recognised: " + list_of_points(held),
                     "save the times as a vector and the positions as a matrix of N x 3, or say "
                     "which they are with --columns time_s=NAME,position_mm=NAME");
  }

  // Times, units and names may stand beside the struct with the positions.
  void take_from_around(MatGroup& group) const {
    const auto has = [&group](const auto& is_it) {
      return std::any_of(group.arrays.begin(), group.arrays.end(), is_it);
    };
    const auto is_time = [](const NamedArray& one) {
      return is_vector(one.array) && quantity_of(one.name) == Quantity::time;
    };
    for (auto around = groups_.rbegin(); around != groups_.rend(); ++around) {
      if (!around->is_around(group)) continue;
      const bool has_time = has(is_time), has_unit = has(is_unit), has_labels = has(are_labels);
      for (const NamedArray& one : around->arrays) {
        if ((!has_time && is_time(one)) || (!has_unit && is_unit(one)) ||
            (!has_labels && are_labels(one))) {
          group.arrays.push_back(one);
        }
      }
    }
  }

  void find_time(const MatGroup& group) {
    for (const NamedArray& one : group.arrays) {
      const bool is_given =
          std::any_of(options_.columns.begin(), options_.columns.end(), [&](const auto& pair) {
            return pair.ends_with("=" + one.name) &&
                   quantity_of(pair.substr(0, pair.find('='))) == Quantity::time;
          });
      if (!is_vector(one.array) || (!is_given && quantity_of(one.name) != Quantity::time)) continue;
      has_time_ = true;
      if (is_given || !rows_) rows_ = one.array.count();
      if (is_given) break;
    }
    for (const NamedArray& one : group.arrays) {
      if (is_unit(one) && metres_in(one.array.text()) > 0) unit_ = one.array.text();
      if (are_labels(one)) labels_ = one.array.texts();
    }
  }

  // A matrix alone, whose first columns are a time or a frame.
  bool read_whole_matrix(const MatGroup& group, MatTable& table) {
    const NamedArray* whole = nullptr;
    for (const NamedArray& one : group.arrays) {
      if (!one.array.is_numeric() || one.array.count() <= 1) continue;
      if (whole != nullptr) return false;
      whole = &one;
    }
    if (whole == nullptr || has_time_ || shape_of(whole->array, std::nullopt)) return false;
    const std::vector<std::size_t> sizes = whole->array.sizes();
    if (sizes.size() != 2 || std::min(sizes[0], sizes[1]) < 2 || sizes[0] == sizes[1]) return false;
    const bool is_tall = sizes[0] > sizes[1];
    table.rows = std::max(sizes[0], sizes[1]);
    for (std::size_t i = 0; i < std::min(sizes[0], sizes[1]); ++i) {
      header_.names.push_back(std::to_string(i + 1));
      header_.units.push_back(unit_);
      table.columns.push_back(
          {whole->array, i * (is_tall ? sizes[0] : 1), is_tall ? std::size_t{1} : sizes[0]});
    }
    return true;
  }

  void read_named(const MatGroup& group, MatTable& table) {
    header_.has_names = true;
    if (!rows_) find_rows(group);
    for (const NamedArray& one : group.arrays) {
      if (!one.array.is_numeric() || one.array.count() <= 1) continue;
      const std::optional<MatShape> shape = shape_of(one.array, rows_);
      if (is_vector(one.array) && one.array.count() == *rows_) {
        header_.names.push_back(one.name);
        const Quantity quantity = quantity_of(one.name);
        const bool is_place = quantity == Quantity::point || quantity == Quantity::one_axis;
        header_.units.push_back(is_place ? unit_ : "");
        table.columns.push_back({one.array, 0, 1});
      } else if (shape && !is_vector(one.array)) {
        add_points(one, *shape, table);
      } else {
        others_.push_back(one.name);
      }
    }
    table.rows = rows_.value_or(0);
  }

  // Without times, all positions must have the same length.
  void find_rows(const MatGroup& group) {
    std::string first;
    for (const NamedArray& one : group.arrays) {
      const Quantity quantity = quantity_of(one.name);
      const bool is_place = is_vector(one.array)
                                ? quantity == Quantity::point || quantity == Quantity::one_axis ||
                                      quantity == Quantity::drive || is_mapped(one.name)
                                : shape_of(one.array, std::nullopt).has_value();
      if (!is_place || is_ignored(one.name)) continue;
      const std::size_t its_rows = longest(one.array);
      if (rows_ && its_rows != *rows_) {
        throw InputError(path_,
                         fmt::format("{} has {} rows, {} has {}, and no time tells which are "
                                     "the samples",
                                     first, *rows_, one.name, its_rows),
                         fmt::format("leave one out, for example with --ignore-column {}", first));
      }
      rows_ = its_rows;
      first = one.name;
    }
    if (!rows_) fail_without_positions();
  }

  bool is_ignored(const std::string& name) const {
    return std::find(options_.ignored_columns.begin(), options_.ignored_columns.end(), name) !=
           options_.ignored_columns.end();
  }

  void add_points(const NamedArray& one, const MatShape& shape, MatTable& table) {
    const auto ignored =
        std::find(options_.ignored_columns.begin(), options_.ignored_columns.end(), one.name);
    if (ignored != options_.ignored_columns.end()) {
      options_.ignored_columns.erase(ignored);
      others_.push_back(one.name);
      return;
    }
    // The name may end in a unit, as the name of a column may.
    std::string base = one.name, unit = unit_;
    for (const std::string_view ending : {"_mm", "_cm", "_m", "_um"}) {
      if (!one.name.ends_with(ending) || one.name.size() == ending.size()) continue;
      base = one.name.substr(0, one.name.size() - ending.size());
      unit = std::string(ending.substr(1));
    }
    // Of one point, its variable is the name, unless that says no more than "position".
    const bool is_labelled =
        labels_.size() == shape.points && (shape.points > 1 || base == "position");
    for (std::size_t point = 0; point < shape.points; ++point) {
      std::string name = base;
      if (is_labelled) {
        name = labels_[point];
      } else if (shape.points > 1) {
        name = fmt::format("{}_{}", base, point + 1);
      }
      for (std::size_t axis = 0; axis < 3; ++axis) {
        header_.names.push_back(fmt::format("{}:{}", name, "xyz"[axis]));
        header_.units.push_back(unit);
        table.columns.push_back(
            {one.array, point * shape.point_stride + axis * shape.axis_stride, shape.row_stride});
      }
      if (shape.points == 1) map_matrix(one.name, name);
    }
  }

  // "position_mm=jaw" of a matrix names its three columns.
  void map_matrix(const std::string& matrix, const std::string& name) {
    for (std::size_t i = 0; i < options_.columns.size(); ++i) {
      const std::string pair = options_.columns[i];
      const std::size_t equals = pair.find('=');
      if (equals == std::string::npos || pair.substr(equals + 1) != matrix) continue;
      const bool is_mm = pair.substr(0, equals).ends_with("_mm");
      options_.columns[i] = fmt::format("{0}_x_{1}={0}:x", name, is_mm ? "mm" : "m");
      for (const char axis : {'y', 'z'}) {
        options_.columns.push_back(
            fmt::format("{0}_{1}_{2}={0}:{1}", name, axis, is_mm ? "mm" : "m"));
      }
      return;
    }
  }

  void find_rate(const MatGroup& group, std::size_t rows) {
    std::vector<const MatGroup*> order{&group};
    for (auto other = groups_.rbegin(); other != groups_.rend(); ++other) {
      if (other->is_around(group)) order.push_back(&*other);
    }
    if (!take_rate(order, rows, true)) {
      order.clear();
      for (const MatGroup& other : groups_) order.push_back(&other);
      take_rate(order, rows, false);
    }
  }

  // The rate that the first of `groups` states, or the only one that all of them state.
  bool take_rate(const std::vector<const MatGroup*>& groups, std::size_t rows, bool first_decides) {
    std::optional<double> rate_Hz;
    for (const MatGroup* const group : groups) {
      for (const NamedArray& one : group->arrays) {
        if (!is_rate(one)) continue;
        const std::string name = group->prefix + one.name;
        const double its_Hz = one.array.scalar();
        const bool is_usable = its_Hz >= 1e-3 && its_Hz <= 1e6;
        // A rate beside arrays of another length may be theirs.
        const auto other = std::find_if(
            group->arrays.begin(), group->arrays.end(), [rows](const NamedArray& beside) {
              return beside.array.is_numeric() && longest(beside.array) > rows;
            });
        if (!is_usable || (rate_Hz && *rate_Hz != its_Hz) || other != group->arrays.end()) {
          throw InputError(
              path_,
              !is_usable ? fmt::format("{} is {:g}, which is no rate", name, its_Hz)
              : other != group->arrays.end()
                  ? fmt::format("{} can be the rate of {}, which has more rows than the positions",
                                name, other->name)
                  : fmt::format("states rates of {:g} and {:g} Hz", *rate_Hz, its_Hz),
              "give --rate-Hz");
        }
        rate_Hz = its_Hz;
        rate_note_ = fmt::format("{:g} Hz is the value of {}", its_Hz, name);
      }
      if (rate_Hz && first_decides) break;
    }
    options_.rate_Hz = rate_Hz;
    return rate_Hz.has_value();
  }

  std::string path_;
  RecordingOptions options_;
  bool takes_any_number_;
  std::vector<MatGroup> groups_;
  bool has_time_ = false;
  std::optional<std::size_t> rows_;
  std::string unit_, rate_note_;
  std::vector<std::string> labels_, others_;
  CsvHeader header_;
};

}  // namespace

MatTable read_plain_mat(const std::vector<MatArray>& variables, const std::string& path,
                        const RecordingOptions& options, bool takes_any_number) {
  return PlainMat(variables, path, options, takes_any_number).table();
}

}  // namespace condyle::host
