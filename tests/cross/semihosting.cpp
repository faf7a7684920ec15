// SPDX-License-Identifier: Apache-2.0
// Arm's semihosting, version 2: a breakpoint that the debugger answers, not the core.
#include "semihosting.h"

#include <cstring>

#include "test_host.h"

namespace condyle::cross {
namespace {

enum Call : std::intptr_t {
  sys_open = 0x01,
  sys_close = 0x02,
  sys_write0 = 0x04,
  sys_write = 0x05,
  sys_read = 0x06,
  sys_get_cmdline = 0x15,
  sys_exit_extended = 0x20,
};

std::intptr_t ask(Call call, const void* argument) {
  register std::intptr_t r0 asm("r0") = call;
  register const void* r1 asm("r1") = argument;
  asm volatile("bkpt 0xAB" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

}  // namespace

void end(int status) {
  constexpr std::intptr_t application_exit = 0x20026;
  const std::intptr_t block[] = {application_exit, status};
  ask(sys_exit_extended, block);
  for (;;) {
  }
}

bool command_line(char* text, std::size_t size) {
  std::intptr_t block[] = {reinterpret_cast<std::intptr_t>(text), static_cast<std::intptr_t>(size)};
  return ask(sys_get_cmdline, block) == 0;
}

void print_hexadecimal(const char* name, std::uint32_t value) {
  char text[] = "00000000";
  for (int i = 7; i >= 0; --i, value >>= 4U) text[i] = "0123456789abcdef"[value & 15U];
  print(name);
  print(text);
}

void print(const char* text) {
  ask(sys_write0, text);
}
void print(std::uint64_t number) {
  char text[21] = {};
  char* first = text + 20;
  do {
    *--first = static_cast<char>('0' + number % 10);
    number /= 10;
  } while (number != 0);
  print(first);
}

// Handles are small numbers, -1 for none; the mode is an index to "r", "rb", "r+", "r+b", "w",
// "wb".
ByteFile::ByteFile(const char* path, Use use) {
  const std::intptr_t block[] = {reinterpret_cast<std::intptr_t>(path), use == Use::read ? 1 : 5,
                                 static_cast<std::intptr_t>(std::strlen(path))};
  handle_ = ask(sys_open, block);
  is_open_ = handle_ != -1;
}
// Both calls return how many bytes they left undone.
void ByteFile::fill() {
  const std::intptr_t block[] = {handle_, reinterpret_cast<std::intptr_t>(bytes_), sizeof bytes_};
  next_ = 0;
  filled_ = sizeof bytes_ - static_cast<std::size_t>(ask(sys_read, block));
}
void ByteFile::flush() {
  const std::intptr_t block[] = {handle_, reinterpret_cast<std::intptr_t>(bytes_),
                                 static_cast<std::intptr_t>(filled_)};
  is_good_ = ask(sys_write, block) == 0 && is_good_;
  filled_ = 0;
}
bool ByteFile::close() {
  if (next_ == 0) flush();
  return ask(sys_close, &handle_) == 0 && is_good_;
}

}  // namespace condyle::cross
