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
    const std::size_t got = std::fread(buffer_.get() + end_, 1, kBufferSize - end_, file_.get());
    if (got == 0 && std::ferror(file_.get())) {
      throw InputError(path_, fmt::format("cannot be read: {}", std::strerror(errno)),
                       "check the disk or copy the file");
    }
    at_end_ = got == 0;
    end_ += got;
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
      skip(length + (found != nullptr ? 1 : 0));
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
