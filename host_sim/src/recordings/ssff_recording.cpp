// SPDX-License-Identifier: Apache-2.0
// SSFF (Simple Signal File Format, Emu Speech Database): a text header with Machine (byte order),
// Record_Freq (Hz), Start_Time (s) and Column NAME TYPE COUNT lines up to a line of dashes, then
// binary records. The columns whose names end in posx, posy, posz are the position of one point;
// orientations and other columns are not read. The format states no unit: millimetres by default.
#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "hosted/files/input_error.h"
#include "recordings/recording_formats.h"

namespace condyle::host {
namespace {

constexpr std::size_t kLargestRecord = 65536;

struct ValueType {
  std::string_view name;
  std::size_t size;
  double (*load)(const char* bytes);
};

template <class T>
double load(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return static_cast<double>(value);
}

constexpr ValueType kTypes[] = {{"FLOAT", 4, load<float>},        {"DOUBLE", 8, load<double>},
                                {"SHORT", 2, load<std::int16_t>}, {"LONG", 4, load<std::int32_t>},
                                {"BYTE", 1, load<std::uint8_t>},  {"CHAR", 1, load<std::int8_t>}};

struct CoordinateField {
  const ValueType* type = nullptr;
  std::size_t offset = 0;
  std::string name;
};

class SsffRecording final : public Recording {
 public:
  SsffRecording(std::unique_ptr<ByteReader> reader, const RecordingOptions& options)
      : reader_(std::move(reader)),
        rule_(options.faults),
        filled_(options.missing),
        units_per_metre_(options.units_per_metre.value_or(1000)) {
    info_.format = "SSFF";
    info_.kind = SampleKind::one_point;
    if (!options.units_per_metre) {
      info_.notes.emplace_back(
          "the format states no unit: read as millimetres (--unit m for metres)");
    }
    read_header();
  }

  bool next(Sample& sample) override {
    const std::string_view record = reader_->peek(record_size_);
    if (record.empty()) {
      if (!has_ended_) filled_.add_notes(info_.notes);
      has_ended_ = true;
      return false;
    }
    if (record.size() < record_size_) {
      throw InputError(place(),
                       fmt::format("the file ends inside the next record: {} of {} bytes",
                                   record.size(), record_size_),
                       "copy the file again");
    }
    sample = Sample{};
    sample.kind = info_.kind;
    sample.sequence = sequence_++;
    sample.time_ns =
        regular_time_ns(start_ns_, sample.sequence, 1 / frequency_Hz_, reader_->path());
    for (std::size_t i = 0; i < 3; ++i) {
      const CoordinateField& field = fields_[i];
      char bytes[8];
      std::copy_n(record.data() + field.offset, field.type->size, bytes);
      if (swap_bytes_) std::reverse(bytes, bytes + field.type->size);
      const double value = field.type->load(bytes);
      const bool usable =
          std::isfinite(value) ||
          rule_.accept(NumberStatus::not_finite, place(), field.name, fmt::format("{}", value));
      sample.position_valid = sample.position_valid && usable;
      sample.coordinates[i] = value / units_per_metre_;
    }
    filled_.drop(sample, units_per_metre_, [this] { return place(); });
    if (is_out_of_range(sample.kind, sample.coordinates)) sample.position_valid = false;
    reader_->skip(record_size_);
    return true;
  }

  const RecordingInfo& info() const override { return info_; }
  std::string place() const override {
    return sequence_ == 0 ? fmt::format("{}:{}", reader_->path(), reader_->line_number())
                          : fmt::format("{}: record {} at byte {}", reader_->path(), sequence_,
                                        reader_->offset());
  }
  double progress() const override { return reader_->progress(); }

 private:
  void read_header() {
    std::string_view line;
    bool byte_order_known = false;
    while (true) {
      if (!reader_->next_line(line) || reader_->line_number() > 10000) {
        throw InputError(place(), "the header has no line of dashes at its end",
                         "check that the file is SSFF");
      }
      if (line.size() >= 3 && line.find_first_not_of('-') == line.npos) break;
      const std::string_view value = value_after_key(line);
      const auto number = [&](double& result) {
        if (parse_number(value, result) != NumberStatus::ok) {
          throw InputError(place(), fmt::format("{} is not a number", quote(value)),
                           "check that the file is SSFF");
        }
      };
      if (line.starts_with("Machine ")) {
        const bool little = value == "IBM-PC";
        if (!little && value != "SPARC") {
          throw InputError(place(), fmt::format("unknown machine {}", quote(value)),
                           "the byte order is known for IBM-PC and SPARC");
        }
        swap_bytes_ = little != (std::endian::native == std::endian::little);
        byte_order_known = true;
      } else if (line.starts_with("Record_Freq ")) {
        number(frequency_Hz_);
      } else if (line.starts_with("Start_Time ")) {
        if (parse_time_s(value, start_ns_) != NumberStatus::ok) {
          throw InputError(place(), fmt::format("{} is not a time", quote(value)), "give seconds");
        }
      } else if (line.starts_with("Column ")) {
        add_column(value);
      }
    }
    if (!byte_order_known || !(frequency_Hz_ >= 1e-3 && frequency_Hz_ <= 1e6)) {
      throw InputError(place(), "the header lacks Machine or a usable Record_Freq",
                       "check that the file is SSFF");
    }
    for (std::size_t i = 0; i < 3; ++i) {
      if (fields_[i].type == nullptr) {
        throw InputError(place(), fmt::format("no column ends in pos{}", "xyz"[i]),
                         "condyle needs the columns *posx, *posy, *posz");
      }
    }
  }

  static std::string_view value_after_key(std::string_view line) {
    const std::size_t blank = line.find(' ');
    return blank == std::string_view::npos ? std::string_view() : trim(line.substr(blank));
  }

  // NAME TYPE COUNT
  void add_column(std::string_view text) {
    const std::size_t first = text.find(' '), second = text.rfind(' ');
    double count = 0;
    const bool shaped = first != std::string_view::npos && second > first &&
                        parse_number(text.substr(second), count) == NumberStatus::ok &&
                        count >= 1 && count <= static_cast<double>(kLargestRecord) &&
                        count == std::floor(count);
    const std::string_view name = text.substr(0, first);
    const std::string_view type_name =
        shaped ? trim(text.substr(first, second - first)) : std::string_view();
    const auto* const type = std::find_if(std::begin(kTypes), std::end(kTypes),
                                          [&](const ValueType& t) { return t.name == type_name; });
    if (!shaped || type == std::end(kTypes)) {
      throw InputError(place(), fmt::format("{} is not NAME TYPE COUNT", quote(text)),
                       "types are FLOAT, DOUBLE, SHORT, LONG, BYTE and CHAR");
    }
    for (std::size_t i = 0; i < 3; ++i) {
      if (!name.ends_with(std::string("pos") + "xyz"[i])) continue;
      if (fields_[i].type != nullptr) {
        throw InputError(place(), fmt::format("a second column ends in pos{}", "xyz"[i]),
                         "keep the columns of one sensor");
      }
      fields_[i] = {type, record_size_, std::string(name)};
    }
    record_size_ += type->size * static_cast<std::size_t>(count);
    if (record_size_ > kLargestRecord) {
      throw InputError(place(), fmt::format("a record is longer than {} bytes", kLargestRecord),
                       "check that the file is SSFF");
    }
  }

  std::unique_ptr<ByteReader> reader_;
  FaultRule rule_;
  FilledNumbers filled_;
  double units_per_metre_;
  RecordingInfo info_;
  CoordinateField fields_[3];
  std::size_t record_size_ = 0;
  bool swap_bytes_ = false;
  double frequency_Hz_ = 0;
  TimeNs start_ns_ = 0;
  std::uint64_t sequence_ = 0;
  bool has_ended_ = false;
};

}  // namespace

std::unique_ptr<Recording> open_ssff(std::unique_ptr<ByteReader> reader,
                                     const RecordingOptions& options) {
  return std::make_unique<SsffRecording>(std::move(reader), options);
}

}  // namespace condyle::host
