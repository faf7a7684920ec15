// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "test_host.h"

namespace condyle::cross {
namespace {

std::FILE* file_of(std::intptr_t handle) {
  return reinterpret_cast<std::FILE*>(handle);
}

}  // namespace

void print(const char* text) {
  std::fputs(text, stdout);
}
void print(std::uint64_t number) {
  std::printf("%llu", static_cast<unsigned long long>(number));
}

ByteFile::ByteFile(const char* path, Use use)
    : handle_(reinterpret_cast<std::intptr_t>(std::fopen(path, use == Use::read ? "rb" : "wb"))),
      is_open_(handle_ != 0) {}
void ByteFile::fill() {
  next_ = 0;
  filled_ = std::fread(bytes_, 1, sizeof bytes_, file_of(handle_));
}
void ByteFile::flush() {
  is_good_ = std::fwrite(bytes_, 1, filled_, file_of(handle_)) == filled_ && is_good_;
  filled_ = 0;
}
bool ByteFile::close() {
  if (next_ == 0) flush();
  return std::fclose(file_of(handle_)) == 0 && is_good_;
}

}  // namespace condyle::cross

int main(int argc, char** argv) {
  return condyle::cross::test_program(argc - 1, argv + 1);
}
