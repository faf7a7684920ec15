// SPDX-License-Identifier: Apache-2.0
#include "condyle/hal/log/mcap_reader.h"

#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "log/crc32.h"
#include "log/little_endian.h"
#include "log/mcap_opcode.h"
#include "log/regular_file.h"

namespace condyle::hal {
namespace {

bool is_allowed_in_summary(McapOpcode opcode) {
  switch (opcode) {
    case McapOpcode::schema:
    case McapOpcode::channel:
    case McapOpcode::chunk_index:
    case McapOpcode::attachment_index:
    case McapOpcode::statistics:
    case McapOpcode::metadata_index:
    case McapOpcode::summary_offset:
    case McapOpcode::footer:
      return true;
    default:
      return false;
  }
}

}  // namespace

McapReader::McapReader(McapLimits limits)
    : limits_(limits), zstd_(nullptr, ZSTD_freeDCtx), file_(nullptr, std::fclose) {}

McapReader::~McapReader() = default;

void McapReader::close() {
  file_.reset();
}

Status McapReader::open(const std::string& path) {
  close();
  outcome_ = McapRead::record;
  problem_ = {};
  size_ = sound_ = record_start_ = 0;
  data_crc_ = summary_crc_ = 0;
  has_header_ = is_in_summary_ = false;
  chunk_rest_ = {};
  const auto refuse = [this](Status status, std::string reason) {
    static_cast<void>(stop(McapRead::damaged, 0, std::move(reason)));
    close();
    return status;
  };

  file_.reset(open_without_waiting(path.c_str()));
  if (file_ == nullptr) {
    const int error = errno;
    return refuse(error == ENOENT || error == ENOTDIR ? Status::not_found
                  : error == EACCES || error == EPERM ? Status::not_permitted
                                                      : Status::bad_report,
                  std::strerror(error));
  }
  if (!is_regular_file(file_.get(), size_)) {
    return refuse(Status::bad_report, "it is not a regular file");
  }

  std::array<std::uint8_t, kMcapMagic.size()> magic{};
  const auto tail = static_cast<off_t>(size_ - std::min<std::uint64_t>(size_, magic.size()));
  ends_with_magic_ = fseeko(file_.get(), tail, SEEK_SET) == 0 &&
                     std::fread(magic.data(), 1, magic.size(), file_.get()) == magic.size() &&
                     magic == kMcapMagic && size_ > magic.size();
  std::rewind(file_.get());
  const std::size_t got = std::fread(magic.data(), 1, magic.size(), file_.get());
  if (got < magic.size()) return refuse(Status::bad_report, "it is too short for an MCAP file");
  if (magic != kMcapMagic) {
    auto other_version = kMcapMagic;
    other_version[5] = magic[5];
    return refuse(Status::bad_report, magic == other_version
                                          ? "it is an MCAP file of an unknown version"
                                          : "it is not an MCAP file");
  }
  sound_ = magic.size();
  data_crc_ = extend_crc(0, magic);
  zstd_.reset(ZSTD_createDCtx());
  // All the memory that reading may take; the system assigns the pages on first use.
  content_.reserve(to_size(std::min<std::uint64_t>(
      size_, std::max(limits_.record_bytes, ZSTD_compressBound(limits_.chunk_bytes) + 64))));
  chunk_.reserve(limits_.chunk_bytes);
  return Status::ok;
}

McapReader::Step McapReader::stop(McapRead outcome, std::uint64_t byte_offset, std::string reason) {
  outcome_ = outcome;
  problem_ = {byte_offset, std::move(reason)};
  return Step::stop;
}

// The bytes end too early: the file was cut, unless its end is there.
McapReader::Step McapReader::cut_off(std::string reason) {
  return stop(ends_with_magic_ ? McapRead::damaged : McapRead::truncated, record_start_,
              std::move(reason));
}

McapRead McapReader::next(McapRecord& record) {
  while (outcome_ == McapRead::record && file_ != nullptr) {
    const Step step = chunk_rest_.empty() ? next_in_file(record) : next_in_chunk(record);
    if (step == Step::record) return McapRead::record;
  }
  return outcome_;
}

McapReader::Step McapReader::read_head(McapOpcode& opcode, std::uint64_t& length) {
  record_start_ = sound_;
  if (size_ - sound_ < kMcapRecordHead) {
    return cut_off(size_ == sound_ ? "the file ends without its last records"
                                   : "the file ends within a record");
  }
  std::array<std::uint8_t, kMcapRecordHead> head{};
  if (std::fread(head.data(), 1, head.size(), file_.get()) != head.size()) {
    return stop(McapRead::damaged, record_start_, "the file cannot be read any further");
  }
  opcode = static_cast<McapOpcode>(head[0]);
  ByteParser parser(ByteSpan(head).subspan(1));
  length = parser.number<std::uint64_t>();
  if (head[0] == 0 && length == 0 && rest_is_zero()) {
    return cut_off("the rest of the file is zeros, as after a power cut");
  }
  if (head[0] == 0 || (limits_.is_strict && !is_known(opcode))) {
    return damaged("no record starts with the byte " + number_text(opcode));
  }
  const bool is_chunk = opcode == McapOpcode::chunk;
  const std::uint64_t limit =
      is_chunk ? ZSTD_compressBound(limits_.chunk_bytes) + 64 : limits_.record_bytes;
  if (length > limit) {
    return damaged("a record claims " + std::to_string(length) + " bytes, more than the " +
                   std::to_string(limit) + " that are accepted");
  }
  if (length > size_ - sound_ - kMcapRecordHead) {
    return cut_off("a record of " + std::to_string(length) + " bytes is incomplete");
  }
  content_.resize(to_size(length));
  if (std::fread(content_.data(), 1, content_.size(), file_.get()) != content_.size()) {
    return stop(McapRead::damaged, record_start_, "the file cannot be read any further");
  }
  std::uint32_t& crc = is_in_summary_ ? summary_crc_ : data_crc_;
  if (opcode != McapOpcode::data_end) crc = extend_crc(crc, head);
  return Step::record;
}

McapReader::Step McapReader::next_in_file(McapRecord& record) {
  McapOpcode opcode{};
  std::uint64_t length = 0;
  const Step step = read_head(opcode, length);
  if (step == Step::stop) return step;
  if (!has_header_ && opcode != McapOpcode::header)
    return damaged("the first record is not a header");
  if (is_in_summary_ && !is_allowed_in_summary(opcode) && is_known(opcode)) {
    return damaged("a record of kind " + number_text(opcode) + " is not allowed in the summary");
  }
  if (opcode == McapOpcode::footer) return take_footer(content_);
  if (opcode == McapOpcode::data_end) return take_data_end(content_);

  std::uint32_t& crc = is_in_summary_ ? summary_crc_ : data_crc_;
  crc = extend_crc(crc, content_);
  const Step taken = is_in_summary_ ? Step::skip : take(opcode, content_, record);
  if (taken != Step::stop) sound_ += kMcapRecordHead + length;
  return taken;
}

McapReader::Step McapReader::take_data_end(ByteSpan content) {
  ByteParser parser(content);
  const auto stored_crc = parser.number<std::uint32_t>();
  if (is_in_summary_ || content.size() != 4) return damaged("a misplaced end of the data");
  if (!is_right(stored_crc, data_crc_)) return damaged("the checksum of all the data is wrong");
  is_in_summary_ = true;
  sound_ += kMcapRecordHead + content.size();
  summary_start_ = sound_;
  return Step::skip;
}

McapReader::Step McapReader::take_footer(ByteSpan content) {
  ByteParser parser(content);
  const auto summary_start = parser.number<std::uint64_t>();
  const auto offsets_start = parser.number<std::uint64_t>();
  const auto stored_crc = parser.number<std::uint32_t>();
  if (content.size() != 20) return damaged("the footer has the wrong size");
  if (!is_in_summary_ && limits_.is_strict) return damaged("the end of the data is not marked");
  if (is_in_summary_) {
    const bool is_empty = summary_start_ == record_start_;
    if (summary_start != (is_empty ? 0 : summary_start_) ||
        (offsets_start != 0 && (offsets_start < summary_start_ || offsets_start > record_start_))) {
      return damaged("the footer points to the wrong place");
    }
    if (!is_right(stored_crc, extend_crc(summary_crc_, content.first(16)))) {
      return damaged("the checksum of the summary is wrong");
    }
  }
  const std::uint64_t end = record_start_ + kMcapRecordHead + content.size() + kMcapMagic.size();
  if (end > size_ && !ends_with_magic_) return cut_off("the file ends within its last bytes");
  if (end != size_ || !ends_with_magic_) return damaged("the file does not end after its footer");
  sound_ = size_;
  return stop(McapRead::end, size_, "");
}

// True if only zeros follow in the file.
bool McapReader::rest_is_zero() {
  std::array<std::uint8_t, 65536> block{};
  while (const std::size_t got = std::fread(block.data(), 1, block.size(), file_.get())) {
    if (std::any_of(block.begin(), block.begin() + static_cast<std::ptrdiff_t>(got),
                    [](std::uint8_t byte) { return byte != 0; })) {
      return false;
    }
  }
  return true;
}

}  // namespace condyle::hal
