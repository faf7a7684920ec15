// SPDX-License-Identifier: Apache-2.0
#include "report/packed_values.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

namespace condyle::host {
namespace {

std::string base64(const std::string& bytes) {
  constexpr const char* kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t j = 0; j < 3; ++j) {
      group = group << 8U | (i + j < bytes.size() ? static_cast<unsigned char>(bytes[i + j]) : 0U);
    }
    for (std::size_t j = 0; j < 4; ++j) {
      text += i + j > bytes.size() ? '=' : kDigits[group >> (18U - 6U * j) & 63U];
    }
  }
  return text;
}

void add_little_endian(std::string& bytes, std::uint32_t value, int count) {
  for (int i = 0; i < count; ++i) bytes += static_cast<char>(value >> (8 * i) & 0xffU);
}

}  // namespace

std::string packed_times(const std::vector<double>& values) {
  std::string bytes;
  for (const double value : values) {
    add_little_endian(bytes, std::bit_cast<std::uint32_t>(static_cast<float>(value)), 4);
  }
  return base64(bytes);
}

nlohmann::ordered_json packed_values(const std::vector<double>& values) {
  constexpr double kSteps = 65534;
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const double value : values) {
    if (!std::isfinite(value)) continue;
    low = std::min(low, value);
    high = std::max(high, value);
  }
  const bool has_any = low <= high;
  const double step = has_any && high > low ? (high - low) / kSteps : 1;
  std::string bytes;
  for (const double value : values) {
    const double k = std::isfinite(value) ? 1 + std::round((value - low) / step) : 0;
    add_little_endian(bytes, static_cast<std::uint32_t>(k) ^ 0x8000U, 2);
  }
  return {{"low", has_any ? low - step : 0}, {"step", step}, {"data", base64(bytes)}};
}

}  // namespace condyle::host
