// SPDX-License-Identifier: Apache-2.0
#include "inspect/descriptor_text.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <utility>

namespace condyle::host {
namespace {

// Likely usages of a facebow. Source: HID Usage Tables 1.4, sections 3 and 4.
const char* usage_name(std::uint32_t usage) {
  constexpr std::pair<std::uint32_t, const char*> kNames[] = {{0x00010001, "pointer"},
                                                              {0x00010002, "mouse"},
                                                              {0x00010004, "joystick"},
                                                              {0x00010005, "game pad"},
                                                              {0x00010006, "keyboard"},
                                                              {0x00010008, "multi-axis controller"},
                                                              {0x00010030, "X"},
                                                              {0x00010031, "Y"},
                                                              {0x00010032, "Z"},
                                                              {0x00010033, "Rx"},
                                                              {0x00010034, "Ry"},
                                                              {0x00010035, "Rz"},
                                                              {0x00010040, "Vx"},
                                                              {0x00010041, "Vy"},
                                                              {0x00010042, "Vz"},
                                                              {0x00200001, "sensor"},
                                                              {0x00200073, "accelerometer"}};
  for (const auto& [code, name] : kNames) {
    if (code == usage) return name;
  }
  return (usage >> 16U) >= 0xFF00 ? "vendor-defined" : "";
}

}  // namespace

std::string usage_text(const hal::UsageRange& range) {
  std::string text = fmt::format("{:04X}:{:04X}", range.first >> 16U, range.first & 0xFFFFU);
  if (range.last != range.first) text += fmt::format("-{:04X}", range.last & 0xFFFFU);
  const std::string name = usage_name(range.first);
  return name.empty() ? text : name + " (" + text + ")";
}

namespace {

std::string usages_text(const hal::DescriptorField& field) {
  constexpr std::size_t kShown = 4;
  if (field.is_constant()) return "padding";
  if (field.usages.empty()) return "no usage";
  std::string text;
  for (std::size_t i = 0; i < field.usages.size() && i < kShown; ++i) {
    text += (i > 0 ? ", " : "") + usage_text(field.usages[i]);
  }
  if (field.usages.size() > kShown) {
    text += fmt::format(" and {} more", field.usages.size() - kShown);
  }
  return text;
}

std::string field_text(const hal::DescriptorField& field) {
  std::string text = fmt::format("  bit {:>5}  {:>4} x {:<3} bits  ", field.offset_bits,
                                 field.count, field.width_bits);
  text += usages_text(field);
  if (field.is_constant()) return text + '\n';
  text += fmt::format("; {}{}{} to {}", field.is_variable() ? "" : "array, ",
                      field.is_relative() ? "relative, " : "", field.logical_minimum,
                      field.logical_maximum);
  if (field.physical_minimum != field.logical_minimum ||
      field.physical_maximum != field.logical_maximum) {
    text += fmt::format(", physical {} to {}", field.physical_minimum, field.physical_maximum);
  }
  if (field.unit.scale) {
    text += fmt::format(", {:.6g} {} a count", *field.unit.scale, field.unit.text);
    if (*field.unit.offset != 0) text += fmt::format(", {:+.6g} at 0", *field.unit.offset);
  }
  return text + '\n';
}

// Every JSON reader can represent these values, and distinguish an absent value from 0.
nlohmann::ordered_json field_json(const hal::DescriptorField& field) {
  auto usages = nlohmann::ordered_json::array();
  for (const hal::UsageRange& range : field.usages) {
    usages.push_back({{"page", range.first >> 16U},
                      {"id", range.first & 0xFFFFU},
                      {"last_id", range.last & 0xFFFFU},
                      {"name", usage_name(range.first)}});
  }
  nlohmann::ordered_json json = {{"usages", usages},
                                 {"bit_offset", field.offset_bits},
                                 {"bit_width", field.width_bits},
                                 {"count", field.count},
                                 {"is_constant", field.is_constant()},
                                 {"is_variable", field.is_variable()},
                                 {"is_relative", field.is_relative()},
                                 {"is_signed", field.is_signed()},
                                 {"logical_minimum", field.logical_minimum},
                                 {"logical_maximum", field.logical_maximum},
                                 {"physical_minimum", field.physical_minimum},
                                 {"physical_maximum", field.physical_maximum},
                                 {"unit_code", field.unit.code},
                                 {"unit_exponent", field.unit.exponent},
                                 {"unit_SI", field.unit.text},
                                 {"scale_SI", nullptr},
                                 {"offset_SI", nullptr}};
  if (field.unit.scale) json["scale_SI"] = *field.unit.scale;
  if (field.unit.offset) json["offset_SI"] = *field.unit.offset;
  return json;
}

}  // namespace

std::string descriptor_text(const hal::ReportDescriptor& descriptor) {
  std::string text;
  for (const hal::UsageRange& usage : descriptor.applications) {
    text += "application " + usage_text(usage) + '\n';
  }
  for (const hal::DescribedReport& report : descriptor.reports) {
    const std::string id = report.id ? fmt::format("report {}", *report.id) : "unnumbered report";
    text += fmt::format("{}, {}, {} bits ({} bytes{})\n", id, hal::direction_name(report.direction),
                        report.size_bits, (report.size_bits + 7) / 8,
                        report.id ? ", the first is the report number" : "");
    for (const hal::DescriptorField& field : report.fields) text += field_text(field);
  }
  for (const std::string& note : descriptor.notes) text += "note: " + note + '\n';
  return text;
}

std::string descriptor_json(const hal::ReportDescriptor& descriptor) {
  auto reports = nlohmann::ordered_json::array();
  for (const hal::DescribedReport& report : descriptor.reports) {
    auto fields = nlohmann::ordered_json::array();
    for (const hal::DescriptorField& field : report.fields) fields.push_back(field_json(field));
    reports.push_back({{"id", report.id.value_or(0)},
                       {"direction", hal::direction_name(report.direction)},
                       {"size_bits", report.size_bits},
                       {"fields", std::move(fields)}});
  }
  const nlohmann::ordered_json json = {{"reports", std::move(reports)},
                                       {"notes", descriptor.notes}};
  return json.dump(2) + '\n';
}

}  // namespace condyle::host
