// SPDX-License-Identifier: Apache-2.0
#include "exports/bids_dataset.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "hosted/files/byte_reader.h"
#include "hosted/files/clean_text.h"
#include "hosted/files/input_error.h"
#include "hosted/files/number_text.h"
#include "recordings/recording_formats.h"
#include "recordings/text_fields.h"

namespace condyle::host {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVersion = "1.9.0";  // the first with motion
constexpr const char* kDescription = "dataset_description.json";
constexpr const char* kParticipants = "participants.tsv";

bool is_there(const fs::path& path) {
  std::error_code failure;
  return fs::exists(path, failure);
}

BidsJson description_of(const char* name, const char* type) {
  return {{"Name", name},
          {"BIDSVersion", kVersion},
          {"DatasetType", type},
          {"GeneratedBy", {{{"Name", "condyle"}, {"Version", CONDYLE_VERSION}}}}};
}

constexpr std::string_view kReadme =
    "# Recordings of jaw motion\n"
    "\n"
    "This data set follows Motion-BIDS. The folders `sub-*` hold what the instruments measured: "
    "places of\n"
    "points, and where they were recorded poses and the force on the jaw. Places are in the frame "
    "of the\n"
    "instrument. Missing values are `n/a`.\n"
    "\n"
    "The folder `derivatives/condyle` holds estimates of position, velocity, acceleration and "
    "force, each with\n"
    "its standard deviation and its provenance.\n";

BidsLabels complete_labels(const BidsLabels& given, const std::string& source) {
  BidsLabels labels = bids_labels_in(source);
  // A label that is given stands for itself; one from the name stays beside the others of the name.
  const auto take = [](const std::string& from, std::string& to) {
    if (!from.empty()) to = from;
  };
  take(given.subject, labels.subject);
  take(given.session, labels.session);
  take(given.task, labels.task);
  take(given.run, labels.run);
  const auto check = [&](const char* option, const char* what, bool is_required,
                         const std::string& given_label, const std::string& label) {
    if (label.empty() && !is_required) return;
    if (label.empty()) {
      throw InputError(source, fmt::format("its name does not say the {}, and BIDS needs it", what),
                       fmt::format("give {} with a word of letters and digits", option));
    }
    check_bids_label(given_label.empty() ? source : option, what, label);
  };
  check("--subject", "subject", true, given.subject, labels.subject);
  check("--session", "session", false, given.session, labels.session);
  check("--task", "task", true, given.task, labels.task);
  check("--run", "run", false, given.run, labels.run);
  const bool is_index = std::all_of(labels.run.begin(), labels.run.end(),
                                    [](char c) { return c >= '0' && c <= '9'; });
  if (!is_index) {
    throw InputError(given.run.empty() ? source : "--run",
                     fmt::format("run {} is not a whole number", quote(labels.run)),
                     "give --run with a number, as in --run 2");
  }
  return labels;
}

}  // namespace

std::string bids_unit(const std::string& unit) {
  constexpr struct {
    std::string_view from;
    const char* to;
  } kUnits[] = {{"m_s", "m/s"}, {"m_s2", "m/s^2"}, {"Ns_m", "N s/m"}, {"N_m", "N/m"}, {"", "n/a"}};
  for (const auto& known : kUnits) {
    if (known.from == unit) return known.to;
  }
  return unit;
}

std::string bids_cell(const std::string& text) {
  const std::string cell = clean_line(text);
  return trim(cell).empty() ? "n/a" : cell;
}

BidsDataset::BidsDataset(const std::string& out, const BidsLabels& labels,
                         const std::string& source, Exported& exported)
    : labels_(complete_labels(labels, source)), exported_(exported) {
  const fs::path root(out);
  if (out == "-") throw InputError("--out -", "a data set is a folder", "name a folder");
  const std::string session = labels_.session.empty() ? "" : "ses-" + labels_.session;
  std::string stem = "sub-" + labels_.subject;
  if (!session.empty()) stem += "_" + session;
  stem += "_task-" + labels_.task + "_tracksys-facebow";
  if (!labels_.run.empty()) stem += "_run-" + labels_.run;
  const fs::path place = fs::path("sub-" + labels_.subject) / session / "motion";
  derivatives_ = (root / "derivatives" / "condyle").string();
  measured_ = (root / place / stem).string();
  estimated_ = (fs::path(derivatives_) / place / (stem + "_desc-estimates")).string();
  std::error_code failure;
  if (is_there(root) && !is_there(root / kDescription) && !fs::is_empty(root, failure)) {
    throw InputError(out, fmt::format("holds files, and no {}", kDescription),
                     "name a new folder, or one that holds a data set of BIDS");
  }
  for (const std::string& taken : {measured_ + "_motion.tsv", estimated_ + "_motion.tsv"}) {
    if (!is_there(taken)) continue;
    throw InputError(taken, "exists, and a recording in a data set is not replaced",
                     "give another --run, or remove the files of that name");
  }
  make_folder(out);
  make_folder((root / place).string());
  if (!is_there(root / kDescription)) {
    write_json(file((root / kDescription).string()),
               description_of("Recordings of jaw motion", "raw"));
  }
  const bool has_readme = is_there(root / "README") || is_there(root / "README.md") ||
                          is_there(root / "README.rst") || is_there(root / "README.txt");
  if (!has_readme) {
    OutputFile& readme = file((root / "README.md").string());
    readme.write(kReadme);
    readme.close();
  }
  add_participant(out);
}

OutputFile& BidsDataset::file(const std::string& path) {
  exported_.files.push_back(std::make_unique<OutputFile>(path));
  return *exported_.files.back();
}

void BidsDataset::make_folder(const std::string& path) {
  exported_.folders.insert(exported_.folders.begin(), std::make_unique<OutputFolder>(path));
}

OutputFile& BidsDataset::measured_file(const std::string& end) {
  return file(measured_ + end);
}

OutputFile& BidsDataset::estimated_file(const std::string& end) {
  const fs::path folder = fs::path(estimated_).parent_path();
  if (!is_there(folder)) make_folder(folder.string());
  const std::string description = (fs::path(derivatives_) / kDescription).string();
  const bool is_new = std::none_of(exported_.files.begin(), exported_.files.end(),
                                   [&](const auto& one) { return one->path() == description; });
  if (is_new && !is_there(description)) {
    write_json(file(description), description_of("Estimates of jaw motion", "derivative"));
  }
  return file(estimated_ + end);
}

// Keeps the rows that are there, and their columns.
void BidsDataset::add_participant(const std::string& out) {
  const std::string path = (fs::path(out) / kParticipants).string();
  const std::string participant = "sub-" + labels_.subject;
  std::string text, row = participant;
  if (is_there(path)) {
    ByteReader reader(path);
    std::string_view line;
    std::vector<std::string_view> fields;
    for (bool is_header = true; reader.next_line(line); is_header = false) {
      split_fields(line, '\t', fields);
      if (is_header && (fields.empty() || fields[0] != "participant_id")) {
        throw InputError(path + ":1", "the first column is not participant_id",
                         "correct the table of participants");
      }
      if (!is_header && !fields.empty() && fields[0] == participant) return;
      for (std::size_t i = 1; is_header && i < fields.size(); ++i) row += "\tn/a";
      const bool has_return = !line.empty() && line.back() == '\r';
      (text += line.substr(0, line.size() - (has_return ? 1 : 0))) += '\n';
    }
  }
  if (text.empty()) text = "participant_id\n";
  OutputFile& table = file(path);
  table.write(text + row + "\n");
  table.close();
}

void BidsDataset::write_json(OutputFile& file, const BidsJson& content) {
  file.write(content.dump(2, ' ', false, BidsJson::error_handler_t::replace) + "\n");
  file.close();
}

void BidsDataset::write_channels(OutputFile& file, const std::vector<BidsChannel>& channels,
                                 double rate_Hz) {
  const bool is_described =
      std::any_of(channels.begin(), channels.end(),
                  [](const BidsChannel& channel) { return !channel.description.empty(); });
  std::string text = "name\tcomponent\ttype\ttracked_point\tunits\treference_frame";
  text += is_described ? "\tsampling_frequency\tdescription\n" : "\tsampling_frequency\n";
  std::string rate;
  append_number(rate, rate_Hz);
  for (const BidsChannel& channel : channels) {
    const bool is_in_space = channel.component != "n/a";
    text += fmt::format("{}\t{}\t{}\t{}\t{}\t{}\t{}", bids_cell(channel.name), channel.component,
                        channel.type, bids_cell(channel.point), bids_cell(channel.unit),
                        is_in_space ? "instrument" : "n/a", rate);
    if (is_described) text += "\t" + bids_cell(channel.description);
    text += '\n';
  }
  file.write(text);
  file.close();
}

}  // namespace condyle::host
