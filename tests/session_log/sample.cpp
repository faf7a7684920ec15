// SPDX-License-Identifier: Apache-2.0
// Records a session into the log named by its argument, and prints as JSON what other readers of it
// must find.
#include <cstdio>
#include <map>

#include "support/session.h"

namespace {

using condyle::hal::SessionEvent;

std::string in_quotes(const std::string& text) {
  return '"' + text + '"';
}

template <typename Bytes>
std::string hexadecimal(const Bytes& bytes) {
  std::string text;
  for (const auto byte : bytes) {
    char digits[3];
    std::snprintf(digits, sizeof(digits), "%02x", static_cast<unsigned>(byte) & 0xffU);
    text += digits;
  }
  return in_quotes(text);
}

void print(const char* name, const std::map<std::string, std::string>& members) {
  std::printf("%s: {", in_quotes(name).c_str());
  const char* separator = "";
  for (const auto& [key, value] : members) {
    std::printf("%s\n  %s: %s", separator, in_quotes(key).c_str(), value.c_str());
    separator = ",";
  }
  std::printf("}");
}

}  // namespace

int main(int argc, char** argv) {
  const condyle::hal::SessionHeader header = condyle::testing_support::make_header(2);
  condyle::hal::SessionLogWriter log({.chunk_time_ns = 0});
  if (argc != 2 || log.open(argv[1], header) != condyle::hal::SessionLogFailure::none) return 1;

  std::map<std::string, std::string> messages;
  const auto add = [&](const std::string& topic, const std::string& members) {
    std::string& list = messages[topic];
    list += (list.empty() ? "[" : ",") + std::string("\n    {") + members + "}";
  };
  std::uint64_t written = 0;
  for (std::uint32_t i = 0; i < 600; ++i) {
    const std::size_t source = i % 3 == 0 ? 1 : 0;
    const auto report = condyle::testing_support::make_report(
        i, static_cast<std::uint16_t>(i % 70), header.start_monotonic_ns + 2'000'000 * i);
    const std::string time =
        "\"host_time_ns\": " + in_quotes(std::to_string(report.host_time_ns)) + ", ";
    const std::string topic = "/source_" + std::to_string(source);
    if (!log.write(source, report)) return 1;
    add(topic + "/report", time + "\"data\": " + hexadecimal(report.data()));
    if (i % 50 == 7) {
      const int kind = 1 + static_cast<int>(i / 50) % 7;
      const std::string text = "event " + std::to_string(i) + " \xc3\xa4";
      if (!log.write_event(source, report.host_time_ns, static_cast<SessionEvent>(kind), text)) {
        return 1;
      }
      add(topic + "/event", time + "\"kind\": " + std::to_string(kind) +
                                ", \"count\": \"1\", \"text\": " + in_quotes(text));
    }
    if (++written % 100 == 0 && !condyle::testing_support::wait_until_written(log, written))
      return 1;
  }
  if (log.close() != condyle::hal::SessionLogFailure::none) return 1;
  for (auto& [topic, list] : messages) list += "]";

  std::printf("{");
  print("session", {{"software_version", in_quotes(header.software_version)},
                    {"subject_code", in_quotes(header.subject_code)},
                    {"start_wall_ns", in_quotes(std::to_string(header.start_wall_ns))},
                    {"start_monotonic_ns", in_quotes(std::to_string(header.start_monotonic_ns))},
                    {"source_1_product_id", in_quotes("2")}});
  std::printf(",\n");
  print("attachments",
        {{"parameters.toml", hexadecimal(header.parameters_toml)},
         {"source_0/profile.toml", hexadecimal(header.sources[0].profile_toml)},
         {"source_1/report_descriptor.bin", hexadecimal(header.sources[1].report_descriptor)}});
  std::printf(",\n");
  print("messages", messages);
  std::printf("}\n");
  return 0;
}
