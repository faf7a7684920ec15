// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "condyle/hal/log/mcap_format.h"
#include "condyle/hal/status.h"

struct ZSTD_DCtx_s;

namespace condyle::hal {

/// Limits of a reader. Memory stays below the sum of both sizes, whatever a file declares.
struct McapLimits {
  std::size_t record_bytes = std::size_t{16} << 20;  ///< a record that is not a chunk
  std::size_t chunk_bytes = std::size_t{64} << 20;   ///< a chunk, uncompressed
  /// Requires every checksum; refuses unknown records and messages outside chunks. A changed bit
  /// anywhere in the file is then noticed.
  bool is_strict = false;
};

/// A record of the data section; its views live until the next call of next().
using McapRecord =
    std::variant<McapHeader, McapSchema, McapChannel, McapMessage, McapAttachment, McapMetadata>;

/// Result of reading on.
enum class [[nodiscard]] McapRead : std::uint8_t{
    record,     ///< the record is there
    end,        ///< the file ended correctly, all checksums right
    truncated,  ///< the file is cut off, see problem(); all earlier records were given
    damaged,    ///< the file is damaged, see problem(); nothing after it is given
};

/// What is wrong with a file, and where.
struct McapProblem {
  std::uint64_t byte_offset = 0;
  std::string reason;
};

/// Reads an MCAP file from start to end, one chunk in memory at a time.
class McapReader {
 public:
  explicit McapReader(McapLimits limits = {});
  ~McapReader();
  McapReader(const McapReader&) = delete;
  McapReader& operator=(const McapReader&) = delete;

  /// Opens a regular file and checks its first bytes: ok, not_found, not_permitted or bad_report
  /// (problem() gives the reason). An open reader is closed first.
  Status open(const std::string& path);
  void close();

  /// Next record of the data section in file order, those inside chunks included. After anything
  /// but `record` the result stays the same. Allocates only for channels and metadata.
  McapRead next(McapRecord& record);

  const McapProblem& problem() const { return problem_; }
  std::uint64_t size_bytes() const { return size_; }
  /// Bytes up to the end of the last whole record outside chunks.
  std::uint64_t sound_bytes() const { return sound_; }

 private:
  using ByteSpan = std::span<const std::uint8_t>;
  enum class Step : std::uint8_t { record, skip, stop };

  Step stop(McapRead outcome, std::uint64_t byte_offset, std::string reason);
  Step damaged(std::string reason) {
    return stop(McapRead::damaged, record_start_, std::move(reason));
  }
  Step cut_off(std::string reason);
  Step read_head(McapOpcode& opcode, std::uint64_t& length);
  Step next_in_file(McapRecord& record);
  Step next_in_chunk(McapRecord& record);
  Step take(McapOpcode opcode, ByteSpan content, McapRecord& record);
  Step take_chunk(ByteSpan content);
  Step take_attachment(ByteSpan content, McapRecord& record);
  Step take_data_end(ByteSpan content);
  Step take_footer(ByteSpan content);
  bool rest_is_zero();
  bool is_right(std::uint32_t stored_crc, std::uint32_t crc) const;

  McapLimits limits_;
  std::unique_ptr<ZSTD_DCtx_s, std::size_t (*)(ZSTD_DCtx_s*)> zstd_;
  std::unique_ptr<std::FILE, int (*)(std::FILE*)> file_;
  std::uint64_t size_ = 0, sound_ = 0, record_start_ = 0, summary_start_ = 0;
  std::uint32_t data_crc_ = 0, summary_crc_ = 0;
  bool ends_with_magic_ = false, has_header_ = false, is_in_summary_ = false;
  std::vector<std::uint8_t> content_, chunk_;
  ByteSpan chunk_rest_;
  McapRead outcome_ = McapRead::end;
  McapProblem problem_;
};

}  // namespace condyle::hal
