// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <zlib.h>

#include <cstdint>
#include <span>

namespace condyle::hal {

/// CRC-32 (IEEE 802.3, as in MCAP) of earlier bytes followed by `bytes`; `crc` is that of the
/// earlier bytes.
inline std::uint32_t extend_crc(std::uint32_t crc, std::span<const std::uint8_t> bytes) {
  // zlib would restart at a null pointer, which an empty span may have.
  return bytes.empty() ? crc : static_cast<std::uint32_t>(crc32_z(crc, bytes.data(), bytes.size()));
}

}  // namespace condyle::hal
