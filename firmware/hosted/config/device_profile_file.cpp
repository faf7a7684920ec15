// SPDX-License-Identifier: Apache-2.0
#include "hosted/config/device_profile_file.h"

#include <algorithm>

#include <fmt/format.h>

#include <limits>

#include "condyle/hal/hid/profile_check.h"
#include "condyle/hal/report/raw_report.h"
#include "hosted/config/profile_coordinates.h"
#include "hosted/config/profile_field_reader.h"
#include "hosted/files/number_text.h"

namespace condyle::host {
namespace {

const std::vector<ProfileUnit> kTimeUnits = {
    {"s", "s", 1}, {"ms", "s", 1e3}, {"us", "s", 1e6}, {"ns", "s", 1e9}};
const std::vector<ProfileUnit> kForceUnits = {{"N", "N", 1}, {"mN", "N", 1e3}};
const std::vector<ProfileUnit> kAuxiliaryUnits = {
    {"N", "N", 1},    {"mN", "N", 1e3}, {"V", "V", 1},    {"mV", "V", 1e3},
    {"uV", "V", 1e6}, {"m", "m", 1},    {"mm", "m", 1e3}, {"um", "m", 1e6},
    {"s", "s", 1},    {"ms", "s", 1e3}, {"us", "s", 1e6}, {"1", "1", 1}};
constexpr Range kRate_Hz{0.01, 1e5};
constexpr std::int64_t kMostCounts = std::numeric_limits<std::int64_t>::max();

// Section of each part, to locate a problem.
std::string section_of(const hal::ProfileProblem& problem, const hal::DeviceProfile& profile,
                       const CoordinateSections& coordinates) {
  switch (problem.part) {
    case hal::ProfilePart::rate:
      return "rate_Hz";
    case hal::ProfilePart::minimum_size:
      return "report.minimum_size_bytes";
    case hal::ProfilePart::coordinates:
      return problem.index < coordinates.size() ? coordinates[problem.index] : "coordinates";
    case hal::ProfilePart::device_time:
      return "device_time";
    case hal::ProfilePart::sequence:
      return "sequence";
    case hal::ProfilePart::checksum:
      return "checksum";
    case hal::ProfilePart::drive:
      return "drive";
    case hal::ProfilePart::auxiliary:
      return problem.index < profile.auxiliary.size()
                 ? "auxiliary." + profile.auxiliary[problem.index].name
                 : "auxiliary";
  }
  return "";
}

class ProfileReader {
 public:
  explicit ProfileReader(TomlReader& file) : file_(file), fields_(file) {}

  hal::DeviceProfile read() {
    read_identity();
    read_report();
    const bool is_companion =
        !fields_.is_there("coordinates") &&
        (fields_.is_there("drive") || !file_.sections_in("auxiliary").empty());
    CoordinateSections coordinates;
    if (!is_companion) coordinates = read_coordinates(file_, fields_, plain_, profile_);
    fields_.require(profile_.minimum_size_bytes > 0 || profile_.descriptor_axes, "report",
                    "minimum_size_bytes", "give the size of a whole report");
    read_counting("device_time", kTimeUnits, profile_.device_time);
    read_counting("sequence", {}, profile_.sequence);
    read_checksum();
    read_drive();
    read_auxiliary();
    file_.finish();
    fields_.finish();
    if (const auto problem = hal::find_problem(profile_)) {
      throw InputError(fields_.place_of(section_of(*problem, profile_, coordinates)),
                       problem->reason, problem->mend);
    }
    return profile_;
  }

 private:
  template <class Value>
  bool read_integer(const std::string& section, const char* key, Value& value, std::int64_t lowest,
                    std::int64_t highest) {
    auto number = static_cast<std::int64_t>(value);
    const bool is_given = file_.integer(section, key, number, lowest, highest);
    value = static_cast<Value>(number);
    return is_given;
  }

  void read_identity() {
    file_.text("", "name", profile_.name);
    const bool is_plain = std::none_of(profile_.name.begin(), profile_.name.end(), [](char c) {
      return static_cast<unsigned char>(c) < 0x20 || c == 0x7F;
    });
    fields_.require(!profile_.name.empty(), "", "name", "name the device");
    fields_.require(is_plain, "", "name",
                    "leave out control characters: the name is shown on terminals");
    const bool has_vendor = read_integer("", "vendor_id", profile_.vendor_id, 0, 0xFFFF);
    const bool has_product = read_integer("", "product_id", profile_.product_id, 0, 0xFFFF);
    fields_.require(has_vendor, "", "vendor_id", "run condyle inspect to list the devices");
    fields_.require(has_product, "", "product_id", "run condyle inspect to list the devices");
    read_integer("", "interface_number", profile_.interface_number, 0, 255);
    file_.number("", "rate_Hz", profile_.rate_Hz, "Hz", kRate_Hz);
    file_.boolean("", "restarts_on_reconnect", profile_.restarts_on_reconnect);
  }

  void read_report() {
    std::uint8_t id = 0;
    if (read_integer("report", "id", id, 1, 255)) profile_.report_id = id;
    read_integer("report", "minimum_size_bytes", profile_.minimum_size_bytes, 1,
                 std::int64_t{hal::kMaxReportSize});
    std::size_t order = 0;
    file_.choice("report", "byte_order", order, {"little", "big"});
    plain_.field.byte_order = order == 0 ? hal::ByteOrder::little : hal::ByteOrder::big;
  }

  // Place of a count, which has no type to choose.
  FieldText read_count(const std::string& section) {
    FieldText text = plain_;
    text.field.type = hal::FieldType::unsigned_integer;
    text.has_type = true;
    fields_.read_place(section, text);
    return text;
  }

  void read_counting(const std::string& section, const std::vector<ProfileUnit>& units,
                     std::optional<hal::CountingField>& counting) {
    FieldText text = read_count(section);
    if (!units.empty()) fields_.read_scale(section, text, units);
    std::uint64_t wraps_at = 0;
    read_integer(section, "wraps_at", wraps_at, 2, kMostCounts);
    if (!fields_.is_there(section)) return;
    fields_.require_field(section, text, !units.empty());
    counting = {text.in_si(), wraps_at};
  }

  void read_checksum() {
    const FieldText text = read_count("checksum");
    hal::Checksum sum;
    sum.field = text.in_si();
    sum.width_bits = text.field.width_bits;
    constexpr std::int64_t most = 0xFFFF, last = std::int64_t{hal::kMaxReportSize} - 1;
    std::size_t last_byte = 0;
    const bool has_polynomial = read_integer("checksum", "polynomial", sum.polynomial, 1, most);
    read_integer("checksum", "initial", sum.initial, 0, most);
    file_.boolean("checksum", "reflects_input", sum.reflects_input);
    file_.boolean("checksum", "reflects_output", sum.reflects_output);
    read_integer("checksum", "final_xor", sum.final_xor, 0, most);
    read_integer("checksum", "first_byte", sum.first_byte, 0, last);
    const bool has_last = read_integer("checksum", "last_byte", last_byte, 0, last);
    sum.end_byte = last_byte + 1;
    if (!fields_.is_there("checksum")) return;
    fields_.require_field("checksum", text, false);
    fields_.require(has_polynomial, "checksum", "polynomial",
                    "give it without its top bit: 0x1021 for CRC-16/CCITT");
    fields_.require(has_last, "checksum", "last_byte",
                    "give the last byte that the checksum covers");
    profile_.checksum = sum;
  }

  hal::ReportField read_measured(const std::string& section, const std::vector<ProfileUnit>& units,
                                 std::string& unit) {
    FieldText text = plain_;
    fields_.read_place(section, text);
    fields_.read_scale(section, text, units);
    fields_.read_value(section, text);
    if (fields_.is_there(section)) fields_.require_field(section, text, true);
    if (text.unit != nullptr) unit = text.unit->si;
    return text.in_si();
  }

  void read_drive() {
    std::string unit;
    const hal::ReportField drive = read_measured("drive", kForceUnits, unit);
    if (fields_.is_there("drive")) profile_.drive_N = drive;
  }

  void read_auxiliary() {
    for (const std::string& name : file_.sections_in("auxiliary")) {
      if (name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") != std::string::npos) {
        throw InputError(file_.place("auxiliary", name), fmt::format("name {}", quote(name)),
                         "use a to z, 0 to 9 and _ in the names of auxiliary fields");
      }
      hal::AuxiliaryField auxiliary;
      auxiliary.name = name;
      auxiliary.field = read_measured("auxiliary." + name, kAuxiliaryUnits, auxiliary.unit);
      profile_.auxiliary.push_back(auxiliary);
    }
  }

  TomlReader& file_;
  ProfileFieldReader fields_;
  FieldText plain_;  // the defaults of every field
  hal::DeviceProfile profile_;
};

}  // namespace

hal::DeviceProfile load_device_profile(const std::string& path) {
  TomlReader file(path);
  return ProfileReader(file).read();
}

hal::DeviceProfile parse_device_profile(const std::string& name, std::string_view text) {
  TomlReader file(name, text);
  return ProfileReader(file).read();
}

}  // namespace condyle::host
