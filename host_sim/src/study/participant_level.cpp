// SPDX-License-Identifier: Apache-2.0
#include "study/participant_level.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <thread>

#include "hosted/files/input_error.h"
#include "hosted/system/system.h"
#include "output/output_file.h"
#include "output/report_text.h"
#include "readings/readings_files.h"
#include "recordings/file_digest.h"

namespace condyle::host {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kWork = ".work";
constexpr int kExitAnalysed = 0, kExitProblem = 1;

std::string dump(const Json& json) {
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

// Everything that decides on the results, but the files.
Json options_json(const StudyChoice& choice) {
  const AnalysisChoice& analysis = choice.analysis;
  // Named one by one, so that a new option cannot be forgotten.
  const auto& [faults, ignored, may_lack, columns, rate_Hz, units, missing, movement, profile,
               markers, drive_alone, drive_column] = analysis.reading;
  Json json = {{"faults", faults == FaultPolicy::event ? "event" : "refuse"},
               {"ignored_columns", ignored},
               {"may_lack_ignored", may_lack},
               {"columns", columns},
               {"rate_Hz", rate_Hz ? Json(*rate_Hz) : Json()},
               {"units_per_metre", units ? Json(*units) : Json()},
               {"missing", missing.text},
               {"movement", movement},
               {"profile", profile.empty() ? "" : file_digest(profile)},
               {"markers", markers},
               {"drive_alone", drive_alone},
               {"drive_column", drive_column},
               {"moving", analysis.moving == MovingBody::upper ? "upper" : "lower"},
               {"jaw", analysis.bodies.jaw},
               {"head", analysis.bodies.head},
               {"poses", choice.with_poses},
               {"report", static_cast<bool>(choice.write_report)}};
  if (analysis.reference_s) json["reference_s"] = *analysis.reference_s;
  return json;
}

// The files of one recording, seen from the data set's folder.
struct Inputs {
  std::string landmarks;  // its own, or those of the study
  std::vector<std::string> files;
};

Inputs inputs_of(const StudyRecording& recording, const StudyChoice& choice) {
  Inputs inputs;
  inputs.landmarks = recording.landmarks.empty() ? choice.analysis.landmarks : recording.landmarks;
  inputs.files.push_back(recording.recording);
  // A Motion-BIDS recording is described by the files beside it.
  constexpr std::string_view kMotion = "_motion.tsv";
  if (recording.recording.ends_with(kMotion)) {
    const std::string stem =
        recording.recording.substr(0, recording.recording.size() - kMotion.size());
    for (const char* end : {"_motion.json", "_channels.tsv", "_channels.json", "_events.tsv"}) {
      std::error_code failure;
      if (fs::is_regular_file(stem + end, failure)) inputs.files.push_back(stem + end);
    }
  }
  for (const std::string& file : {inputs.landmarks, recording.tasks}) {
    if (!file.empty()) inputs.files.push_back(file);
  }
  return inputs;
}

// What the results of `recording` rest on. Files that cannot be read have no digest.
Json provenance_of(const StudyRecording& recording, const Inputs& inputs, const Json& options) {
  Json files = Json::object();
  for (const std::string& file : inputs.files) {
    try {
      files[fs::path(file).is_absolute() ? fs::path(file).filename().string() : file] =
          file_digest(file);
    } catch (const InputError&) {
      files[file] = nullptr;
    }
  }
  return {{"format", kStudyFormat},
          {"note", "research use only; not a diagnosis"},
          {"condyle", CONDYLE_VERSION},
          {"recording", recording.recording},
          {"subject", recording.subject},
          {"session", recording.session},
          {"task", recording.task},
          {"inputs_sha1", files},
          {"options", options}};
}

// True if the results at `folder` rest on `provenance` and the analysis ended by itself.
bool is_done(const fs::path& folder, const Json& provenance) {
  std::ifstream file(folder / kProvenanceFile);
  if (!file) return false;
  Json found = Json::parse(file, nullptr, false);
  if (!found.is_object() || found.value("outcome", "") == "ended") return false;
  found.erase("outcome");
  found.erase("problem");
  return found == provenance;
}

void write_whole(const fs::path& path, const std::string& text) {
  OutputFile file(path.string());
  file.write(text);
  file.close();
  file.commit();
}

void write_results(const StudyRecording& recording, const Inputs& inputs, const StudyChoice& choice,
                   const fs::path& work) {
  AnalysisChoice analysis_choice = choice.analysis;
  analysis_choice.landmarks = inputs.landmarks;
  if (!recording.tasks.empty()) analysis_choice.tasks = read_tasks(recording.tasks);
  const Analysis analysis = analyse(recording.recording, analysis_choice);
  write_whole(work / kReadingsFile, readings_csv({analysis}));
  write_whole(work / "cycles.csv", cycles_csv({analysis}));
  write_whole(work / "summary.txt", banner() + analysis_text(analysis));
  if (choice.with_poses) {
    OutputFile poses((work / "poses.csv").string());
    write_poses(analysis, poses);
    poses.close();
    poses.commit();
  }
  if (choice.write_report) {
    choice.write_report(recording.recording, analysis_choice, (work / "report.html").string());
  }
}

void write_provenance(const fs::path& work, Json provenance, const char* outcome,
                      const std::string& problem) {
  provenance["outcome"] = outcome;
  if (!problem.empty()) provenance["problem"] = problem;
  write_whole(work / kProvenanceFile, dump(provenance));
}

// Puts the finished folder `work` in the place of `place`.
void put_in_place(const fs::path& work, const fs::path& place) {
  fs::create_directories(place.parent_path());
  fs::remove_all(place);
  fs::rename(work, place);
}

// One recording, in a process of its own.
int work_on(const StudyRecording& recording, const StudyChoice& choice, const Json& provenance,
            const Inputs& inputs, const fs::path& work, const fs::path& place) {
  const char* outcome = "analysed";
  std::string problem;
  try {
    write_results(recording, inputs, choice, work);
  } catch (const InputError& error) {
    outcome = "problem";
    problem = error.what();
  } catch (const std::exception& error) {
    outcome = "ended";
    problem = fmt::format("the analysis failed: {}", error.what());
  }
  if (!problem.empty()) {
    fs::remove_all(work);
    fs::create_directories(work);
  }
  write_provenance(work, provenance, outcome, problem);
  put_in_place(work, place);
  return problem.empty() ? kExitAnalysed : kExitProblem;
}

// The processes that are at work.
class Workers {
 public:
  struct Job {
    StudyRecording recording;
    Json provenance;
    fs::path work, place;
  };

  explicit Workers(const StudyChoice& choice) : choice_(choice) {}
  ~Workers() {
    processes_.end_all();
    for (const auto& [id, job] : jobs_) {
      std::error_code failure;
      fs::remove_all(job.work, failure);
    }
  }
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  std::size_t count() const { return jobs_.size(); }

  void start(Job job, const Inputs& inputs) {
    const auto id = processes_.start([&] {
      try {
        return work_on(job.recording, choice_, job.provenance, inputs, job.work, job.place);
      } catch (const std::exception& error) {  // the disk
        std::fprintf(stderr, "condyle: %s: %s\n", job.recording.recording.c_str(), error.what());
        return kExitProblem + 1;
      }
    });
    if (!id) {
      throw InputError("study", fmt::format("cannot start a process: {}", std::strerror(errno)),
                       "use fewer --jobs");
    }
    jobs_.emplace(*id, std::move(job));
  }

  // Waits a little for a process to end, and counts it.
  void wait(StudyCounts& counts) {
    const auto ended = processes_.take_ended();
    if (!ended) {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      return;
    }
    const auto found = jobs_.find(ended->id);
    const Job job = std::move(found->second);
    jobs_.erase(found);
    if (ended->exit_code == kExitAnalysed) {
      ++counts.analysed;
      return;
    }
    ++counts.problems;
    if (ended->exit_code == kExitProblem) return;
    if (ended->exit_code) {
      throw InputError(choice_.out, "cannot be written", "free space, or check its permissions");
    }
    fs::remove_all(job.work);
    fs::create_directories(job.work);
    write_provenance(job.work, job.provenance, "ended",
                     fmt::format("the analysis was ended by signal {}, as if memory was short; "
                                 "it is tried again by the next run",
                                 ended->signal));
    put_in_place(job.work, job.place);
  }

 private:
  const StudyChoice& choice_;
  JobProcesses processes_;
  std::map<long, Job> jobs_;
};

// Written in place: a run that is killed meanwhile leaves no temporary file behind, every shard
// writes the same bytes, and the next run completes them.
void write_in_place(const fs::path& path, const std::string& text) {
  {
    std::ifstream file(path, std::ios::binary);
    const std::string found{std::istreambuf_iterator<char>(file), {}};
    if (found == text) return;
  }
  std::ofstream file(path, std::ios::binary);
  if (!(file << text << std::flush)) {
    throw InputError(path.string(), "cannot be written", "free space, or check its permissions");
  }
}

// The files that BIDS asks for in a folder of results. BIDS does not name files of readings, so
// .bidsignore lists them.
void write_description(const fs::path& out) {
  const Json description = {{"Name", "Readings of jaw motion"},
                            {"BIDSVersion", "1.9.0"},
                            {"DatasetType", "derivative"},
                            {"GeneratedBy", {{{"Name", "condyle"}, {"Version", CONDYLE_VERSION}}}}};
  write_in_place(out / "dataset_description.json", dump(description));
  write_in_place(out / ".bidsignore", "sub-*/**\ngroup/**\n");
}

}  // namespace

StudyCounts run_participant_level(const StudyChoice& given,
                                  const std::vector<StudyRecording>& recordings,
                                  const StudyShard& shard,
                                  const std::function<void(double)>& progress,
                                  const std::function<bool()>& should_stop) {
  StudyChoice choice = given;
  if (!choice.analysis.landmarks.empty()) {
    choice.analysis.landmarks = fs::absolute(choice.analysis.landmarks).string();
  }
  if (!choice.analysis.reading.profile.empty()) {
    choice.analysis.reading.profile = fs::absolute(choice.analysis.reading.profile).string();
  }
  const fs::path out = fs::absolute(choice.out), work = out / kWork;
  fs::create_directories(work);
  write_description(out);
  // Names in messages and files are those in the data set.
  std::error_code failure;
  fs::current_path(choice.dataset, failure);
  if (failure) throw InputError(choice.dataset, "cannot be entered", "check its permissions");
  const Json options = options_json(choice);
  const unsigned cores = std::max(1U, std::thread::hardware_concurrency());
  const unsigned jobs = choice.jobs > 0 ? choice.jobs : cores;

  StudyCounts counts;
  {
    Workers workers(choice);
    const auto wait_while = [&](std::size_t most) {
      while (workers.count() > most && !should_stop()) workers.wait(counts);
    };
    for (std::size_t i = 0; i < recordings.size() && !should_stop(); ++i) {
      if (!shard.has(i)) continue;
      progress(static_cast<double>(i) / static_cast<double>(recordings.size()));
      const StudyRecording& recording = recordings[i];
      const Inputs inputs = inputs_of(recording, choice);
      Workers::Job job{recording, provenance_of(recording, inputs, options), work / "",
                       out / recording.folder};
      std::string name = recording.folder;
      std::replace(name.begin(), name.end(), '/', '_');
      job.work = work / name;
      fs::remove_all(job.work);  // of a run that was killed
      if (is_done(job.place, job.provenance)) {
        ++counts.unchanged;
        continue;
      }
      fs::create_directories(job.work);
      workers.start(std::move(job), inputs);
      wait_while(jobs - 1);
    }
    wait_while(0);
  }
  fs::remove(work, failure);  // stays while another shard works
  return counts;
}

}  // namespace condyle::host
