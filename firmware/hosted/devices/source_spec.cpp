// SPDX-License-Identifier: Apache-2.0
#include "hosted/devices/source_spec.h"

#include <array>
#include <filesystem>
#include <fstream>

namespace condyle::host {

const char* source_kind_name(SourceKind kind) {
  constexpr std::array<const char*, 5> names = {"hid", "usb", "file", "synth", "sim"};
  return names[static_cast<std::size_t>(kind)];
}

std::optional<SourceSpec> parse_source(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  for (const SourceKind kind :
       {SourceKind::hid, SourceKind::usb, SourceKind::file, SourceKind::synth, SourceKind::sim}) {
    if (text.substr(0, colon) != source_kind_name(kind)) continue;
    return SourceSpec{kind, std::string(text.substr(colon + 1))};
  }
  return std::nullopt;
}

SourceSpec source_of(std::string_view text) {
  return parse_source(text).value_or(SourceSpec{SourceKind::file, std::string(text)});
}

const char* backend_of(SourceKind kind) {
  return kind == SourceKind::usb ? "libusb" : "hidapi";
}

ReportFile report_file_of(std::string_view start) {
  if (start.starts_with("\x89MCAP0\r\n")) return ReportFile::session_log;
  for (const std::string_view magic : {"\xd4\xc3\xb2\xa1", "\xa1\xb2\xc3\xd4", "\x4d\x3c\xb2\xa1",
                                       "\xa1\xb2\x3c\x4d", "\x0a\x0d\x0d\x0a"}) {
    if (start.starts_with(magic)) return ReportFile::capture;
  }
  return ReportFile::none;
}

ReportFile report_file_at(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return ReportFile::none;
  std::array<char, 8> start{};
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), start.size());
  return report_file_of(std::string_view(start.data(), static_cast<std::size_t>(file.gcount())));
}

}  // namespace condyle::host
