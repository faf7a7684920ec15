// SPDX-License-Identifier: Apache-2.0
#include <windows.h>
//
#include <fcntl.h>
#include <io.h>
#include <pthread.h>
#include <sys/stat.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cwchar>
#include <filesystem>

#include "hosted/files/clean_text.h"
#include "hosted/system/system.h"

namespace condyle::host {
namespace {

void (*stop_program)(int) = nullptr;

BOOL WINAPI on_console_event(DWORD event) {
  if (event != CTRL_C_EVENT && event != CTRL_BREAK_EVENT) return FALSE;
  stop_program(SIGINT);
  return TRUE;
}

}  // namespace

void prepare_program(void (*stop)(int)) {
  stop_program = stop;
  SetConsoleCtrlHandler(on_console_event, TRUE);
  _fmode = _O_BINARY;
  for (std::FILE* const file : {stdin, stdout, stderr}) _setmode(_fileno(file), _O_BINARY);
  SetConsoleOutputCP(CP_UTF8);
}

void interrupt_write(std::thread& thread) {
  CancelSynchronousIo(static_cast<HANDLE>(pthread_gethandle(thread.native_handle())));
}

std::FILE* duplicate_standard_output() {
  const int descriptor = _dup(_fileno(stdout));
  return descriptor >= 0 ? _fdopen(descriptor, "wb") : nullptr;
}

bool is_on_disk(std::FILE* file) {
  return GetFileType(reinterpret_cast<HANDLE>(_get_osfhandle(_fileno(file)))) == FILE_TYPE_DISK;
}

std::FILE* make_file_beside(std::string& path) {
  path += ".partial-XXXXXX";
  const int descriptor = mkstemp(path.data());
  return descriptor >= 0 ? _fdopen(descriptor, "wb") : nullptr;
}

void discard_unread(std::FILE* file) {
  CancelIoEx(reinterpret_cast<HANDLE>(_get_osfhandle(_fileno(file))), nullptr);
}

std::optional<long> JobProcesses::start(const std::function<int()>& job) {
  static long last_id = 0;
  jobs_.emplace(++last_id, job());
  return last_id;
}

std::optional<JobProcesses::Ended> JobProcesses::take_ended() {
  if (jobs_.empty()) return std::nullopt;
  const Ended ended{.id = jobs_.begin()->first, .exit_code = jobs_.begin()->second, .signal = 0};
  jobs_.erase(jobs_.begin());
  return ended;
}

void JobProcesses::end_all() {
  jobs_.clear();
}

}  // namespace condyle::host

// The linker puts this in the place of mbrtowc (toolchain/targets/windows.cmake). With it,
// std::filesystem::path reads its narrow names as UTF-8; the C library of mingw-w64 takes each byte
// for a character. A byte that is not UTF-8 becomes a character of its own.
extern "C" std::size_t __wrap_mbrtowc(wchar_t* to, const char* from, std::size_t count,
                                      std::mbstate_t* state) {
  static thread_local std::mbstate_t own_state = 0;
  if (state == nullptr) state = &own_state;
  if (from == nullptr) return 0;
  if (count == 0) return static_cast<std::size_t>(-2);
  const auto give = [to](std::uint32_t code) {
    if (to != nullptr) *to = static_cast<wchar_t>(code);
  };
  if (*state != 0) {  // the second half of a pair, which takes the last byte
    give(static_cast<std::uint32_t>(*state));
    *state = 0;
    return 1;
  }
  const auto character =
      condyle::host::internal::first_character({from, std::min<std::size_t>(count, 4)});
  if (character.bytes == 0) {
    give(static_cast<unsigned char>(*from));
    return 1;
  }
  if (character.code < 0x10000) {
    give(character.code);
    return character.code == 0 ? 0 : character.bytes;
  }
  const std::uint32_t offset = character.code - 0x10000;
  give(0xd800 + (offset >> 10U));
  *state = static_cast<std::mbstate_t>(0xdc00 + (offset & 0x3ffU));
  return character.bytes - 1;
}
