// SPDX-License-Identifier: Apache-2.0
#include "box/configuration.h"

#include <arpa/inet.h>
#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

#include "condyle/hal/link/serial_port.h"
#include "condyle/hal/log/session_log.h"
#include "hosted/config/parameter_file.h"
#include "hosted/files/input_error.h"
#include "hosted/files/text_file.h"
#include "hosted/files/toml_reader.h"
#include "hosted/lsl/estimate_stream.h"
#include "hosted/lsl/stream_search.h"

namespace condyle::box {
namespace {

using host::InputError;
using host::TomlReader;

constexpr std::size_t kShortestToken = 16, kLongestToken = 256;
constexpr int kMostLag = 16;

// inet_pton stops at a NUL and accepts the text before it.
bool read_address(int family, const std::string& text, void* address) {
  return text.find('\0') == std::string::npos && inet_pton(family, text.c_str(), address) == 1;
}

bool is_address(const std::string& text) {
  in_addr v4{};
  in6_addr v6{};
  return read_address(AF_INET, text, &v4) || read_address(AF_INET6, text, &v6);
}

class Reader {
 public:
  explicit Reader(const std::string& path)
      : toml_(path), folder_(std::filesystem::path(path).parent_path()) {}

  Configuration read() {
    read_source("facebow", result_.facebow);
    result_.facebow.name = "facebow";
    std::int64_t point = result_.followed.point;
    toml_.integer("facebow", "point", point, 1, 3);
    result_.followed.point = static_cast<int>(point);
    auto axis = static_cast<std::size_t>(result_.followed.axis);
    toml_.choice("facebow", "axis", axis, {"x", "y", "z"});
    result_.followed.axis = static_cast<Axis>(axis);
    read_companions();
    read_estimator();
    read_pose();
    read_cycles();
    read_recording();
    read_udp();
    read_lsl();
    read_http();
    toml_.finish();
    return result_;
  }

 private:
  std::string file(const std::string& name) const {
    return name.empty() ? name : (folder_ / name).lexically_normal().string();
  }

  void read_source(const std::string& section, SourceSettings& source) {
    std::string text;
    if (!toml_.text(section, "source", text)) {
      throw InputError(toml_.place(section, "source"), section + " has no source",
                       "give one, such as source = \"hid:facebow.toml\"");
    }
    using Kind = SourceSettings::Kind;
    if ((source.stream = host::parse_stream(text))) return read_stream(section, source);
    const bool has_colon = text.find(':') != std::string::npos;
    const auto spec = host::parse_source(has_colon ? text : text + ":");
    if (!spec || spec->kind == Kind::sim) {
      throw InputError(toml_.place(section, "source"), "\"" + text + "\" is not a source",
                       "write hid:PROFILE, usb:PROFILE, file:LOG, synth:PROFILE or lsl:NAME");
    }
    if (spec->file.empty()) {
      throw InputError(toml_.place(section, "source"),
                       "\"" + text + "\" does not name a file or stream",
                       "write it after the colon");
    }
    source.kind = spec->kind;
    source.file = file(spec->file);
    toml_.text(section, "serial", source.serial);
    if (!source.serial.empty() && (source.kind == Kind::file || source.kind == Kind::synth)) {
      throw InputError(toml_.place(section, "serial"), "only devices have a serial number",
                       "leave it out");
    }
  }

  void read_stream(const std::string& section, SourceSettings& source) {
    (void)host::lsl::parse_stream_place(source.stream->place);
    host::lsl::StreamChoice& choice = source.stream->choice;
    std::string channels;
    if (toml_.text(section, "channels", channels)) {
      choice.channels = host::lsl::split_channels(channels);
    }
    std::size_t unit = 0;
    if (toml_.choice(section, "unit", unit, {"m", "cm", "mm", "um"})) {
      choice.unit = std::array{"m", "cm", "mm", "um"}[unit];
    }
  }

  void read_companions() {
    for (const std::string& name : toml_.sections_in("companion")) {
      if (!hal::is_subject_code(name) || name.empty() || name == "facebow" ||
          name == hal::kMarkerSource) {
        throw InputError(
            toml_.place("companion", name), "\"" + name + "\" is not a valid companion name",
            "use at most 32 letters, digits, - and _; facebow and markers are reserved");
      }
      SourceSettings companion;
      companion.name = name;
      read_source("companion." + name, companion);
      if (companion.stream || (companion.kind != SourceSettings::Kind::hid &&
                               companion.kind != SourceSettings::Kind::usb)) {
        throw InputError(toml_.place("companion." + name, "source"), "a companion must be a device",
                         "use hid: or usb:");
      }
      result_.companions.push_back(companion);
    }
    // Facebow and markers need a place in the log too.
    if (result_.companions.size() > 6) {
      throw InputError(toml_.place("companion", ""), "too many companions", "give at most 6");
    }
  }

  void read_estimator() {
    std::string parameters;
    if (toml_.text("estimator", "parameters", parameters) && !parameters.empty()) {
      const std::string path = file(parameters);
      result_.parameters_toml = host::read_text_file(path);
      result_.parameters = host::parse_recommended_parameters(path, result_.parameters_toml);
    }
    std::int64_t lag = 0, priority = result_.priority;
    toml_.integer("estimator", "lag_samples", lag, 0, kMostLag);
    toml_.integer("estimator", "priority", priority, 0, 98);
    result_.lag = static_cast<int>(lag);
    result_.priority = static_cast<int>(priority);
    read_node();
  }

  void read_pose() {
    bool is_wanted = false;
    toml_.boolean("pose", "estimate", is_wanted);
    host::PoseChoice choice;
    auto axis = static_cast<std::size_t>(choice.twist_axis);
    toml_.choice("pose", "twist_axis", axis, {"x", "y", "z"});
    choice.twist_axis = static_cast<Axis>(axis);
    for (const std::string& name : toml_.sections_in("jaw_point")) {
      const std::string section = "jaw_point." + name;
      double position_mm[3] = {};
      if (!toml_.numbers(section, "position_mm", position_mm, 3, "mm", {-1000, 1000})) {
        throw InputError(toml_.place("jaw_point", name), section + " has no position",
                         "give one, such as position_mm = [0, 80, -30]");
      }
      choice.add_point(toml_.place("jaw_point", name),
                       {name, 1e-3 * Eigen::Map<const Eigen::Vector3d>(position_mm)});
    }
    if (!is_wanted) {
      if (choice.points.empty()) return;
      throw InputError(toml_.place("jaw_point", choice.points.front().name),
                       "a point of the jaw needs the pose", "write estimate = true in [pose]");
    }
    if (!result_.node.empty()) {
      throw InputError(toml_.place("pose", "estimate"),
                       "a microcontroller does not estimate the pose",
                       "leave out estimate, or node in [estimator]");
    }
    result_.pose = choice;
  }

  void read_cycles() {
    bool is_wanted = false;
    toml_.boolean("cycles", "find", is_wanted);
    std::size_t closing = 0;
    toml_.choice("cycles", "closing", closing, {"positive", "negative"});
    if (is_wanted)
      result_.cycles = {.followed = result_.followed.axis, .closes_upward = closing == 0};
  }

  void read_node() {
    std::string node;
    toml_.text("estimator", "node", node);
    std::int64_t baud = result_.node_baud;
    double late_ms = seconds(result_.node_late_ns) * 1e3;
    const std::vector<unsigned> rates = hal::SerialPort::rates();
    toml_.integer("estimator", "node_baud", baud, rates.front(), rates.back());
    if (std::find(rates.begin(), rates.end(), static_cast<unsigned>(baud)) == rates.end()) {
      throw InputError(toml_.place("estimator", "node_baud"),
                       fmt::format("serial ports do not support {} baud", baud),
                       fmt::format("give one of {}", fmt::join(rates, ", ")));
    }
    toml_.number("estimator", "node_late_ms", late_ms, "ms", {1, 60'000});
    result_.node_baud = static_cast<unsigned>(baud);
    result_.node_late_ns = nanoseconds(late_ms * 1e-3);
    if (node.empty()) return;
    const std::size_t colon = node.find(':');
    const std::string kind = node.substr(0, colon);
    if ((kind != "serial" && kind != "unix") || colon + 1 >= node.size()) {
      throw InputError(toml_.place("estimator", "node"),
                       "\"" + node + "\" is not a line to a microcontroller",
                       "write serial:DEVICE, such as serial:/dev/ttyACM0, or unix:SOCKET");
    }
    const std::string name = file(node.substr(colon + 1));
    result_.node = kind == "unix" ? "unix:" + name : name;
  }

  void read_recording() {
    std::string folder;
    if (toml_.text("recording", "folder", folder)) result_.folder = file(folder);
    double reserve_MB = static_cast<double>(result_.reserve_bytes) * 1e-6;
    toml_.number("recording", "reserve_MB", reserve_MB, "MB", {1, 1e7});
    result_.reserve_bytes = static_cast<std::uint64_t>(reserve_MB * 1e6);
  }

  void read_address(const std::string& section, std::string& address) {
    if (toml_.text(section, "address", address) && !is_address(address)) {
      throw InputError(toml_.place(section, "address"),
                       "\"" + address + "\" is not a numeric address",
                       "write an address such as 127.0.0.1 or ::1");
    }
  }

  void read_port(const std::string& section, std::uint16_t& port) {
    std::int64_t number = port;
    toml_.integer(section, "port", number, 0, 65535);
    port = static_cast<std::uint16_t>(number);
  }

  void read_udp() {
    read_address("udp", result_.udp_address);
    read_port("udp", result_.udp_port);
  }

  void read_lsl() {
    std::string name, address = "127.0.0.1";
    toml_.text("lsl", "name", name);
    toml_.text("lsl", "address", address);
    if (!host::lsl::parse_ipv4(address)) {
      throw InputError(toml_.place("lsl", "address"),
                       "\"" + address + "\" is not a numeric IPv4 address",
                       "write an address of this computer, such as 127.0.0.1");
    }
    if (name.empty()) return;
    result_.lsl_out = name + "@" + address;
    host::lsl::check_outlet_place(result_.lsl_out);
  }

  void read_http() {
    read_address("http", result_.http_address);
    read_port("http", result_.http_port);
    std::int64_t listeners = result_.most_listeners;
    toml_.integer("http", "most_listeners", listeners, 1, 100);
    result_.most_listeners = static_cast<std::uint16_t>(listeners);
    std::string token_file;
    if (toml_.text("http", "token_file", token_file) && !token_file.empty()) {
      read_token(file(token_file));
    }
    if (result_.token.empty() && !is_loopback(result_.http_address)) {
      throw InputError(toml_.place("http", "address"),
                       "other machines could reach " + result_.http_address + " without a token",
                       "set token_file, or use 127.0.0.1");
    }
  }

  void read_token(const std::string& path) {
    struct stat status {};
    if (stat(path.c_str(), &status) == 0 && (status.st_mode & (S_IRWXO | S_IWGRP)) != 0) {
      throw InputError(path, "other users can read or change the token", "chmod 640 " + path);
    }
    const std::string token = host::read_text_line(path);
    const bool is_printable =
        token.find_first_not_of(
            "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-._~+/=") ==
        std::string::npos;
    if (token.size() < kShortestToken || token.size() > kLongestToken || !is_printable) {
      throw InputError(path, "does not contain a usable token",
                       "write one line of 16 to 256 letters, digits and -._~+/=");
    }
    result_.token = token;
  }

  TomlReader toml_;
  std::filesystem::path folder_;
  Configuration result_;
};

}  // namespace

bool is_loopback(std::string_view address) {
  const std::string text(address);
  in_addr v4{};
  if (read_address(AF_INET, text, &v4)) return (ntohl(v4.s_addr) >> 24U) == 127;
  in6_addr v6{};
  return read_address(AF_INET6, text, &v6) && IN6_IS_ADDR_LOOPBACK(&v6) != 0;
}

Configuration load_configuration(const std::string& path) {
  return Reader(path).read();
}

}  // namespace condyle::box
