// SPDX-License-Identifier: Apache-2.0
#include "hosted/lsl/stream_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <numeric>

#include "condyle/hal/report/raw_report.h"
#include "hosted/files/input_error.h"
#include "hosted/lsl/channel_names.h"

namespace condyle::host::lsl {
namespace {

constexpr const char* kHowToChoose =
    "name 1, 3, 7 or 9 of them with --channels (in a configuration: channels)";
constexpr std::size_t kMostNamed = 12;

// Kind of the position, and its channels in the order of the profile's coordinates.
struct Coordinates {
  const char* kind = "";
  std::vector<const char*> names;
  std::vector<std::size_t> channels;
};

std::string labels_of(const StreamInfo& info) {
  if (info.channels.empty()) {
    return fmt::format("{} channels without labels", info.channel_count);
  }
  std::string text = "the channels";
  for (std::size_t i = 0; i < std::min(info.channels.size(), kMostNamed); ++i) {
    text += (i == 0 ? " " : ", ") + info.channels[i].label;
  }
  if (info.channels.size() > kMostNamed) text += ", ...";
  return text;
}

std::size_t channel_named(const std::string& word, const StreamInfo& info,
                          const std::string& where) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < info.channels.size(); ++i) {
    if (info.channels[i].label == word) found.push_back(i);
  }
  if (found.size() == 1) return found.front();
  if (found.size() > 1) {
    throw InputError(where, fmt::format("{} channels are called {}", found.size(), word),
                     "give their numbers, which begin at 1");
  }
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error == std::errc() && end == word.data() + word.size() && number >= 1 &&
      number <= info.channel_count) {
    return number - 1;
  }
  throw InputError(where, fmt::format("has no channel {}, but {}", word, labels_of(info)),
                   "give labels, or numbers from 1");
}

Coordinates coordinates_of(std::vector<std::size_t> channels) {
  switch (channels.size()) {
    case 1:
      return {"one_axis", {"position"}, std::move(channels)};
    case 3:
      return {"one_point", {"x", "y", "z"}, std::move(channels)};
    case 7:
      return {"pose", {"x", "y", "z", "w", "x", "y", "z"}, std::move(channels)};
    case 9:
      return {"three_points",
              {"x1", "y1", "z1", "x2", "y2", "z2", "x3", "y3", "z3"},
              std::move(channels)};
    default:
      return {};
  }
}

Coordinates chosen(const StreamInfo& info, const StreamChoice& choice, const std::string& where) {
  std::vector<std::size_t> channels;
  for (const std::string& word : choice.channels) {
    const std::size_t channel = channel_named(word, info, where);
    if (std::find(channels.begin(), channels.end(), channel) != channels.end()) {
      throw InputError(where, "channel " + word + " is named twice", "name each once");
    }
    channels.push_back(channel);
  }
  Coordinates coordinates = coordinates_of(std::move(channels));
  if (!coordinates.channels.empty()) return coordinates;
  throw InputError(where, fmt::format("{} channels are no position", choice.channels.size()),
                   "name 1 (an axis), 3 (x y z), 7 (x y z and a quaternion w x y z) or 9 (three "
                   "points)");
}

Coordinates found_by_labels(const StreamInfo& info, const std::string& where) {
  const NamedCoordinates named = find_coordinates(info.channels);
  const std::size_t points = named.points.size();
  std::vector<std::size_t> channels;
  for (const NamedGroup& point : named.points) {
    channels.insert(channels.end(), point.channels.begin(), point.channels.end());
  }
  if (points == 1 && named.quaternions.size() == 1) {
    const std::vector<std::size_t>& turn = named.quaternions.front().channels;
    channels.insert(channels.end(), turn.begin(), turn.end());
    return coordinates_of(std::move(channels));
  }
  if (named.quaternions.empty() && (points == 1 || points == 3)) {
    return coordinates_of(std::move(channels));
  }
  if (info.channel_count == 1) return coordinates_of({0});
  throw InputError(where,
                   points == 0
                       ? "which channels are the position is not clear: it has " + labels_of(info)
                       : fmt::format("has {} points and {} rotations: {}", points,
                                     named.quaternions.size(), labels_of(info)),
                   kHowToChoose);
}

// The unit of the position, and how many of them a value stands for.
std::pair<std::string, int> unit_of(const StreamInfo& info, const StreamChoice& choice,
                                    const Coordinates& coordinates, const std::string& where) {
  std::string unit = choice.unit;
  const std::size_t lengths =
      std::min<std::size_t>(coordinates.channels.size(),
                            coordinates.channels.size() == 7 ? 3 : coordinates.channels.size());
  for (std::size_t i = 0; choice.unit.empty() && i < lengths; ++i) {
    const StreamChannel channel =
        info.channels.empty() ? StreamChannel() : info.channels[coordinates.channels[i]];
    const std::string stated = length_unit(channel);
    if (stated.empty()) {
      throw InputError(where,
                       channel.unit.empty()
                           ? "does not state the unit of its position"
                           : fmt::format("the unit \"{}\" is not a length", channel.unit),
                       "give --unit mm or --unit m (in a configuration: unit)");
    }
    if (i > 0 && stated != unit) {
      throw InputError(where, fmt::format("its position is in {} and {}", unit, stated),
                       "give --unit with one of them, and correct the sender");
    }
    unit = stated;
  }
  return unit == "cm" ? std::pair<std::string, int>{"mm", 10} : std::pair{unit, 1};
}

std::string toml_text(std::string_view text) {
  std::string result;
  for (const char c : clean_line(text)) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return '"' + result + '"';
}

std::string field_keys(ChannelFormat format) {
  const bool is_real = format == ChannelFormat::float32 || format == ChannelFormat::double64;
  return fmt::format("width_bits = {}\ntype = \"{}\"\n", 8 * value_size(format),
                     is_real ? "float" : "signed");
}

void add_time_field(std::string& toml, const char* name, std::size_t offset) {
  toml += fmt::format(
      "[auxiliary.{}]\noffset_bytes = {}\nwidth_bits = 64\ntype = \"float\"\nunit = \"s\"\n", name,
      offset);
}

std::string profile_of(const StreamInfo& info, const Coordinates& coordinates,
                       const std::vector<std::size_t>& stored, const std::string& unit,
                       int units_a_value) {
  const std::size_t value = value_size(info.format);
  std::string toml = fmt::format(
      "# Made from the description of an LSL stream.\nname = {}\nvendor_id = 0\nproduct_id = 0\n",
      toml_text("LSL stream " + info.name.substr(0, 64)));
  if (info.nominal_rate_Hz >= 0.01 && info.nominal_rate_Hz <= 1e5) {
    toml += fmt::format("rate_Hz = {}\n", info.nominal_rate_Hz);
  }
  toml += fmt::format(
      "restarts_on_reconnect = true\n[report]\nminimum_size_bytes = {}\n[sequence]\n"
      "offset_bytes = 0\nwidth_bits = 32\n",
      kReportHead + stored.size() * value);
  const std::string keys = field_keys(info.format);
  toml += fmt::format("[coordinates]\nkind = \"{}\"\nunit = \"{}\"\nscale = {}\n{}",
                      coordinates.kind, unit, units_a_value, keys);
  for (std::size_t i = 0; i < coordinates.channels.size(); ++i) {
    const bool is_turn = coordinates.channels.size() == 7 && i >= 3;
    if (is_turn && i == 3) toml += "[quaternion]\n" + keys;
    const auto place = std::find(stored.begin(), stored.end(), coordinates.channels[i]);
    toml += fmt::format("[{}.{}]\noffset_bytes = {}\n", is_turn ? "quaternion" : "coordinates",
                        coordinates.names[i],
                        kReportHead + value * static_cast<std::size_t>(place - stored.begin()));
  }
  add_time_field(toml, "lsl_stamp", 4);
  add_time_field(toml, "lsl_offset", 12);
  add_time_field(toml, "lsl_arrival", 20);
  return toml;
}

}  // namespace

std::vector<std::string> split_channels(const std::string& text) {
  std::vector<std::string> channels;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    const std::size_t first = text.find_first_not_of(' ', begin);
    const std::size_t last = text.find_last_not_of(' ', end == 0 ? 0 : end - 1);
    channels.push_back(first < end ? text.substr(first, last + 1 - first) : "");
    begin = end + 1;
  }
  return channels;
}

StreamLayout layout_of_stream(const StreamInfo& info, const StreamChoice& choice,
                              const std::string& where) {
  if (info.format == ChannelFormat::string) {
    throw InputError(where, "is a stream of texts, not of positions",
                     "name the stream of the tracker");
  }
  const Coordinates coordinates =
      choice.channels.empty() ? found_by_labels(info, where) : chosen(info, choice, where);
  const auto [unit, units_a_value] = unit_of(info, choice, coordinates, where);
  StreamLayout layout;
  layout.stored.resize(info.channel_count);
  std::iota(layout.stored.begin(), layout.stored.end(), std::size_t{0});
  // A stream of many markers has more values than a report has room for.
  if (kReportHead + info.channel_count * value_size(info.format) > hal::kMaxReportSize) {
    layout.stored = coordinates.channels;
  }
  layout.profile_toml = profile_of(info, coordinates, layout.stored, unit, units_a_value);
  return layout;
}

}  // namespace condyle::host::lsl
