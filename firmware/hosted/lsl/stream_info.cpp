// SPDX-License-Identifier: Apache-2.0
#include "hosted/lsl/stream_info.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <pugixml.hpp>

namespace condyle::host::lsl {
namespace {

constexpr std::array<const char*, 7> kFormatNames = {"float32", "double64", "string", "int32",
                                                     "int16",   "int8",     "int64"};
constexpr std::size_t kLongestText = 1024;

bool read_number(const char* text, double& value) {
  const std::string_view digits(text);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  return error == std::errc() && end == digits.data() + digits.size() && std::isfinite(value);
}

// A whole number in [0, most].
bool read_count(pugi::xml_node info, const char* name, double most, double& value) {
  return read_number(info.child_value(name), value) && value >= 0 && value <= most &&
         value == std::floor(value);
}

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        // XML 1.0 has no other control characters.
        result += static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t' ? ' ' : c;
    }
  }
  return result;
}

void add(std::string& xml, const char* name, std::string_view value) {
  xml += fmt::format("<{0}>{1}</{0}>\n", name, escaped(value));
}

std::string parse_identity(pugi::xml_node node, StreamInfo& info) {
  const auto text = [&](const char* name, std::string& value) {
    value = std::string(node.child_value(name)).substr(0, kLongestText);
  };
  text("name", info.name);
  text("type", info.type);
  text("source_id", info.source_id);
  text("uid", info.uid);
  text("session_id", info.session_id);
  text("hostname", info.hostname);
  if (info.name.empty()) return "its information has no name";
  if (info.uid.empty()) return "its information has no uid";
  return "";
}

std::string parse_numbers(pugi::xml_node node, StreamInfo& info) {
  double count = 0, version = 0, port = 0;
  if (!read_count(node, "channel_count", kMostChannels, count)) {
    return fmt::format("its channel_count is not a number from 0 to {}", kMostChannels);
  }
  info.channel_count = static_cast<std::size_t>(count);
  if (!read_number(node.child_value("nominal_srate"), info.nominal_rate_Hz) ||
      info.nominal_rate_Hz < 0 || info.nominal_rate_Hz > 1e9) {
    return "its nominal_srate is not a rate";
  }
  if (!read_number(node.child_value("version"), version) || version <= 0 || version > 100) {
    return "its version is not a number";
  }
  info.version = static_cast<int>(std::lround(version * 100));
  if (!read_number(node.child_value("created_at"), info.created_at_s)) info.created_at_s = 0;
  if (!read_count(node, "v4data_port", 65535, port)) return "its v4data_port is not a port";
  info.data_port = static_cast<std::uint16_t>(port);
  if (!read_count(node, "v4service_port", 65535, port)) return "its v4service_port is not a port";
  info.service_port = static_cast<std::uint16_t>(port);
  return "";
}

void parse_channels(pugi::xml_node node, StreamInfo& info) {
  info.channels.clear();
  for (const pugi::xml_node channel : node.child("desc").child("channels").children("channel")) {
    if (info.channels.size() == info.channel_count) break;
    const auto text = [&](const char* name) {
      return std::string(channel.child_value(name)).substr(0, kLongestText);
    };
    info.channels.push_back({text("label"), text("unit"), text("type")});
  }
  if (info.channels.size() != info.channel_count) info.channels.clear();
}

}  // namespace

const char* format_name(ChannelFormat format) {
  return kFormatNames[static_cast<std::size_t>(format)];
}

std::size_t value_size(ChannelFormat format) {
  constexpr std::array<std::size_t, 7> sizes = {4, 8, 0, 4, 2, 1, 8};
  return sizes[static_cast<std::size_t>(format)];
}

std::string parse_stream_info(std::string_view xml, StreamInfo& info) {
  if (xml.size() > kMostInfoBytes) return "its information is longer than 1 MiB";
  pugi::xml_document document;
  if (!document.load_buffer(xml.data(), xml.size())) return "its information is not XML";
  const pugi::xml_node node = document.child("info");
  if (!node) return "its information has no <info>";
  StreamInfo parsed;
  if (std::string problem = parse_identity(node, parsed); !problem.empty()) return problem;
  if (std::string problem = parse_numbers(node, parsed); !problem.empty()) return problem;
  const std::string_view format = node.child_value("channel_format");
  std::size_t index = 0;
  while (index < kFormatNames.size() && format != kFormatNames[index]) ++index;
  if (index == kFormatNames.size()) return "its channel_format is not one of LSL's";
  parsed.format = static_cast<ChannelFormat>(index);
  parse_channels(node, parsed);
  info = std::move(parsed);
  return "";
}

std::string stream_info_xml(const StreamInfo& info, bool is_full) {
  std::string xml = "<?xml version=\"1.0\"?>\n<info>\n";
  add(xml, "name", info.name);
  add(xml, "type", info.type);
  add(xml, "channel_count", fmt::format("{}", info.channel_count));
  add(xml, "channel_format", format_name(info.format));
  add(xml, "source_id", info.source_id);
  add(xml, "nominal_srate", fmt::format("{}", info.nominal_rate_Hz));
  add(xml, "version", fmt::format("{:.6f}", info.version / 100.0));
  add(xml, "created_at", fmt::format("{:.6f}", info.created_at_s));
  add(xml, "uid", info.uid);
  add(xml, "session_id", info.session_id);
  add(xml, "hostname", info.hostname);
  add(xml, "v4address", "");
  add(xml, "v4data_port", fmt::format("{}", info.data_port));
  add(xml, "v4service_port", fmt::format("{}", info.service_port));
  add(xml, "v6address", "");
  add(xml, "v6data_port", "0");
  add(xml, "v6service_port", "0");
  if (!is_full) return xml + "<desc />\n</info>\n";
  xml += "<desc>\n<channels>\n";
  for (const StreamChannel& channel : info.channels) {
    xml += "<channel>\n";
    add(xml, "label", channel.label);
    add(xml, "unit", channel.unit);
    add(xml, "type", channel.type);
    xml += "</channel>\n";
  }
  xml += "</channels>\n";
  if (!info.notes.empty()) add(xml, "notes", info.notes);
  return xml + "</desc>\n</info>\n";
}

}  // namespace condyle::host::lsl
