// SPDX-License-Identifier: Apache-2.0
#include "app/output/result_folder.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <utility>

#include "app/system/process.hpp"

namespace sunder::app {
namespace {

constexpr const char* kLockName = ".sunder-lock";
// Their presence says that all is there: they go first and come last.
constexpr const char* kLast[] = {"summary.json", "reproduce.json"};

/// Names of `run`, with room for the half-written files of any process, and of `reproduce` where
/// they do not depend on its chapters.
bool is_result(const std::string& name) {
  static const std::regex ours(
      "((summary|reproduce)\\.json|(events|frames|tips)\\.csv|(series|cracks)\\.pvd|(figure|film)"
      "\\.(svg|"
      "png)|"
      "index\\.html|reproduction\\.md|(result|cracks)(_[0-9]+)?\\.vtu|"
      "snapshot_[0-9]+\\.(svg|png|vtu)|frame_[0-9]+\\.png|recording\\.(toml|inputs))(\\.([0-9]+\\.)"
      "?partial)?");
  static const std::regex half_written(".+\\.[0-9]+\\.partial");
  return std::regex_match(name, ours) || std::regex_match(name, half_written);
}

bool is_plain(const std::string& name) {
  return !name.empty() && name.front() != '.' && std::filesystem::path(name).filename() == name;
}

std::string process(const std::string& id) {
  return id.empty() ? "another process" : "process " + id;
}

}  // namespace

std::vector<std::filesystem::path> make_result_folder(const std::filesystem::path& folder) {
  std::error_code error;
  const auto refuse = [&](const std::string& why) {
    throw UsageError("--out: results cannot go to " + folder.string() + ": " + why +
                     "; allowed is a folder that can be written to or created");
  };
  std::vector<std::filesystem::path> missing;
  for (auto place = folder; !place.empty() && !std::filesystem::exists(place, error);
       place = place.parent_path())
    missing.insert(missing.begin(), place);
  std::filesystem::create_directories(folder, error);
  std::error_code ignored;  // a name that is too long, say: `error` has it
  if (std::filesystem::exists(folder, ignored) && !std::filesystem::is_directory(folder, ignored))
    refuse("it is a file");
  if (error) refuse(error.message());
  system::check_writable(folder, error);
  if (error) refuse(error.message());
  return missing;
}

ResultFolder::ResultFolder(std::filesystem::path path)
    : path_(std::move(path)), made_(make_result_folder(path_)) {
  lock();
}

void ResultFolder::lock() {
  const auto refuse = [&](const std::string& why) {
    throw UsageError("--out: results cannot go to " + path_.string() + ": " + why);
  };
  std::error_code error;
  directory_ = system::Folder(path_, error);
  if (error) refuse(error.message());
  switch (lock_.take(directory_, kLockName, error)) {
    case system::LockFile::Taken::no:
      refuse(std::string(kLockName) + ": " + error.message());
      break;
    case system::LockFile::Taken::held_by_another: {
      read_lock_file();
      const std::string holder = announced_.empty() ? "" : announced_.front();
      refuse(process(holder) +
             " is writing its results there; name another folder with --out, or wait until it is "
             "done");
      break;
    }
    case system::LockFile::Taken::no_locks:
      warning_ = "the file system of " + path_.string() + " has no locks (" + error.message() +
                 "): nothing keeps another run from writing there at the same time";
      break;
    case system::LockFile::Taken::yes:
      break;
  }
  read_lock_file();
  if (!announced_.empty()) announced_.erase(announced_.begin());
  write_lock_file();
}

/// The process first, then a name a line.
void ResultFolder::read_lock_file() {
  std::istringstream lines(lock_.read());
  announced_.clear();
  for (std::string line; std::getline(lines, line);) announced_.push_back(line);
}

/// What cannot be written there (a full disk) is missed by nobody but a reader of messages.
void ResultFolder::write_lock_file() const {
  std::string text = std::to_string(system::process_id()) + "\n";
  for (const std::string& name : announced_) text += name + "\n";
  lock_.write(text);
}

ResultFolder::~ResultFolder() { release(); }

void ResultFolder::release() {
  const std::lock_guard lock(mutex_);
  give_back();
}

void ResultFolder::give_back() {
  if (std::exchange(released_, true)) return;
  lock_.release(directory_, kLockName);
  directory_.let_go();
  std::error_code error;
  for (auto place = made_.rbegin(); place != made_.rend() && !error; ++place)
    system::remove_empty_folder(*place, error);
}

void ResultFolder::clear() {
  const std::lock_guard lock(mutex_);
  remove_results();
  announced_.clear();
  write_lock_file();
  cleared_ = true;
}

void ResultFolder::announce(const std::vector<std::string>& names) {
  const std::lock_guard lock(mutex_);
  announced_ = names;
  write_lock_file();
}

/// Files that the study of an earlier `reproduce` names; a figure may have its picture beside it.
std::vector<std::string> ResultFolder::listed_by_study() const {
  using Json = nlohmann::json;
  std::ifstream in(path_ / "reproduce.json");
  const Json study = Json::parse(in, nullptr, false);
  const Json none = Json::array();
  std::vector<std::string> names;
  for (const Json& chapter : study.is_object() ? study.value("chapters", none) : none) {
    for (const char* kind : {"figures", "tables"}) {
      for (const Json& item : chapter.is_object() ? chapter.value(kind, none) : none) {
        const std::filesystem::path file = item.is_object() ? item.value("file", "") : "";
        names.push_back(file.string());
        if (file.extension() == ".svg") names.push_back(file.stem().string() + ".png");
      }
    }
  }
  return names;
}

void ResultFolder::remove_results() {
  std::vector<std::string> names = listed_by_study();
  names.insert(names.end(), announced_.begin(), announced_.end());
  std::erase_if(names, [](const std::string& name) { return !is_plain(name); });
  for (const char* last : kLast) remove_one(last);
  for (const auto& entry : std::filesystem::directory_iterator(path_)) {
    if (entry.is_directory() && !entry.is_symlink()) continue;
    const std::string name = entry.path().filename().string();
    if (is_result(name)) names.push_back(name);
  }
  for (const std::string& name : names) remove_one(name);
}

void ResultFolder::remove_one(const std::string& name) const {
  std::error_code error;
  directory_.remove(name, error);
  if (!error) return;
  throw OutputError("cannot remove " + (path_ / name).string() +
                    " of an earlier run: " + error.message());
}

bool ResultFolder::drop() {
  const std::lock_guard lock(mutex_);
  if (released_) return false;
  dropped_ = true;
  try {
    if (cleared_) remove_results();
  } catch (const std::exception&) {
    // What cannot be removed stays; there is nobody to tell.
  }
  give_back();
  return true;
}

void ResultFolder::write(const std::string& name, std::string_view text) {
  ResultFile file(*this, name);
  file.write(text);
  file.commit();
}

/// Fails once the results were dropped.
system::File ResultFolder::open(const std::string& temporary, std::error_code& error) {
  const std::lock_guard lock(mutex_);
  if (!dropped_) return directory_.create(temporary, error);
  error = std::make_error_code(std::errc::operation_canceled);
  return {};
}

void ResultFolder::commit(const std::string& temporary, const std::string& name,
                          std::error_code& error) {
  const std::lock_guard lock(mutex_);
  if (!dropped_) return directory_.rename(temporary, name, error);
  error = std::make_error_code(std::errc::operation_canceled);
}

void ResultFolder::remove(const std::string& temporary) const {
  std::error_code ignored;
  directory_.remove(temporary, ignored);
}

}  // namespace sunder::app
