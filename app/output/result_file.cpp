// SPDX-License-Identifier: Apache-2.0
#include "app/output/result_file.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <utility>

#include "app/output/result_folder.hpp"

namespace sunder::app {
namespace {

constexpr std::size_t kBufferBytes = 1 << 16;

}  // namespace

std::string temporary_name(const std::string& name) {
  return name + "." + std::to_string(::getpid()) + ".partial";
}

ResultFile::ResultFile(std::filesystem::path path)
    : path_(std::move(path)), name_(path_.string()), temporary_(temporary_name(name_)) {
  open();
}

ResultFile::ResultFile(ResultFolder& folder, const std::string& name)
    : path_(folder.path() / name), folder_(&folder), name_(name), temporary_(temporary_name(name)) {
  open();
}

void ResultFile::open() {
  descriptor_ = folder_
                    ? folder_->open(temporary_)
                    : ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail("create");
  buffer_.reserve(kBufferBytes);
}

ResultFile::~ResultFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  remove();
}

void ResultFile::remove() const {
  folder_ ? folder_->remove(temporary_) : static_cast<void>(::unlink(temporary_.c_str()));
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
  const bool closed = ::close(std::exchange(descriptor_, -1)) == 0;
  const int renamed = !closed   ? -1
                      : folder_ ? folder_->commit(temporary_, name_)
                                : std::rename(temporary_.c_str(), name_.c_str());
  if (renamed == 0) return;
  const int cause = errno;
  remove();
  errno = cause;
  fail(closed ? "name" : "write");
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

}  // namespace sunder::app
