// SPDX-License-Identifier: Apache-2.0
#include "app/output/result_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <regex>
#include <utility>

namespace sunder::app {
namespace {

constexpr std::size_t kBufferBytes = 1 << 16;
constexpr const char* kTemporarySuffix = ".partial";

}  // namespace

ResultFile::ResultFile(std::filesystem::path path)
    : path_(std::move(path)), temporary_(path_.string() + kTemporarySuffix) {
  descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail("create");
  buffer_.reserve(kBufferBytes);
}

ResultFile::~ResultFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  ::unlink(temporary_.c_str());
}

void ResultFile::write(std::string_view text) {
  buffer_.append(text);
  if (buffer_.size() >= kBufferBytes) flush();
}

void ResultFile::flush() {
  std::string_view rest = buffer_;
  while (!rest.empty()) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("write");
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
  buffer_.clear();
}

void ResultFile::commit() {
  flush();
  // close() may report what write() could only queue (NFS, quotas).
  if (::close(std::exchange(descriptor_, -1)) != 0) {
    const int cause = errno;
    ::unlink(temporary_.c_str());
    errno = cause;
    fail("write");
  }
  std::error_code renamed;
  std::filesystem::rename(temporary_, path_, renamed);
  if (!renamed) return;
  ::unlink(temporary_.c_str());
  errno = renamed.value();
  fail("name");
}

void ResultFile::fail(const char* doing) {
  throw OutputError(std::string("cannot ") + doing + " the result file " + path_.string() + ": " +
                    std::strerror(errno) + "; nothing half-written was left under this name");
}

void write_file(const std::filesystem::path& path, std::string_view text) {
  ResultFile file(path);
  file.write(text);
  file.commit();
}

void make_result_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const auto refuse = [&](const std::string& why) {
    throw UsageError("--out: results cannot go to " + folder.string() + ": " + why +
                     "; allowed is a folder that can be written to or created");
  };
  if (std::filesystem::exists(folder) && !std::filesystem::is_directory(folder))
    refuse("it is a file");
  if (error) refuse(error.message());
  if (::access(folder.c_str(), W_OK | X_OK) != 0) refuse(std::strerror(errno));
}

void remove_old_results(const std::filesystem::path& folder) {
  static const std::regex ours(
      "(summary\\.json|events\\.csv|frames\\.csv|tips\\.csv|series\\.pvd|figure\\.(svg|png)|"
      "index\\.html|"
      "result(_[0-9]+)?\\.vtu|snapshot_[0-9]+\\.(svg|png|vtu))(\\.partial)?");
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (!entry.is_regular_file() && !entry.is_symlink()) continue;
    if (!std::regex_match(entry.path().filename().string(), ours)) continue;
    std::error_code error;
    if (!std::filesystem::remove(entry.path(), error))
      throw OutputError("cannot remove " + entry.path().string() +
                        " of an earlier run: " + error.message());
  }
}

}  // namespace sunder::app
