// SPDX-License-Identifier: Apache-2.0
// The notation of sources of reports and samples, in every command and in the box's configuration.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace condyle::host {

/// Kinds of sources.
enum class SourceKind : std::uint8_t {
  hid,    ///< a device through the kernel's driver; FILE is its profile
  usb,    ///< a device through libusb; FILE is its profile
  file,   ///< FILE is a recording
  synth,  ///< a synthetic device that chews endlessly; FILE is its profile
  sim,    ///< a simulated subject; FILE is a scenario
};

/// A source, written KIND:FILE.
struct SourceSpec {
  SourceKind kind = SourceKind::file;
  std::string file;
};

/// "hid", "usb", "file", "synth" or "sim".
const char* source_kind_name(SourceKind kind);

/// Parses `text`; none if it does not begin with a kind. FILE may be empty.
std::optional<SourceSpec> parse_source(std::string_view text);
/// The same; text without a kind is a file name.
SourceSpec source_of(std::string_view text);

/// The back end for devices of this kind: "hidapi" or "libusb".
const char* backend_of(SourceKind kind);

/// Files that contain a device's reports.
enum class ReportFile : std::uint8_t {
  none,         ///< another format, or no file
  session_log,  ///< MCAP
  capture,      ///< of USB traffic: pcap in both byte orders, with micro- or nanoseconds, or pcapng
};

/// From the first bytes of the file.
ReportFile report_file_of(std::string_view start);
/// From the regular file at `path`; none for anything else. Pipes are not read.
ReportFile report_file_at(const std::string& path);

}  // namespace condyle::host
