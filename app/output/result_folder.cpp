// SPDX-License-Identifier: Apache-2.0
#include "app/output/result_folder.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <utility>

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
  return !name.empty() && name.front() != '.' && name.find('/') == std::string::npos;
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
  if (::access(folder.c_str(), W_OK | X_OK) != 0) refuse(std::strerror(errno));
  return missing;
}

ResultFolder::ResultFolder(std::filesystem::path path)
    : path_(std::move(path)), made_(make_result_folder(path_)) {
  try {
    lock();
  } catch (...) {
    for (const int descriptor : {lock_, directory_})
      if (descriptor >= 0) ::close(descriptor);
    throw;
  }
}

/// On a file in the folder, opened by its descriptor: of a folder that is renamed or removed in the
/// meantime nothing lands in another one of its name.
void ResultFolder::lock() {
  const auto refuse = [&](const std::string& why) {
    throw UsageError("--out: results cannot go to " + path_.string() + ": " + why);
  };
  directory_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (directory_ < 0) refuse(std::strerror(errno));
  for (;;) {
    lock_ = ::openat(directory_, kLockName, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0666);
    if (lock_ < 0 && errno == EACCES)  // left by another user's run that was killed
      lock_ = ::openat(directory_, kLockName, O_RDONLY | O_CLOEXEC | O_NOFOLLOW);
    if (lock_ < 0) refuse(std::string(kLockName) + ": " + std::strerror(errno));
    if (::flock(lock_, LOCK_EX | LOCK_NB) != 0) {
      if (errno == EINTR) {
        ::close(std::exchange(lock_, -1));
        continue;
      }
      if (errno != EWOULDBLOCK) {
        warning_ = "the file system of " + path_.string() + " has no locks (" +
                   std::strerror(errno) +
                   "): nothing keeps another run from writing there at the same time";
        break;
      }
      read_lock_file();
      const std::string holder = announced_.empty() ? "" : announced_.front();
      refuse(process(holder) +
             " is writing its results there; name another folder with --out, or wait until it is "
             "done");
    }
    struct stat mine {
    }, there{};
    if (::fstat(lock_, &mine) == 0 &&
        ::fstatat(directory_, kLockName, &there, AT_SYMLINK_NOFOLLOW) == 0 &&
        mine.st_ino == there.st_ino && mine.st_dev == there.st_dev)
      break;
    ::close(std::exchange(lock_, -1));  // the run before gave it back in between
  }
  read_lock_file();
  if (!announced_.empty()) announced_.erase(announced_.begin());
  write_lock_file();
}

/// The process first, then a name a line.
void ResultFolder::read_lock_file() {
  std::string text;
  char buffer[4096];
  for (ssize_t got = 0;
       (got = ::pread(lock_, buffer, sizeof buffer, static_cast<off_t>(text.size()))) > 0;)
    text.append(buffer, static_cast<std::size_t>(got));
  std::istringstream lines(text);
  announced_.clear();
  for (std::string line; std::getline(lines, line);) announced_.push_back(line);
}

/// What cannot be written there (a full disk) is missed by nobody but a reader of messages.
void ResultFolder::write_lock_file() const {
  std::string text = std::to_string(::getpid()) + "\n";
  for (const std::string& name : announced_) text += name + "\n";
  if (::ftruncate(lock_, 0) != 0) return;
  if (::pwrite(lock_, text.data(), text.size(), 0) < 0) return;
}

ResultFolder::~ResultFolder() {
  release();
  ::close(lock_);
  ::close(directory_);
}

void ResultFolder::release() {
  const std::lock_guard lock(mutex_);
  give_back();
}

void ResultFolder::give_back() {
  if (std::exchange(released_, true)) return;
  ::unlinkat(directory_, kLockName, 0);
  ::flock(lock_, LOCK_UN);
  // Only empty ones go.
  for (auto place = made_.rbegin(); place != made_.rend() && ::rmdir(place->c_str()) == 0; ++place)
    ;
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
  if (::unlinkat(directory_, name.c_str(), 0) == 0 || errno == ENOENT || errno == EISDIR) return;
  throw OutputError("cannot remove " + (path_ / name).string() +
                    " of an earlier run: " + std::strerror(errno));
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

/// As ::openat; fails once the results were dropped.
int ResultFolder::open(const std::string& temporary) {
  const std::lock_guard lock(mutex_);
  if (dropped_) {
    errno = ECANCELED;
    return -1;
  }
  return ::openat(directory_, temporary.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
}

int ResultFolder::commit(const std::string& temporary, const std::string& name) {
  const std::lock_guard lock(mutex_);
  if (dropped_) {
    errno = ECANCELED;
    return -1;
  }
  return ::renameat(directory_, temporary.c_str(), directory_, name.c_str());
}

void ResultFolder::remove(const std::string& temporary) const {
  ::unlinkat(directory_, temporary.c_str(), 0);
}

}  // namespace sunder::app
