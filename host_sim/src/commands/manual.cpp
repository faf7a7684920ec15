// SPDX-License-Identifier: Apache-2.0
#include "commands/manual.h"

#include <algorithm>
#include <filesystem>

#include "output/output_file.h"

namespace condyle::host {
namespace {

void write(const std::filesystem::path& path, const std::string& text) {
  OutputFile file(path.string());
  file.write(text);
  file.close();
  file.commit();
}

void write_pages(const CommandText& command, const std::string& version,
                 const std::filesystem::path& folder) {
  std::string name = command.name;
  std::replace(name.begin(), name.end(), ' ', '-');
  write(folder / (name + ".1"), man_page(command, version));
  for (const CommandText& part : command.commands) write_pages(part, version, folder);
}

}  // namespace

void write_manual(const CommandText& program, const std::string& version,
                  const std::string& folder) {
  const OutputFolder made(folder);
  write_pages(program, version, folder);
  write(std::filesystem::path(folder) / (program.name + ".bash"), bash_completion(program));
}

}  // namespace condyle::host
