// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <zlib.h>

#include <cstdint>
#include <span>

namespace condyle::hal {

/// CRC-32 (IEEE 802.3, as MCAP uses it) of some bytes and then `bytes`; `crc` is that of the
/// former.
inline std::uint32_t extend_crc(std::uint32_t crc, std::span<const std::uint8_t> bytes) {
  // zlib would start anew at a null pointer, which an empty span may have.
  return bytes.empty() ? crc : static_cast<std::uint32_t>(crc32_z(crc, bytes.data(), bytes.size()));
}

}  // namespace condyle::hal
