// SPDX-License-Identifier: Apache-2.0
// A plugin of QEMU that counts the instructions a core executes between two functions of the image.
// usage: qemu-system-arm ... -d plugin -plugin FILE.so,begin=ADDRESS,end=ADDRESS,report=ADDRESS
//   Executing `begin` starts a stretch, `end` ends it; `report` writes a line "STRETCHES MEAN MOST"
//   of the stretches since the last report.
// The plugin interface, version 1 (QEMU 7.2), is declared here: Debian ships no header of it.
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>

extern "C" {
using PluginId = std::uint64_t;
struct qemu_plugin_tb;
struct qemu_plugin_insn;
struct qemu_info_t;
enum qemu_plugin_cb_flags { QEMU_PLUGIN_CB_NO_REGS };
enum qemu_plugin_op { QEMU_PLUGIN_INLINE_ADD_U64 };
using ExecutionCallback = void (*)(unsigned core, void* data);

void qemu_plugin_register_vcpu_tb_trans_cb(PluginId, void (*)(PluginId, qemu_plugin_tb*));
void qemu_plugin_register_vcpu_insn_exec_cb(qemu_plugin_insn*, ExecutionCallback,
                                            qemu_plugin_cb_flags, void*);
void qemu_plugin_register_vcpu_insn_exec_inline(qemu_plugin_insn*, qemu_plugin_op, void*,
                                                std::uint64_t);
std::size_t qemu_plugin_tb_n_insns(const qemu_plugin_tb*);
qemu_plugin_insn* qemu_plugin_tb_get_insn(const qemu_plugin_tb*, std::size_t);
std::uint64_t qemu_plugin_insn_vaddr(const qemu_plugin_insn*);
void qemu_plugin_outs(const char*);

[[gnu::visibility("default")]] extern const int qemu_plugin_version;
const int qemu_plugin_version = 1;
}

namespace {

std::uint64_t g_begin, g_end, g_report;  // addresses
std::uint64_t g_executed, g_executed_at_begin;
std::uint64_t g_stretches, g_sum, g_most;

void begin(unsigned, void*) {
  g_executed_at_begin = g_executed;
}

void end(unsigned, void*) {
  const std::uint64_t count = g_executed - g_executed_at_begin;
  ++g_stretches;
  g_sum += count;
  if (count > g_most) g_most = count;
}

void report(unsigned, void*) {
  char line[96];
  const double mean = static_cast<double>(g_sum) / static_cast<double>(g_stretches);
  std::snprintf(line, sizeof line, "%llu %.2f %llu\n", static_cast<unsigned long long>(g_stretches),
                mean, static_cast<unsigned long long>(g_most));
  qemu_plugin_outs(line);
  g_stretches = g_sum = g_most = 0;
}

// Of each block of instructions, before it runs for the first time.
void translated(PluginId, qemu_plugin_tb* block) {
  for (std::size_t i = 0; i < qemu_plugin_tb_n_insns(block); ++i) {
    qemu_plugin_insn* instruction = qemu_plugin_tb_get_insn(block, i);
    const std::uint64_t address = qemu_plugin_insn_vaddr(instruction);
    const auto call = [instruction](ExecutionCallback callback) {
      qemu_plugin_register_vcpu_insn_exec_cb(instruction, callback, QEMU_PLUGIN_CB_NO_REGS,
                                             nullptr);
    };
    if (address == g_begin) call(begin);
    if (address == g_end) call(end);
    if (address == g_report) call(report);
    qemu_plugin_register_vcpu_insn_exec_inline(instruction, QEMU_PLUGIN_INLINE_ADD_U64, &g_executed,
                                               1);
  }
}

bool take(const char* argument, const char* name, std::uint64_t& address) {
  const std::size_t length = std::strlen(name);
  if (std::strncmp(argument, name, length) != 0 || argument[length] != '=') return false;
  address = std::strtoull(argument + length + 1, nullptr, 16);
  return true;
}

}  // namespace

extern "C" [[gnu::visibility("default")]] int qemu_plugin_install(PluginId id, const qemu_info_t*,
                                                                  int count, char** arguments) {
  for (int i = 0; i < count; ++i) {
    if (!take(arguments[i], "begin", g_begin) && !take(arguments[i], "end", g_end) &&
        !take(arguments[i], "report", g_report)) {
      return 1;
    }
  }
  if (g_begin == 0 || g_end == 0 || g_report == 0) return 1;
  qemu_plugin_register_vcpu_tb_trans_cb(id, translated);
  return 0;
}
