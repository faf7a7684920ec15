// SPDX-License-Identifier: Apache-2.0
// XDF, as https://github.com/sccn/xdf/wiki/Specifications describes it: one stream of the samples,
// one of the estimates, one for each analogue channel, one of the events. The stamp of a
// sample is its time in the recording. All streams share this clock and state no clock offsets.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <pugixml.hpp>
#include <sstream>

#include "exports/export_format.h"
#include "exports/export_text.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

enum class Tag : std::uint16_t { file_header = 1, header = 2, samples = 3, footer = 6 };

template <class Number>
void append(std::string& bytes, Number number) {
  char raw[sizeof number];
  std::memcpy(raw, &number, sizeof number);
  bytes.append(raw, sizeof number);
}

// A length takes one byte that says how many bytes follow.
void append_length(std::string& bytes, std::size_t length) {
  bytes += '\4';
  append(bytes, static_cast<std::uint32_t>(length));
}

std::string chunk(Tag tag, const std::string& content) {
  std::string bytes;
  append_length(bytes, sizeof(std::uint16_t) + content.size());
  append(bytes, static_cast<std::uint16_t>(tag));
  return bytes + content;
}

void set(pugi::xml_node node, const char* name, const std::string& text) {
  node.append_child(name).text().set(clean_line(text).c_str());
}

std::string number_text(double value) {
  std::string text;
  append_number(text, value);
  return text;
}

std::string xml_text(const pugi::xml_document& document) {
  std::ostringstream text;
  document.save(text, "", pugi::format_raw);
  return text.str();
}

// A column of a stream of numbers.
struct Channel {
  std::string label, unit, type, marker, provenance;
  std::function<double(std::size_t)> value;
};

// Channel types of motion capture as the metadata of LSL name them.
std::string type_of(const ExportSeries& series, const std::string& component) {
  if (series.is_computed || component.empty()) return series.quantity;
  const char axis = static_cast<char>(component[0] - 'a' + 'A');
  if (series.is_point()) return fmt::format("Position{}", axis);
  if (series.quantity == "orientation") return fmt::format("Orientation{}", axis);
  return series.quantity;
}

class XdfFile {
 public:
  XdfFile(const ExportData& data, const TableForm& form, OutputFile& file)
      : data_(data), per_metre_(form.lengths_per_m(1000)), file_(file) {}

  void write() {
    pugi::xml_document document;
    set(document.append_child("info"), "version", "1.0");
    file_.write("XDF:" + chunk(Tag::file_header, xml_text(document)));
    const auto time_s = [this](std::size_t k) { return seconds(data_.time_ns[k]); };
    const double rate_Hz = data_.rate_Hz.value_or(data_.info.stated.rate_Hz.value_or(0));
    write_numbers("condyle", "MoCap", rate_Hz, channels_of(false), data_.samples(), time_s);
    const std::vector<Channel> estimates = channels_of(true);
    if (!estimates.empty()) {
      write_numbers("condyle_estimates", "Estimates", rate_Hz, estimates, data_.samples(), time_s);
    }
    for (const ExportChannel& one : data_.channels) {
      const Channel channel{.label = one.channel.name,
                            .unit = one.channel.unit,
                            .type = "analogue",
                            .marker = "",
                            .provenance = provenance_name(Provenance::measured),
                            .value = [&one](std::size_t k) { return one.values[k]; }};
      write_numbers(one.channel.name, "Analog", one.channel.rate_Hz, {channel}, one.values.size(),
                    [&one](std::size_t k) {
                      return one.first_s + static_cast<double>(k) / one.channel.rate_Hz;
                    });
    }
    write_events();
  }

 private:
  std::vector<Channel> channels_of(bool are_estimates) const {
    std::vector<Channel> channels;
    for (const ExportSeries& series : data_.series) {
      if (has_several_quantities(series) != are_estimates) continue;
      const WrittenUnit unit = written_unit(series.unit, per_metre_);
      for (std::size_t i = 0; i < series.components.size(); ++i) {
        const std::string& component = series.components[i];
        std::string label = series.is_point() && !are_estimates ? series.name : series_name(series);
        if (!component.empty()) label += "_" + component;
        if (series.quantity == "force" && !series.is_computed) label += "_N";
        channels.push_back(
            {.label = label,
             .unit = unit.name,
             .type = type_of(series, component),
             .marker = series.is_point() && !are_estimates ? series.name : "",
             .provenance = series.provenances.empty() ? provenance_name(series.provenance) : "",
             .value = [&series, i, unit](std::size_t k) {
               return series.at(k)[i] * unit.per_SI_unit;
             }});
        if (series.provenances.empty()) continue;
        channels.push_back({.label = label + "_provenance",
                            .unit = "",
                            .type = kProvenanceCodes,
                            .marker = "",
                            .provenance = "",
                            .value = [&series, i](std::size_t k) {
                              return static_cast<double>(series.provenance_at(k, i));
                            }});
      }
    }
    return channels;
  }

  // Writes the header of the next stream.
  std::uint32_t begin_stream(const std::string& name, const std::string& type, const char* format,
                             double rate_Hz, const std::vector<Channel>& channels) {
    const std::uint32_t id = ++streams_;
    pugi::xml_document document;
    pugi::xml_node info = document.append_child("info");
    set(info, "name", name);
    set(info, "type", type);
    set(info, "channel_count", std::to_string(channels.size()));
    set(info, "nominal_srate", number_text(rate_Hz));
    set(info, "channel_format", format);
    set(info, "source_id", fmt::format("condyle_export_{}", id));
    set(info, "created_by", "condyle " CONDYLE_VERSION);
    set(info, "recording", data_.source);
    pugi::xml_node list = info.append_child("desc").append_child("channels");
    for (const Channel& one : channels) {
      pugi::xml_node channel = list.append_child("channel");
      set(channel, "label", one.label);
      if (!one.marker.empty()) set(channel, "marker", one.marker);
      set(channel, "type", one.type);
      set(channel, "unit", one.unit);
      if (!one.provenance.empty()) set(channel, "provenance", one.provenance);
    }
    std::string bytes;
    append(bytes, id);
    file_.write(chunk(Tag::header, bytes + xml_text(document)));
    return id;
  }

  void end_stream(std::uint32_t id, double first_s, double last_s, std::size_t samples) {
    pugi::xml_document document;
    pugi::xml_node info = document.append_child("info");
    set(info, "first_timestamp", number_text(first_s));
    set(info, "last_timestamp", number_text(last_s));
    set(info, "sample_count", std::to_string(samples));
    std::string bytes;
    append(bytes, id);
    file_.write(chunk(Tag::footer, bytes + xml_text(document)));
  }

  void write_numbers(const std::string& name, const std::string& type, double rate_Hz,
                     const std::vector<Channel>& channels, std::size_t samples,
                     const std::function<double(std::size_t)>& time_s) {
    constexpr std::size_t kSamplesOfChunk = 512;
    const std::uint32_t id = begin_stream(name, type, "double64", rate_Hz, channels);
    for (std::size_t first = 0; first < samples; first += kSamplesOfChunk) {
      const std::size_t end = std::min(samples, first + kSamplesOfChunk);
      std::string bytes;
      append(bytes, id);
      append_length(bytes, end - first);
      for (std::size_t k = first; k < end; ++k) {
        bytes += '\x8';
        append(bytes, time_s(k));
        for (const Channel& channel : channels) append(bytes, channel.value(k));
      }
      file_.write(chunk(Tag::samples, bytes));
    }
    if (samples > 0) end_stream(id, time_s(0), time_s(samples - 1), samples);
  }

  void write_events() {
    if (data_.events.empty()) return;
    const Channel channel{.label = "event",
                          .unit = "",
                          .type = "Marker",
                          .marker = "",
                          .provenance = "",
                          .value = nullptr};
    const std::uint32_t id = begin_stream("condyle_events", "Markers", "string", 0, {channel});
    std::vector<NamedInstant> events = data_.events;
    std::stable_sort(
        events.begin(), events.end(),
        [](const NamedInstant& a, const NamedInstant& b) { return a.time_s < b.time_s; });
    for (const NamedInstant& event : events) {
      const std::string text = clean_line(event.name);
      std::string bytes;
      append(bytes, id);
      append_length(bytes, 1);
      bytes += '\x8';
      append(bytes, event.time_s);
      append_length(bytes, text.size());
      file_.write(chunk(Tag::samples, bytes + text));
    }
    end_stream(id, events.front().time_s, events.back().time_s, events.size());
  }

  const ExportData& data_;
  double per_metre_;
  OutputFile& file_;
  std::uint32_t streams_ = 0;
};

}  // namespace

Exported export_xdf(const ExportData& data, const TableForm& form, const std::string& out) {
  Exported result;
  result.files.push_back(std::make_unique<OutputFile>(out));
  XdfFile(data, form, *result.files.back()).write();
  result.files.back()->close();
  return result;
}

}  // namespace condyle::host
