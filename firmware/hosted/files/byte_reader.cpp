// SPDX-License-Identifier: Apache-2.0
#include "hosted/files/byte_reader.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

void refuse_directory(const std::string& path) {
  std::error_code missing;
  if (std::filesystem::is_directory(path, missing)) {
    throw InputError(path, "is a directory", "name a file inside it");
  }
}

}  // namespace

ByteReader::ByteReader(const std::string& path)
    : path_(path), buffer_(std::make_unique_for_overwrite<char[]>(kBufferSize)) {
  file_.reset(std::fopen(path.c_str(), "rb"));
  if (!file_) {
    const std::string problem = std::strerror(errno);
    refuse_directory(path);  // Windows opens none
    throw InputError(path, fmt::format("cannot be opened: {}", problem),
                     "check the name and that you may read it");
  }
  std::setvbuf(file_.get(), nullptr, _IONBF, 0);  // this class buffers
  struct stat status = {};
  if (fstat(fileno(file_.get()), &status) == 0) {
    if (S_ISDIR(status.st_mode)) refuse_directory(path);
    if (S_ISREG(status.st_mode)) size_ = static_cast<std::uint64_t>(status.st_size);
  }
}

void ByteReader::fill(std::size_t wanted) {
  if (end_ - begin_ >= wanted || at_end_) return;
  std::memmove(buffer_.get(), buffer_.get() + begin_, end_ - begin_);
  end_ -= begin_;
  begin_ = 0;
  while (end_ < wanted && !at_end_) {
    if (encoding_ != Encoding::bytes) {
      fill_from_utf16();
      continue;
    }
    const std::size_t got = read_into(buffer_.get() + end_, kBufferSize - end_);
    at_end_ = got == 0;
    end_ += got;
  }
}

std::size_t ByteReader::read_into(char* to, std::size_t count) {
  const std::size_t got = std::fread(to, 1, count, file_.get());
  if (got == 0 && std::ferror(file_.get())) {
    throw InputError(path_, fmt::format("cannot be read: {}", std::strerror(errno)),
                     "check the disk or copy the file");
  }
  return got;
}

void ByteReader::decode_utf16(bool is_big_endian) {
  encoding_ = is_big_endian ? Encoding::utf16_big : Encoding::utf16_little;
  undecoded_.assign(buffer_.get() + begin_, end_ - begin_);
  begin_ = end_ = 0;
  at_end_ = false;
  size_ /= 2;  // most characters of a table are ASCII
}

// Appends characters to the buffer, which has room for three bytes from each two.
void ByteReader::fill_from_utf16() {
  constexpr std::size_t kPart = std::size_t{1} << 18;
  if (undecoded_.size() < kPart) {
    const std::size_t had = undecoded_.size();
    undecoded_.resize(kPart);
    undecoded_.resize(had + read_into(undecoded_.data() + had, kPart - had));
    at_end_ = undecoded_.size() == had;
  }
  const auto unit = [this](std::size_t at) {
    const auto first = static_cast<std::uint8_t>(undecoded_[at]);
    const auto second = static_cast<std::uint8_t>(undecoded_[at + 1]);
    return static_cast<std::uint32_t>(encoding_ == Encoding::utf16_big ? first << 8U | second
                                                                       : second << 8U | first);
  };
  const auto fail = [this](const char* problem) {
    throw InputError(path_, problem, "save it as UTF-8 text, or copy the file again");
  };
  const auto put = [this](std::uint32_t byte) { buffer_[end_++] = static_cast<char>(byte); };
  std::size_t at = 0;
  while (at + 2 <= undecoded_.size() && end_ + 4 <= kBufferSize) {
    std::uint32_t code = unit(at);
    at += 2;
    if (code >= 0xdc00 && code < 0xe000) fail("is not whole UTF-16 text");
    if (code >= 0xd800 && code < 0xdc00) {
      if (at + 2 > undecoded_.size()) {
        if (at_end_) fail("ends within a character of UTF-16");
        at -= 2;
        break;
      }
      const std::uint32_t low = unit(at);
      at += 2;
      if (low < 0xdc00 || low >= 0xe000) fail("is not whole UTF-16 text");
      code = 0x10000 + ((code - 0xd800) << 10U) + (low - 0xdc00);
    }
    if (code < 0x80) {
      put(code);
    } else if (code < 0x800) {
      put(0xc0 | code >> 6U);
      put(0x80 | (code & 0x3fU));
    } else if (code < 0x10000) {
      put(0xe0 | code >> 12U);
      put(0x80 | (code >> 6U & 0x3fU));
      put(0x80 | (code & 0x3fU));
    } else {
      put(0xf0 | code >> 18U);
      put(0x80 | (code >> 12U & 0x3fU));
      put(0x80 | (code >> 6U & 0x3fU));
      put(0x80 | (code & 0x3fU));
    }
  }
  undecoded_.erase(0, at);
  if (at_end_ && !undecoded_.empty()) {
    if (undecoded_.size() == 1) fail("ends within a character of UTF-16");
    at_end_ = false;  // the buffer was full
  }
}

std::string_view ByteReader::peek(std::size_t count) {
  fill(count);
  return {buffer_.get() + begin_, std::min(count, end_ - begin_)};
}

void ByteReader::skip(std::size_t count) {
  begin_ += count;
  consumed_ += count;
}

bool ByteReader::next_line(std::string_view& line) {
  std::size_t searched = 0;
  while (true) {
    const char* const start = buffer_.get() + begin_;
    const void* const found = std::memchr(start + searched, '\n', end_ - begin_ - searched);
    if (found != nullptr || at_end_) {
      const std::size_t available = end_ - begin_;
      if (found == nullptr && available == 0) return false;
      const std::size_t length =
          found != nullptr ? static_cast<std::size_t>(static_cast<const char*>(found) - start)
                           : available;
      line = {start, length};
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      is_line_ended_ = found != nullptr;
      skip(length + (is_line_ended_ ? 1 : 0));
      ++line_number_;
      return true;
    }
    searched = end_ - begin_;
    if (searched >= kLongestLine) {
      throw InputError(fmt::format("{}:{}", path_, line_number_ + 1),
                       fmt::format("the line is longer than {} bytes", kLongestLine),
                       "a recording has one short row per sample; check that this is one");
    }
    fill(searched + 1);
  }
}

}  // namespace condyle::host
