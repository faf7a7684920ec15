// SPDX-License-Identifier: Apache-2.0
#include "recordings/c3d_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "recordings/c3d.h"
#include "recordings/c3d_events.h"
#include "recordings/file_units.h"
#include "statistics/quantile.h"

namespace condyle::host {
namespace {

constexpr std::size_t kBlock = 512;
constexpr char kC3dKey = 0x50;
// Farther than a room: numbers of this size are no metres.
constexpr double kFarthestAsMetres = 20;

// Places of the header's words in its bytes.
enum HeaderPlace : std::size_t {
  kPoints = 2,
  kAnalogNumbers = 4,
  kFirstFrame = 6,
  kLastFrame = 8,
  kScale = 12,
  kDataStart = 16,
  kAnalogSamples = 18,
  kRate = 20,
};

bool is_processor(char byte) {
  return byte >= static_cast<char>(C3dProcessor::intel) &&
         byte <= static_cast<char>(C3dProcessor::mips);
}

class LayoutReader {
 public:
  explicit LayoutReader(ByteReader& reader) : reader_(reader), path_(reader.path()) {}

  C3dLayout read() {
    header_ = reader_.peek(kBlock);
    if (header_.size() < kBlock) fail("ends within its header", "copy the file again");
    const std::size_t first = static_cast<unsigned char>(header_[0]);
    if (first < 2) fail("its header names no parameter section", "export the recording again");
    skip_to((first - 1) * kBlock);
    const std::string_view section = reader_.peek(ByteReader::kLongestLine);
    if (section.size() < 4) fail("ends before its parameters", "copy the file again");
    read_processor(section[3]);
    const std::size_t blocks = static_cast<unsigned char>(section[2]);
    std::size_t data = word(kDataStart);
    const std::size_t most = data > first ? (data - first) * kBlock
                             : blocks > 0 ? blocks * kBlock
                                          : section.size();
    const C3dParameters parameters(section.substr(0, most), layout_.processor, layout_.notes);
    if (data <= first) {
      data = static_cast<std::size_t>(
          parameters.count("POINT:DATA_START").value_or(static_cast<double>(first + blocks)));
      if (data <= first) fail("states no block where its frames begin", "export it again");
      note(fmt::format("the header names no block of the frames: read from block {}", data));
    }
    skip_to((data - 1) * kBlock);
    read_points(parameters);
    read_rate(parameters);
    read_channels(parameters);
    read_frames(parameters);
    const std::vector<std::string> units = parameters.texts("POINT:UNITS");
    if (!units.empty()) layout_.unit = units[0];
    read_maker(parameters);
    layout_.stated.frames = layout_.frames;
    layout_.stated.rate_Hz = layout_.rate_Hz;
    const auto first_frame = static_cast<double>(std::max<std::size_t>(word(kFirstFrame), 1));
    layout_.stated.events = c3d_events(header_, layout_.processor, parameters);
    for (NamedInstant& event : layout_.stated.events) {
      event.time_s -= (first_frame - 1) / layout_.rate_Hz;
    }
    return std::move(layout_);
  }

 private:
  [[noreturn]] void fail(const std::string& problem, const std::string& mend) const {
    throw InputError(path_, problem, mend);
  }
  void note(std::string text) { layout_.notes.push_back(std::move(text)); }

  std::size_t word(HeaderPlace place) const {
    return c3d_word(layout_.processor, header_.data() + place);
  }
  double number(HeaderPlace place) const {
    return c3d_float(layout_.processor, header_.data() + place);
  }

  void skip_to(std::size_t offset) {
    while (reader_.offset() < offset) {
      const auto part =
          static_cast<std::size_t>(std::min<std::uint64_t>(offset - reader_.offset(), kBlock));
      if (reader_.peek(part).size() < part) fail("ends before its frames", "copy the file again");
      reader_.skip(part);
    }
  }

  void read_processor(char byte) {
    if (!is_processor(byte)) {
      fail(fmt::format("states the unknown processor {}", static_cast<int>(byte)),
           "known are 84 (Intel), 85 (DEC) and 86 (MIPS); export it again");
    }
    layout_.processor = static_cast<C3dProcessor>(byte);
  }

  void read_points(const C3dParameters& parameters) {
    const std::size_t points = word(kPoints);
    const auto used = parameters.count("POINT:USED");
    if (used && *used != static_cast<double>(points)) {
      note(fmt::format("the header states {} points, POINT:USED {:g}: read by the header", points,
                       *used));
    }
    layout_.names = parameters.all_texts("POINT:LABELS");
    const std::size_t named = layout_.names.size();
    layout_.names.resize(points);
    for (std::size_t i = named; i < points; ++i) layout_.names[i] = fmt::format("p{}", i);
    if (named < points) {
      note(fmt::format("{} of {} points have no name: called p{} to p{}", points - named, points,
                       named, points - 1));
    }
    double scale = number(kScale);
    if (const auto stated = parameters.number("POINT:SCALE"); stated && std::isfinite(*stated)) {
      if (std::signbit(*stated) != std::signbit(scale)) {
        note("header and POINT:SCALE do not agree whether it has integers: read by POINT:SCALE");
      }
      scale = *stated;
    }
    if (!std::isfinite(scale) || scale == 0) {
      fail(fmt::format("states the scale {:g} of its coordinates", scale), "export it again");
    }
    layout_.has_floats = scale < 0;
    layout_.scale = std::abs(scale);
  }

  void read_rate(const C3dParameters& parameters) {
    const auto is_rate = [](double rate_Hz) { return rate_Hz >= 1e-3 && rate_Hz <= 1e6; };
    const double in_header = number(kRate);
    const double stated = parameters.number("POINT:RATE").value_or(in_header);
    layout_.rate_Hz = is_rate(stated) ? stated : in_header;
    if (!is_rate(layout_.rate_Hz)) {
      fail(fmt::format("states the frame rate {:g} Hz", layout_.rate_Hz), "export it again");
    }
    if (is_rate(in_header) && std::abs(in_header - layout_.rate_Hz) > 1e-4 * in_header) {
      note(fmt::format("the header states {:g} Hz, POINT:RATE {:g} Hz: read by POINT:RATE",
                       in_header, layout_.rate_Hz));
    }
  }

  void read_channels(const C3dParameters& parameters) {
    std::size_t numbers = word(kAnalogNumbers);
    if (numbers == 0) return;
    layout_.samples = std::max<std::size_t>(word(kAnalogSamples), 1);
    const double used = parameters.count("ANALOG:USED").value_or(0);
    if (numbers % layout_.samples != 0 && used == static_cast<double>(numbers)) {
      note(
          fmt::format("the header counts {} analogue numbers in a frame, which are the channels: "
                      "read as {} channels of {} samples",
                      numbers, numbers, layout_.samples));
      numbers *= layout_.samples;
    }
    if (numbers % layout_.samples != 0) {
      fail(fmt::format("states {} analogue numbers and {} samples in each frame", numbers,
                       layout_.samples),
           "export it again");
    }
    const std::size_t channels = numbers / layout_.samples;
    const double rate_Hz = static_cast<double>(layout_.samples) * layout_.rate_Hz;
    const std::vector<std::string> names = parameters.all_texts("ANALOG:LABELS");
    const std::vector<std::string> units = parameters.all_texts("ANALOG:UNITS");
    const std::vector<std::string> format = parameters.texts("ANALOG:FORMAT");
    layout_.is_unsigned = !format.empty() && format[0].starts_with("UNSIGNED");
    const double general = parameters.number("ANALOG:GEN_SCALE").value_or(1);
    for (std::size_t i = 0; i < channels; ++i) {
      AnalogChannel channel{.name = i < names.size() ? names[i] : fmt::format("channel {}", i + 1),
                            .unit = i < units.size() ? units[i] : "",
                            .rate_Hz = rate_Hz};
      layout_.stated.channels.push_back(std::move(channel));
      const auto offset = layout_.is_unsigned ? parameters.count("ANALOG:OFFSET", i)
                                              : parameters.number("ANALOG:OFFSET", i);
      const auto scale = parameters.number("ANALOG:SCALE", i);
      layout_.channels.push_back({.offset = offset.value_or(0),
                                  .scale = general * scale.value_or(1),
                                  .is_scaled = scale.has_value()});
    }
  }

  // A file of more than 65535 frames states their number in parameters. Where the statements
  // differ, that one holds with which the file ends.
  void read_frames(const C3dParameters& parameters) {
    const std::size_t bytes = layout_.frame_bytes();
    if (bytes == 0) fail("has neither points nor analogue channels", "export it again");
    struct Statement {
      const char* by;
      double frames;
    };
    std::vector<Statement> statements;
    const auto add = [&](const char* by, double frames) {
      if (frames >= 1 && frames <= 4294967295.0 && frames == std::floor(frames)) {
        statements.push_back({by, frames});
      }
    };
    const double first = static_cast<double>(word(kFirstFrame)),
                 last = static_cast<double>(word(kLastFrame));
    add("the header", last - first + 1);
    const auto long_number = [&](const std::string& name) -> std::optional<double> {
      const auto low = parameters.count(name, 0), high = parameters.count(name, 1);
      if (!low || !high) return std::nullopt;
      return *low + 65536 * *high;
    };
    const auto begin = long_number("TRIAL:ACTUAL_START_FIELD"),
               end = long_number("TRIAL:ACTUAL_END_FIELD");
    if (begin && end) add("TRIAL:ACTUAL_END_FIELD", *end - *begin + 1);
    if (const auto many = parameters.number("POINT:LONG_FRAMES")) add("POINT:LONG_FRAMES", *many);
    if (const auto few = parameters.count("POINT:FRAMES")) add("POINT:FRAMES", *few);
    if (statements.empty()) fail("states no number of frames", "export it again");

    std::error_code unknown;
    const std::uintmax_t size = std::filesystem::file_size(path_, unknown);
    auto chosen = statements.begin();
    double room = chosen->frames;
    if (!unknown && size > 0) {
      room =
          std::floor(static_cast<double>(size - std::min<std::uintmax_t>(size, reader_.offset())) /
                     static_cast<double>(bytes));
      // The last block may be filled up.
      const double surplus = std::ceil(static_cast<double>(kBlock) / static_cast<double>(bytes));
      chosen = std::find_if(statements.begin(), statements.end(), [&](const Statement& statement) {
        return statement.frames <= room && statement.frames + surplus >= room;
      });
      if (chosen == statements.end()) {  // the largest that the file can hold
        chosen = statements.begin();
        for (auto other = statements.begin(); other != statements.end(); ++other) {
          const bool is_better = chosen->frames > room ? other->frames < chosen->frames
                                                       : other->frames > chosen->frames;
          if (is_better && (other->frames <= room || chosen->frames > room)) chosen = other;
        }
      }
    }
    layout_.frames = static_cast<std::uint64_t>(chosen->frames);
    for (const Statement& other : statements) {
      if (other.frames == chosen->frames) continue;
      note(fmt::format("{} states {:.0f} frames, {} {:.0f}: read by {}", other.by, other.frames,
                       chosen->by, chosen->frames, chosen->by));
    }
  }

  void read_maker(const C3dParameters& parameters) {
    std::vector<std::string> words;
    for (const char* name : {"MANUFACTURER:COMPANY", "MANUFACTURER:SOFTWARE"}) {
      const std::vector<std::string> texts = parameters.texts(name);
      if (!texts.empty() && !texts[0].empty()) words.push_back(texts[0]);
    }
    layout_.stated.maker = fmt::format("{}", fmt::join(words, ", "));
  }

  ByteReader& reader_;
  std::string path_, header_;
  C3dLayout layout_;
};

// The largest coordinate of the first frames, without the largest tenth.
double usual_extent(ByteReader& reader, const C3dLayout& layout) {
  const std::size_t bytes = layout.frame_bytes();
  const auto frames = static_cast<std::size_t>(
      std::min<std::uint64_t>(layout.frames, ByteReader::kLongestLine / bytes));
  const std::string_view data = reader.peek(frames * bytes);
  std::vector<double> sizes;
  for (std::size_t frame = 0; (frame + 1) * bytes <= data.size(); ++frame) {
    for (std::size_t i = 0; i < layout.names.size(); ++i) {
      const Eigen::Vector3d place =
          c3d_point(layout, data.data() + frame * bytes + 4 * i * layout.number_bytes());
      if (place.allFinite()) sizes.push_back(place.cwiseAbs().maxCoeff());
    }
  }
  if (sizes.empty()) return 0;
  return sorted_at(sizes, (sizes.size() - 1) * 9 / 10);
}

}  // namespace

double c3d_number(const C3dLayout& layout, const char* bytes) {
  return layout.has_floats ? c3d_float(layout.processor, bytes)
                           : static_cast<double>(c3d_integer(layout.processor, bytes));
}

Eigen::Vector3d c3d_point(const C3dLayout& layout, const char* bytes) {
  const std::size_t step = layout.number_bytes();
  // The fourth number holds cameras and residual; negative, the point was not measured.
  if (!(c3d_number(layout, bytes + 3 * step) >= 0)) {
    return Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  }
  const Eigen::Vector3d place(c3d_number(layout, bytes), c3d_number(layout, bytes + step),
                              c3d_number(layout, bytes + 2 * step));
  return layout.has_floats ? place : Eigen::Vector3d(layout.scale * place);
}

bool looks_like_c3d(ByteReader& reader) {
  const std::string_view start = reader.peek(kBlock);
  if (start.size() < kBlock || start[1] != kC3dKey) return false;
  const std::size_t first = static_cast<unsigned char>(start[0]);
  if (first < 2) return false;
  const std::string_view section = reader.peek((first - 1) * kBlock + 4);
  return section.size() == (first - 1) * kBlock + 4 && is_processor(section.back());
}

C3dLayout read_c3d_layout(ByteReader& reader) {
  return LayoutReader(reader).read();
}

void find_c3d_unit(ByteReader& reader, std::optional<double> given_per_metre, C3dLayout& layout) {
  const auto unit = length_unit(layout.unit);
  if (unit) layout.stated.unit = unit->name;
  if (given_per_metre) {
    layout.units_per_metre = *given_per_metre;
    RecordingInfo info;
    info.stated.unit = layout.stated.unit;
    use_given_unit(given_per_metre, info);
    layout.stated.unit = info.stated.unit;
    layout.notes.insert(layout.notes.end(), info.notes.begin(), info.notes.end());
    return;
  }
  if (layout.names.empty()) return;
  const double extent = usual_extent(reader, layout);
  if (unit) {
    layout.units_per_metre = unit->per_metre;
    if (extent > kFarthestAsMetres * unit->per_metre) {
      throw InputError(reader.path(),
                       fmt::format("states its coordinates in {}, and they reach {:.3g} m, where "
                                   "no jaw is",
                                   unit->name, extent / unit->per_metre),
                       "give --unit mm or --unit m, the unit that is right");
    }
    return;
  }
  if (!layout.unit.empty() || !(extent > kFarthestAsMetres)) {
    throw InputError(
        reader.path(),
        layout.unit.empty()
            ? fmt::format("states no unit of its coordinates, which reach {:.3g}", extent)
            : fmt::format("states its coordinates in {}, an unknown unit", quote(layout.unit)),
        "give --unit mm or --unit m");
  }
  layout.units_per_metre = 1000;
  layout.stated.unit = "mm";
  layout.notes.push_back(fmt::format(
      "it states no unit of its coordinates: read as mm, because in m they would reach {:.0f} m; "
      "--unit decides",
      extent));
}

}  // namespace condyle::host
