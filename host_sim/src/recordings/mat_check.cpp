// SPDX-License-Identifier: Apache-2.0
// The layout: MathWorks, "MAT-File Format", version 5.
#include "recordings/mat_check.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <functional>
#include <memory>
#include <new>
#include <string_view>
#include <vector>

#include "hosted/files/input_error.h"

namespace condyle::host {
namespace {

constexpr std::size_t kPart = 65536;
constexpr std::uint32_t kMatrix = 14, kCompressed = 15;
constexpr std::uint64_t kTag = 8, kMostFields = 10'000;
constexpr int kDeepest = 20;
constexpr const char* kCopyAgain = "copy the file again, or save it again";

// Walks through the arrays of a variable, whose bytes `refill` gives part by part; empty: the end.
class ArrayWalk {
 public:
  ArrayWalk(std::function<std::string_view()> refill, bool swaps)
      : refill_(std::move(refill)), swaps_(swaps) {}

  /// Passes all bytes, of an array with its tag.
  bool pass() {
    const bool is_array = word() == kMatrix && !is_over_;
    return pass(is_array ? word() : 0);
  }
  /// The same of an array after its tag, of `size` bytes. False if an array has fewer bytes than
  /// its parts need or state.
  bool pass(std::uint64_t size) {
    walk(size, 0);
    while (!part_.empty() || fill()) skip(part_.size());
    return is_usable_ && needed_ <= passed_;
  }

 private:
  struct Element {
    std::uint64_t size = 0, padded = 0;
  };

  bool fill() {
    if (is_over_) return false;
    part_ = refill_();
    is_over_ = part_.empty();
    return !is_over_;
  }
  void skip(std::uint64_t count) {
    while (count > 0 && (!part_.empty() || fill())) {
      const auto step = static_cast<std::size_t>(std::min<std::uint64_t>(count, part_.size()));
      part_.remove_prefix(step);
      passed_ += step;
      count -= step;
    }
  }
  std::uint32_t word() {
    unsigned char bytes[4] = {};
    for (unsigned char& byte : bytes) {
      if (part_.empty() && !fill()) return 0;
      byte = static_cast<unsigned char>(part_.front());
      part_.remove_prefix(1);
      ++passed_;
    }
    std::uint32_t value = 0;
    std::memcpy(&value, bytes, sizeof value);
    return swaps_ ? __builtin_bswap32(value) : value;
  }
  // A tag; that of a small element is half as long, and four bytes of data follow.
  Element element() {
    const std::uint32_t first = word();
    if (first >> 16U != 0) return {first >> 16U, 4};
    const std::uint64_t size = word();
    return {size, (size + 7) / 8 * 8};
  }

  // The same in an array that ends at `end`.
  Element element_within(std::uint64_t end) {
    const Element one = element();
    if (passed_ <= end && one.size <= end - passed_) return one;
    is_usable_ = false;
    return {};
  }

  // An array after its tag, of `size` bytes.
  void walk(std::uint64_t size, int depth) {
    const std::uint64_t end = size > ~std::uint64_t{0} - passed_ ? size : passed_ + size;
    if (size == 0 || is_over_) return;
    if (depth > kDeepest) {
      is_usable_ = false;
      return;
    }
    const Element flags = element();
    const std::uint32_t kind = word() & 0xffU;
    skip(flags.padded - std::min<std::uint64_t>(flags.padded, 4));
    constexpr std::uint32_t kCell = 1, kStruct = 2, kLastPlain = 15;
    if (kind > kLastPlain) return skip_to(end);  // other parts
    const Element dimensions = element_within(end);
    std::uint64_t count = 1;
    for (std::uint64_t at = 0; at < dimensions.size && !is_over_; at += 4) {
      count *= word();
      if (count > kMostMatBytes) is_usable_ = false;
      if (!is_usable_) return;
    }
    skip(dimensions.padded - std::min(dimensions.padded, (dimensions.size + 3) / 4 * 4));
    skip(element_within(end).padded);  // name
    if (kind != kCell && kind != kStruct) return skip_to(end);
    if (kind == kStruct) {
      const Element length_of_name = element_within(end);
      const std::uint64_t length = word();
      skip(length_of_name.padded - std::min<std::uint64_t>(length_of_name.padded, 4));
      const Element names = element_within(end);
      const std::uint64_t fields = length > 0 ? names.size / length : 0;
      skip(names.padded);
      if (fields > kMostFields) {
        is_usable_ = false;
        return;
      }
      count *= fields;
    }
    needed_ = std::max(needed_, passed_ + kTag * count);
    for (std::uint64_t i = 0; i < count && !is_over_ && is_usable_; ++i) {
      if (word() != kMatrix) return skip_to(end);
      walk(word(), depth + 1);
    }
    skip_to(end);
  }
  void skip_to(std::uint64_t end) {
    if (end > passed_) skip(end - passed_);
  }

  std::function<std::string_view()> refill_;
  bool swaps_;
  std::string_view part_;
  bool is_over_ = false, is_usable_ = true;
  std::uint64_t passed_ = 0;
  std::uint64_t needed_ = 0;  // bytes from the start
};

}  // namespace

bool looks_like_mat(std::string_view start) {
  if (start.size() < kMatHeader) return false;
  const std::string_view order = start.substr(126, 2);
  const char version = start[order == "IM" ? 125 : 124];
  return (order == "IM" || order == "MI") && (version == 1 || version == 2);
}

MatCheck::MatCheck(const std::string& path) : reader_(path) {
  const std::string_view start = reader_.peek(kMatHeader);
  swaps_ = (start[126] == 'M') == (std::endian::native == std::endian::little);
  reader_.skip(kMatHeader);
}

std::size_t MatCheck::variables() {
  const auto word = [this](std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return swaps_ ? __builtin_bswap32(value) : value;
  };
  while (true) {
    const std::string_view tag = reader_.peek(kTag);
    if (tag.empty()) return variables_;
    if (tag.size() < kTag) fail_cut();
    const std::uint32_t type = word(tag, 0), size = word(tag, 4);
    reader_.skip(kTag);
    if (type != kMatrix && type != kCompressed) {
      throw InputError(reader_.path(), fmt::format("is damaged after {} variables", variables_),
                       kCopyAgain);
    }
    ++variables_;
    type == kCompressed ? pass_compressed(size) : pass_plain(size);
  }
}

void MatCheck::fail_cut() const {
  throw InputError(reader_.path(), fmt::format("ends within variable {}", variables_ + 1),
                   kCopyAgain);
}

void MatCheck::fail_damaged(const std::string& what) const {
  throw InputError(reader_.path(), fmt::format("{} of variable {} are damaged", what, variables_),
                   kCopyAgain);
}

void MatCheck::take(std::uint64_t count) {
  bytes_ += count;
  if (bytes_ <= kMostMatBytes) return;
  throw InputError(reader_.path(), "its variables are larger than 1 GiB",
                   "save the time and the positions alone, or the recording in parts");
}

void MatCheck::pass_plain(std::uint64_t count) {
  take(count);
  const std::uint64_t array_size = count;
  std::size_t passed = 0;  // of the part given last
  ArrayWalk walk(
      [&]() -> std::string_view {
        reader_.skip(passed);
        count -= passed;
        const std::string_view part =
            reader_.peek(static_cast<std::size_t>(std::min<std::uint64_t>(count, kPart)));
        passed = part.size();
        if (part.empty() && count > 0) {
          --variables_;
          fail_cut();
        }
        return part;
      },
      swaps_);
  if (!walk.pass(array_size)) fail_damaged("the sizes");
}

void MatCheck::pass_compressed(std::uint64_t count) {
  z_stream stream{};
  const auto close = [](z_stream* one) { inflateEnd(one); };
  if (inflateInit(&stream) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, decltype(close)> closer(&stream, close);
  std::vector<unsigned char> out(kPart);
  std::string in;  // zlib takes no constant bytes
  int status = Z_OK;
  const auto load = [&] {
    in = std::string(reader_.peek(static_cast<std::size_t>(std::min<std::uint64_t>(count, kPart))));
    if (in.empty() && count > 0) {
      --variables_;
      fail_cut();
    }
    reader_.skip(in.size());
    count -= in.size();
    stream.next_in = reinterpret_cast<unsigned char*>(in.data());
    stream.avail_in = static_cast<unsigned>(in.size());
  };
  ArrayWalk walk(
      [&]() -> std::string_view {
        while (status == Z_OK) {
          if (stream.avail_in == 0 && count > 0) load();
          stream.next_out = out.data();
          stream.avail_out = static_cast<unsigned>(out.size());
          status = inflate(&stream, Z_NO_FLUSH);
          const std::size_t filled = out.size() - stream.avail_out;
          take(filled);
          if (filled > 0) return {reinterpret_cast<const char*>(out.data()), filled};
          if (status == Z_BUF_ERROR && count > 0) status = Z_OK;
        }
        return {};
      },
      swaps_);
  const bool is_usable = walk.pass();
  while (count > 0) load();  // what follows the end of the compressed bytes
  if (status != Z_STREAM_END) fail_damaged("the compressed bytes");
  if (!is_usable) fail_damaged("the sizes");
}

}  // namespace condyle::host
