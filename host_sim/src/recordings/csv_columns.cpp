// SPDX-License-Identifier: Apache-2.0
#include "recordings/csv_columns.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "hosted/files/number_text.h"
#include "recordings/file_units.h"

namespace condyle::host {
namespace {

using Quantity = ColumnMeaning::Quantity;

struct Unit {
  std::string_view name;
  double each;  // in seconds
};

// Names in lower case; "\xb5" is the micro sign of Latin-1, "\xc2\xb5" and "\xce\xbc" of UTF-8.
constexpr Unit kTimes[] = {{"s", 1},
                           {"sec", 1},
                           {"secs", 1},
                           {"second", 1},
                           {"seconds", 1},
                           {"ms", 1e-3},
                           {"msec", 1e-3},
                           {"millisecond", 1e-3},
                           {"us", 1e-6},
                           {"milliseconds", 1e-3},
                           {"\xb5s", 1e-6},
                           {"\xc2\xb5s", 1e-6},
                           {"\xce\xbcs", 1e-6},
                           {"microseconds", 1e-6},
                           {"ns", 1e-9},
                           {"nanoseconds", 1e-9}};
// Units of what is neither a time nor a place.
constexpr std::string_view kOtherUnits[] = {"deg", "rad",  "v",   "mv", "uv",
                                            "hz",  "mm/s", "m/s", "px", "%"};

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return result;
}

std::string_view without_brackets(std::string_view text) {
  text = trim(text);
  if (text.size() > 2 && (text.front() == '(' || text.front() == '[' || text.front() == '{')) {
    text = trim(text.substr(1, text.size() - 2));
  }
  return text;
}

// Seconds in one of `unit`; 0: not a time.
double seconds_in(std::string_view unit) {
  const std::string name = lower(without_brackets(unit));
  const auto found = std::find_if(std::begin(kTimes), std::end(kTimes),
                                  [&](const Unit& known) { return known.name == name; });
  return found == std::end(kTimes) ? 0 : found->each;
}

bool is_unit(std::string_view text) {
  const std::string name = lower(without_brackets(text));
  return seconds_in(text) > 0 || metres_in(text) > 0 ||
         newtons_in(without_brackets(text)).has_value() ||
         std::find(std::begin(kOtherUnits), std::end(kOtherUnits), name) != std::end(kOtherUnits);
}

template <std::size_t count>
bool is_one_of(const std::string& word, const std::array<std::string_view, count>& words) {
  return std::find(words.begin(), words.end(), word) != words.end();
}

bool is_joint(char c) {
  return c == '_' || c == ' ' || c == '.' || c == ':' || c == '-' || c == '/';
}

std::string_view without_joints(std::string_view text) {
  text = trim(text);
  while (!text.empty() && is_joint(text.back())) text.remove_suffix(1);
  while (!text.empty() && is_joint(text.front())) text.remove_prefix(1);
  return text;
}

// Takes a unit off the end of `name`: "Time (s)", "x [mm]", "t_ms", "x, mm", "x/mm", "x in mm".
std::string_view take_unit(std::string_view& name) {
  name = trim(name);
  if (name.empty()) return {};
  const char last = name.back();
  if (last == ')' || last == ']' || last == '}') {
    const std::size_t open = name.rfind(last == ')' ? '(' : last == ']' ? '[' : '{');
    if (open == std::string_view::npos || open == 0) return {};
    const std::string_view unit = trim(name.substr(open + 1, name.size() - open - 2));
    name = without_joints(name.substr(0, open));
    return unit;
  }
  const std::size_t joint = name.find_last_of("_ ,/");
  if (joint == std::string_view::npos || joint == 0) return {};
  const std::string_view unit = trim(name.substr(joint + 1));
  // Capitals of one letter are part of a name, except newtons, and the seconds of TIME_S.
  const bool is_capital = unit.size() == 1 && unit[0] >= 'A' && unit[0] <= 'Z' && unit[0] != 'N';
  const bool is_of_time = unit == "S" && lower(name.substr(0, joint)) == "time";
  if ((is_capital && !is_of_time) || !is_unit(unit)) return {};
  name = trim(name.substr(0, joint));
  if (name.size() > 3 && name.ends_with(" in")) name = trim(name.substr(0, name.size() - 3));
  while (name.ends_with(',') || name.ends_with('_')) name.remove_suffix(1);
  return unit;
}

bool is_point_name(std::string_view name) {
  if (name.empty()) return false;
  const auto first = static_cast<unsigned char>(name[0]);
  return std::isalpha(first) != 0 || first >= 0x80 || name[0] == '*';
}

// Names that say what else than a place it is: "vel", "jaw_velocity".
bool is_other_quantity(std::string_view point) {
  constexpr std::array<std::string_view, 22> kOthers{
      "vel",   "velocity", "speed",       "acc",   "accel",  "acceleration", "force", "rot",
      "angle", "rotation", "orientation", "ori",   "quat",   "quaternion",   "gyro",  "moment",
      "mag",   "torque",   "omega",       "euler", "normal", "ang"};
  // Words that are no part of the name of a point, such as the angle of the jaw.
  constexpr std::array<std::string_view, 20> kNever{
      "vel",   "velocity", "velocities", "acc",   "accel",       "acceleration", "quaternion",
      "quat",  "gyro",     "torque",     "force", "orientation", "rotation",     "rot",
      "omega", "angles",   "euler",      "sd",    "std",         "residual"};
  const std::string name = lower(point);
  if (is_one_of(name, kOthers)) return true;
  for (std::size_t first = 0; first < name.size();) {
    const std::size_t end = std::min(name.find_first_of("_ .:-", first), name.size());
    if (is_one_of(name.substr(first, end - first), kNever)) return true;
    first = end + 1;
  }
  return false;
}

// x, y or z of a point: "x", "jaw_x", "Marker1:X", "x_jaw", "jawX", "X12".
bool find_coordinate(std::string_view name, ColumnMeaning& meaning) {
  const std::size_t size = name.size();
  const auto take = [&](char letter, std::string_view point) {
    point = without_joints(point);
    const auto axis = axis_of({&letter, 1});
    if (!axis || !is_point_name(point)) return false;
    meaning.quantity = Quantity::point;
    meaning.axis = *axis;
    meaning.point = std::string(point);
    return true;
  };
  if (size == 0) return false;
  if (size == 1) return take(name[0], "p1");
  const std::string_view rest = name.substr(1);
  if (rest.find_first_not_of("0123456789") == std::string_view::npos && rest.size() < 4) {
    return take(name[0], "p" + std::string(rest));
  }
  const char last = name.back(), before = name[size - 2];
  if (is_joint(before) && take(last, name.substr(0, size - 1))) return true;
  const bool is_after_small = (before >= 'a' && before <= 'z') || (before >= '0' && before <= '9');
  if (last <= 'Z' && is_after_small && take(last, name.substr(0, size - 1))) return true;
  return is_joint(name[1]) && take(name[0], name.substr(2));
}

void find_quantity(std::string_view name, ColumnMeaning& meaning) {
  constexpr std::array<std::string_view, 12> kTimeWords{
      "time", "t",     "timestamp", "time stamp", "time_stamp",   "elapsed",
      "zeit", "temps", "tiempo",    "tempo",      "elapsed time", "seconds"};
  constexpr std::array<std::string_view, 10> kFrames{
      "frame",        "frame#",      "frames",       "frame no", "frame_no",
      "frame number", "framenumber", "frame_number", "field",    "frame #"};
  constexpr std::array<std::string_view, 3> kSubFrames{"sub frame", "subframe", "sub_frame"};
  constexpr std::array<std::string_view, 3> kAxes{"position", "pos", "displacement"};
  const std::string word = lower(without_joints(name));
  if (is_one_of(word, kTimeWords)) {
    meaning.quantity = Quantity::time;
    if (word == "seconds" && meaning.unit.empty()) meaning.unit = "s";
  } else if (is_one_of(word, kFrames)) {
    meaning.quantity = Quantity::frame;
  } else if (is_one_of(word, kSubFrames)) {
    meaning.quantity = Quantity::not_read;
  } else if (is_one_of(word, kAxes)) {
    meaning.quantity = Quantity::one_axis;
  } else {
    find_coordinate(without_joints(name), meaning);
  }
}

}  // namespace

std::optional<std::size_t> axis_of(std::string_view text) {
  text = trim(text);
  if (text.size() != 1) return std::nullopt;
  const std::size_t small = std::string_view("xyz").find(text[0]);
  const std::size_t axis =
      small == std::string_view::npos ? std::string_view("XYZ").find(text[0]) : small;
  if (axis == std::string_view::npos) return std::nullopt;
  return axis;
}

double metres_in(std::string_view unit) {
  const std::optional<LengthUnit> known = length_unit(without_brackets(unit));
  return known ? 1 / known->per_metre : 0;
}

bool is_unit_or_empty(std::string_view text) {
  return trim(text).empty() || is_unit(text);
}

ColumnMeaning meaning_of(std::string_view name, std::string_view unit_below,
                         std::string_view drive_column) {
  ColumnMeaning meaning;
  if (name.starts_with(kEstimatePrefix)) {
    meaning.quantity = Quantity::not_read;
    return meaning;
  }
  if (name == drive_column) {
    meaning.quantity = Quantity::drive;
    meaning.each = 1;
    const std::optional<double> below_N = newtons_in(without_brackets(unit_below));
    if (below_N && *below_N != 1) meaning.other_unit = std::string(without_brackets(unit_below));
    return meaning;
  }
  std::string_view base = name;
  const std::string_view unit = take_unit(base);
  meaning.unit = std::string(unit.empty() ? without_brackets(unit_below) : unit);
  find_quantity(base, meaning);
  if (meaning.unit.empty()) {
    // Without a unit, these are no places.
    if (meaning.quantity == Quantity::point && is_other_quantity(meaning.point)) return {};
    return meaning;
  }
  const bool is_time = meaning.quantity == Quantity::time;
  const bool is_length =
      meaning.quantity == Quantity::point || meaning.quantity == Quantity::one_axis;
  if (is_time || is_length) {
    meaning.each = is_time ? seconds_in(meaning.unit) : metres_in(meaning.unit);
    meaning.has_bad_unit = meaning.each == 0;
    const double below = is_time ? seconds_in(unit_below) : metres_in(unit_below);
    if (meaning.each > 0 && below > 0 && below != meaning.each) {
      meaning.other_unit = std::string(without_brackets(unit_below));
    }
  }
  return meaning;
}

}  // namespace condyle::host
