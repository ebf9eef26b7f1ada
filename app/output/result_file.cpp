// SPDX-License-Identifier: Apache-2.0
#include "app/output/result_file.hpp"

#include <utility>

#include "app/output/result_folder.hpp"
#include "app/system/process.hpp"
#include "app/system/utf8_path.hpp"

namespace sunder::app {
namespace {

constexpr std::size_t kBufferBytes = 1 << 16;

}  // namespace

std::string temporary_name(const std::string& name) {
  return name + "." + std::to_string(system::process_id()) + ".partial";
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
  std::error_code error;
  file_ = folder_ ? folder_->open(temporary_, error)
                  : system::File(system::utf8_path(temporary_), system::File::Keep::nothing, error);
  if (error) fail("create", error);
  buffer_.reserve(kBufferBytes);
}

ResultFile::~ResultFile() {
  if (!file_.is_open()) return;
  std::error_code ignored;
  file_.close(ignored);
  remove();
}

void ResultFile::remove() const {
  std::error_code ignored;
  folder_ ? folder_->remove(temporary_)
          : static_cast<void>(std::filesystem::remove(system::utf8_path(temporary_), ignored));
}

void ResultFile::write(std::string_view text) {
  buffer_.append(text);
  if (buffer_.size() >= kBufferBytes) flush();
}

void ResultFile::flush() {
  std::error_code error;
  file_.append(buffer_, error);
  if (error) fail("write", error);
  buffer_.clear();
}

void ResultFile::commit() {
  flush();
  const char* doing = "write";
  std::error_code error;
  file_.close(error);  // may tell what writing could only queue (NFS, quotas)
  if (!error) {
    doing = "name";
    folder_ ? folder_->commit(temporary_, name_, error)
            : std::filesystem::rename(system::utf8_path(temporary_), path_, error);
  }
  if (!error) return;
  remove();
  fail(doing, error);
}

void ResultFile::fail(const char* doing, const std::error_code& error) const {
  throw OutputError(std::string("cannot ") + doing + " the result file " + path_.string() + ": " +
                    error.message() + "; nothing half-written was left under this name");
}

void write_file(const std::filesystem::path& path, std::string_view text) {
  ResultFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace sunder::app
