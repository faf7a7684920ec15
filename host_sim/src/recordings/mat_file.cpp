// SPDX-License-Identifier: Apache-2.0
#include "recordings/mat_file.h"

#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "hosted/files/byte_reader.h"
#include "hosted/files/input_error.h"
#include "recordings/mat_check.h"

namespace condyle::host {
namespace {

constexpr int kDeepest = 20;
constexpr const char* kCopyAgain = "copy the file again, or save it again";

void append_utf8(std::uint32_t code, std::string& text) {
  if (code < 0x80) {
    text += static_cast<char>(code);
  } else if (code < 0x800) {
    text += static_cast<char>(0xc0U | code >> 6U);
    text += static_cast<char>(0x80U | (code & 0x3fU));
  } else {
    text += static_cast<char>(0xe0U | code >> 12U);
    text += static_cast<char>(0x80U | (code >> 6U & 0x3fU));
    text += static_cast<char>(0x80U | (code & 0x3fU));
  }
}

// Whether the sizes that an array states fit into memory, which libmatio allocates for them, and
// the file has as many bytes as elements. `left`: elements that the file can still have.
bool has_usable_size(const matvar_t* array, std::uint64_t& left, int depth) {
  if (array == nullptr) return true;
  if (depth > kDeepest || array->rank < 0 || array->rank > 10) return false;
  std::uint64_t count = 1;
  for (int i = 0; i < array->rank; ++i) {
    if (array->dims[i] > kMostMatBytes) return false;
    count *= array->dims[i];
    if (count > kMostMatBytes) return false;
  }
  const bool is_struct = array->class_type == MAT_C_STRUCT;
  if (!is_struct && array->class_type != MAT_C_CELL) {
    if (count > left) return false;
    left -= count;
    return true;
  }
  if (is_struct) count *= Mat_VarGetNumberOfFields(const_cast<matvar_t*>(array));
  const auto* const parts = static_cast<matvar_t* const*>(array->data);
  if (parts == nullptr || array->nbytes / sizeof(matvar_t*) < count) return true;
  for (std::uint64_t i = 0; i < count; ++i) {
    if (!has_usable_size(parts[i], left, depth + 1)) return false;
  }
  return true;
}

// Whether a struct or a cell array has all its parts; in a damaged file it may have fewer.
bool has_parts(const matvar_t* array) {
  if (array->data == nullptr || array->rank < 2) return false;
  std::uint64_t count = 1;
  for (int i = 0; i < array->rank; ++i) count *= array->dims[i];
  if (array->class_type == MAT_C_STRUCT) {
    const unsigned fields = Mat_VarGetNumberOfFields(const_cast<matvar_t*>(array));
    if (fields == 0 || Mat_VarGetStructFieldnames(array) == nullptr) return false;
    count *= fields;
  }
  return count > 0 && count <= array->nbytes / sizeof(matvar_t*);
}

}  // namespace

bool MatArray::is_struct() const {
  return array_ != nullptr && array_->class_type == MAT_C_STRUCT && has_parts(array_);
}
bool MatArray::is_cell() const {
  return array_ != nullptr && array_->class_type == MAT_C_CELL && has_parts(array_);
}
bool MatArray::is_text() const {
  return array_ != nullptr && array_->class_type == MAT_C_CHAR;
}
bool MatArray::is_numeric() const {
  return array_ != nullptr && array_->class_type >= MAT_C_DOUBLE &&
         array_->class_type <= MAT_C_UINT64 && array_->isComplex == 0 && array_->data != nullptr;
}

std::vector<std::size_t> MatArray::sizes() const {
  if (array_ == nullptr || array_->rank < 2) return {0, 0};
  return {array_->dims, array_->dims + array_->rank};
}

std::size_t MatArray::count() const {
  std::size_t count = 1;
  for (const std::size_t size : sizes()) count *= size;
  return count;
}

double MatArray::number(std::size_t index) const {
  const auto value = [&]<typename Number>(Number) {
    Number number{};
    const std::size_t at = index * sizeof number;
    if (at + sizeof number > array_->nbytes) return std::numeric_limits<double>::quiet_NaN();
    std::memcpy(&number, static_cast<const char*>(array_->data) + at, sizeof number);
    return static_cast<double>(number);
  };
  switch (array_->class_type) {
    case MAT_C_DOUBLE:
      return value(double{});
    case MAT_C_SINGLE:
      return value(float{});
    case MAT_C_INT8:
      return value(std::int8_t{});
    case MAT_C_UINT8:
      return value(std::uint8_t{});
    case MAT_C_INT16:
      return value(std::int16_t{});
    case MAT_C_UINT16:
      return value(std::uint16_t{});
    case MAT_C_INT32:
      return value(std::int32_t{});
    case MAT_C_UINT32:
      return value(std::uint32_t{});
    case MAT_C_INT64:
      return value(std::int64_t{});
    case MAT_C_UINT64:
      return value(std::uint64_t{});
    default:
      return std::numeric_limits<double>::quiet_NaN();
  }
}

double MatArray::scalar() const {
  return is_numeric() && count() == 1 ? number(0) : std::numeric_limits<double>::quiet_NaN();
}

std::string MatArray::characters(std::size_t first, std::size_t count, std::size_t stride) const {
  std::string text;
  if (array_->data == nullptr) return text;
  const bool is_wide = array_->data_type == MAT_T_UINT16 || array_->data_type == MAT_T_UTF16;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = first + i * stride;
    const auto* const bytes = static_cast<const unsigned char*>(array_->data);
    if ((at + 1) * (is_wide ? 2 : 1) > array_->nbytes) break;
    std::uint16_t wide = 0;
    if (is_wide) std::memcpy(&wide, bytes + 2 * at, 2);
    if (is_wide) append_utf8(wide, text);
    if (!is_wide) text += static_cast<char>(bytes[at]);
  }
  while (!text.empty() && (text.back() == ' ' || text.back() == '\0')) text.pop_back();
  return text;
}

std::string MatArray::text() const {
  if (!is_text() || sizes()[0] > 1) return "";
  return characters(0, count(), 1);
}

std::vector<std::string> MatArray::texts() const {
  std::vector<std::string> texts;
  if (is_cell()) {
    for (std::size_t i = 0; i < count(); ++i) texts.push_back(cell(i).text());
  } else if (is_text()) {
    const std::size_t rows = sizes()[0];
    for (std::size_t i = 0; i < rows; ++i) texts.push_back(characters(i, count() / rows, rows));
  }
  return texts;
}

std::string MatArray::name() const {
  return array_ == nullptr || array_->name == nullptr ? "" : array_->name;
}

std::vector<std::string> MatArray::fields() const {
  if (!is_struct()) return {};
  const char* const* const names = Mat_VarGetStructFieldnames(array_);
  const unsigned count = Mat_VarGetNumberOfFields(const_cast<matvar_t*>(array_));
  if (names == nullptr) return {};
  return {names, names + count};
}

MatArray MatArray::field(const std::string& name, std::size_t index) const {
  if (!is_struct() || index >= count()) return {};
  return MatArray(Mat_VarGetStructFieldByName(const_cast<matvar_t*>(array_), name.c_str(), index));
}

MatArray MatArray::cell(std::size_t index) const {
  if (!is_cell() || index >= count()) return {};
  return MatArray(Mat_VarGetCell(const_cast<matvar_t*>(array_), static_cast<int>(index)));
}

void MatFile::Closer::operator()(_mat_t* file) const {
  Mat_Close(file);
}
void MatFile::Freer::operator()(matvar_t* array) const {
  Mat_VarFree(array);
}

MatFile::MatFile(const std::string& path) {
  {
    ByteReader reader(path);
    const std::string_view start = reader.peek(kMatHeader);
    const bool is_5 = looks_like_mat(start) && start[start[126] == 'I' ? 125 : 124] == 1;
    if (!is_5) {
      throw InputError(path, "is a MAT file of version 7.3, which is HDF5",
                       "save it in MATLAB with save('NAME.mat', '-v7')");
    }
  }
  MatCheck check(path);
  const std::size_t variables = check.variables();
  file_.reset(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  std::uint64_t left = std::min(check.bytes(), kMostMatBytes / sizeof(double));
  while (file_) {
    std::unique_ptr<matvar_t, Freer> array(Mat_VarReadNextInfo(file_.get()));
    if (!array) break;
    if (!has_usable_size(array.get(), left, 0)) {
      throw InputError(path, "a variable is damaged or larger than 1 GiB", kCopyAgain);
    }
    // What it does not read has no data, or fewer bytes than elements; number() gives NaN there.
    static_cast<void>(Mat_VarReadDataAll(file_.get(), array.get()));
    arrays_.push_back(std::move(array));
    variables_.emplace_back(arrays_.back().get());
  }
  if (arrays_.size() < variables) {
    throw InputError(path, fmt::format("variable {} cannot be read", arrays_.size() + 1),
                     kCopyAgain);
  }
}

}  // namespace condyle::host
