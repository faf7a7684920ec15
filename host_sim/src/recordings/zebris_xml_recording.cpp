// SPDX-License-Identifier: Apache-2.0
// Zebris XML export. Read tolerantly, because the manufacturer does not document it:
//   ROOT / movements / movement[k] / tracks / track[1..3] / frequency (Hz)
//                                                         / quants / quant / x, y, z
// Each value is a child element or an attribute of that name, in any case of letters. No other
// element is read: exports carry the patient's identity. The file does not state the unit, so the
// user must.
#include <fmt/format.h>
#include <strings.h>

#include <algorithm>
#include <fstream>
#include <pugixml.hpp>

#include "hosted/files/input_error.h"
#include "recordings/recording_formats.h"

namespace condyle::host {
namespace {

// The whole document is in memory: its text, and the parser's nodes.
constexpr std::size_t kLargestFile = std::size_t{128} << 20, kMostParsed = std::size_t{320} << 20;
constexpr std::size_t kElement = 64, kAttribute = 48;
constexpr std::size_t kLineBlock = 65536;

bool is_named(const char* name, const char* wanted) {
  const char* const colon = std::find(name, name + std::strlen(name), ':');
  return strcasecmp(*colon == ':' ? colon + 1 : name, wanted) == 0;  // without name space
}

pugi::xml_node child(pugi::xml_node node, const char* name) {
  return node.find_child([name](pugi::xml_node c) { return is_named(c.name(), name); });
}

pugi::xml_node next_named(pugi::xml_node node, const char* name) {
  do {
    node = node.next_sibling();
  } while (node && !is_named(node.name(), name));
  return node;
}

class ZebrisXmlRecording final : public Recording {
 public:
  ZebrisXmlRecording(std::unique_ptr<ByteReader> reader, const RecordingOptions& options)
      : path_(reader->path()), rule_(options.faults) {
    load(*reader);
    if (!options.units_per_metre) {
      throw InputError(path_, "the format does not state the unit of its coordinates",
                       "give --unit mm or --unit m");
    }
    units_per_metre_ = *options.units_per_metre;
    info_.format = "Zebris XML";
    find_tracks(options.movement);
  }

  bool next(Sample& sample) override {
    const bool any = quants_[0] || quants_[1] || quants_[2];
    if (!any) return false;
    sample = Sample{};
    sample.kind = info_.kind;
    sample.sequence = sequence_++;
    sample.time_ns = regular_time_ns(0, sample.sequence, 1 / frequency_Hz_, path_);
    for (std::size_t track = 0; track < tracks_; ++track) {
      if (!quants_[track]) {
        throw InputError(path_,
                         fmt::format("track {} ends after {} quants, before the others", track + 1,
                                     sample.sequence),
                         "export the recording again");
      }
      for (std::size_t i = 0; i < 3; ++i) {
        const char name[2] = {"xyz"[i], '\0'};
        double value = 0;
        const std::string text = value_text(quants_[track], name);
        const NumberStatus status = parse_number(text, value);
        const bool usable = status == NumberStatus::ok ||
                            rule_.accept(status, place_of(quants_[track]),
                                         fmt::format("{} of track {}", name, track + 1), text);
        sample.position_valid = sample.position_valid && usable;
        sample.coordinates[3 * track + i] = value / units_per_metre_;
      }
    }
    if (is_out_of_range(sample.kind, sample.coordinates)) sample.position_valid = false;
    last_quant_ = quants_[0];
    for (std::size_t track = 0; track < tracks_; ++track) {
      quants_[track] = next_named(quants_[track], "quant");
    }
    return true;
  }

  const RecordingInfo& info() const override { return info_; }
  std::string place() const override { return place_of(last_quant_); }
  double progress() const override {
    return last_quant_
               ? static_cast<double>(last_quant_.offset_debug()) / static_cast<double>(size_)
               : 0;
  }

 private:
  void load(ByteReader& reader) {
    while (true) {
      const std::string_view part = reader.peek(65536);
      if (part.empty()) break;
      text_ += part;
      reader.skip(part.size());
      if (text_.size() > kLargestFile) {
        throw InputError(path_, fmt::format("is larger than {} MiB", kLargestFile >> 20),
                         "export fewer movements, or as text");
      }
    }
    size_ = text_.size();
    std::size_t parsed = 0;
    std::uint64_t line = 1;
    for (std::size_t i = 0; i < text_.size(); ++i) {
      if (i % kLineBlock == 0) block_lines_.push_back(line);
      if (text_[i] == '\n') ++line;
      if (text_[i] == '<') parsed += kElement;
      if (text_[i] == '=') parsed += kAttribute;
    }
    if (parsed > kMostParsed) {
      throw InputError(path_,
                       fmt::format("has about {} million elements, too many for the memory",
                                   parsed / kElement / 1'000'000),
                       "export fewer movements, or as text");
    }
    // Parse in place, so that the text is in memory only once.
    const pugi::xml_parse_result result = document_.load_buffer_inplace(text_.data(), text_.size());
    if (!result) {
      throw InputError(fmt::format("{}:{}", path_, line_at(result.offset)),
                       fmt::format("is not well-formed XML: {}", result.description()),
                       "export the recording again");
    }
  }

  void find_tracks(int movement_number) {
    const pugi::xml_node movements = child(document_.document_element(), "movements");
    pugi::xml_node movement = child(movements, "movement");
    int count = 0;
    pugi::xml_node chosen;
    for (; movement; movement = next_named(movement, "movement")) {
      if (++count == movement_number) chosen = movement;
    }
    if (!chosen) {
      throw InputError(path_,
                       fmt::format("has no movement {} (movements / movement): {} found",
                                   movement_number, count),
                       count > 0 ? fmt::format("choose --movement 1 to {}", count)
                                 : "check that this is a Zebris export with movement tracks");
    }
    if (count > 1) {
      info_.notes.push_back(
          fmt::format("movement {} of {} (--movement chooses)", movement_number, count));
    }
    for (pugi::xml_node track = child(child(chosen, "tracks"), "track"); track;
         track = next_named(track, "track")) {
      if (tracks_ < 3) {
        quants_[tracks_] = child(child(track, "quants"), "quant");
        read_frequency(track);
      }
      ++tracks_;
    }
    if (tracks_ != 1 && tracks_ != 3) {
      throw InputError(path_, fmt::format("the movement has {} tracks, not 1 or 3", tracks_),
                       "check the export");
    }
    info_.kind = tracks_ == 3 ? SampleKind::three_points : SampleKind::one_point;
  }

  void read_frequency(pugi::xml_node track) {
    double frequency_Hz = 0;
    std::string text = value_text(track, "frequency");
    if (text.ends_with("Hz")) text.resize(text.size() - 2);
    const std::string place = place_of(track);
    if (parse_number(text, frequency_Hz) != NumberStatus::ok ||
        !(frequency_Hz >= 1e-3 && frequency_Hz <= 1e6)) {
      throw InputError(place,
                       fmt::format("the track's frequency {} is not a valid rate", quote(text)),
                       "give it in Hz");
    }
    if (frequency_Hz_ > 0 && frequency_Hz != frequency_Hz_) {
      throw InputError(place, "the tracks differ in frequency", "check the export");
    }
    frequency_Hz_ = frequency_Hz;
  }

  // A value that is the only content of its element may have a decimal comma.
  static std::string value_text(pugi::xml_node node, const char* name) {
    const pugi::xml_attribute attribute =
        node.find_attribute([name](pugi::xml_attribute a) { return is_named(a.name(), name); });
    std::string text(trim(attribute ? attribute.value() : child(node, name).text().get()));
    if (std::count(text.begin(), text.end(), ',') == 1 && text.find('.') == std::string::npos) {
      std::replace(text.begin(), text.end(), ',', '.');
    }
    return text;
  }

  // The parser changed the text, so count the lines of the block in the file.
  std::uint64_t line_at(std::ptrdiff_t offset) const {
    const std::size_t block = static_cast<std::size_t>(offset) / kLineBlock;
    if (block >= block_lines_.size()) return block_lines_.empty() ? 1 : block_lines_.back();
    std::uint64_t line = block_lines_[block];
    std::ifstream file(path_, std::ios::binary);
    file.seekg(static_cast<std::streamoff>(block * kLineBlock));
    for (auto left = static_cast<std::size_t>(offset) % kLineBlock; left > 0 && file; --left) {
      if (file.get() == '\n') ++line;
    }
    return line;
  }
  std::string place_of(pugi::xml_node node) const {
    return node ? fmt::format("{}:{}", path_, line_at(node.offset_debug())) : path_;
  }

  std::string path_;
  FaultRule rule_;
  RecordingInfo info_;
  pugi::xml_document document_;
  std::string text_;                        // that the document is parsed in
  std::vector<std::uint64_t> block_lines_;  // the line with which each block of it begins
  std::size_t size_ = 0;
  pugi::xml_node quants_[3], last_quant_;
  std::size_t tracks_ = 0;
  double units_per_metre_ = 1;
  double frequency_Hz_ = 0;
  std::uint64_t sequence_ = 0;
};

}  // namespace

std::unique_ptr<Recording> open_zebris_xml(std::unique_ptr<ByteReader> reader,
                                           const RecordingOptions& options) {
  return std::make_unique<ZebrisXmlRecording>(std::move(reader), options);
}

}  // namespace condyle::host
