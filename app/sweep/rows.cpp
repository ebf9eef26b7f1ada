// SPDX-License-Identifier: Apache-2.0
#include "app/sweep/rows.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <iterator>

#include "app/output/result_file.hpp"
#include "app/sweep/csv.hpp"

namespace sunder::app::sweep {
namespace {

constexpr const char* kRowFile = "sweep.rows";

std::string whole_lines(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  text.resize(text.rfind('\n') + 1);  // npos + 1 is 0
  return text;
}

}  // namespace

Rows read_rows(const std::filesystem::path& folder, std::size_t cells) {
  const std::string text = whole_lines(folder / kRowFile);
  Rows rows;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = text.find('\n', begin);
    std::string row = text.substr(begin, end - begin);
    begin = end + 1;
    const std::vector<std::string> found = csv_cells(row);
    RunIndex run = 0;
    const std::string& first = found.front();
    const auto [stopped, error] = std::from_chars(first.data(), first.data() + first.size(), run);
    if (found.size() != cells || error != std::errc() || *stopped != '\0') continue;
    rows.emplace(run, std::move(row));
  }
  return rows;
}

RowFile::RowFile(const std::filesystem::path& folder, bool anew) : path_(folder / kRowFile) {
  if (!anew) size_ = whole_lines(path_).size();
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0 || ::ftruncate(descriptor_, static_cast<off_t>(size_)) != 0) {
    throw OutputError("cannot create the result file " + path_.string() + ": " +
                      std::strerror(errno));
  }
}

RowFile::~RowFile() { ::close(descriptor_); }

void RowFile::append(const std::string& row) {
  const std::string line = row + "\n";
  for (std::size_t done = 0; done < line.size();) {
    const ssize_t written = ::pwrite(descriptor_, line.data() + done, line.size() - done,
                                     static_cast<off_t>(size_ + done));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int cause = errno;
      // What stays half-written has no end of line and counts for nothing.
      if (::ftruncate(descriptor_, static_cast<off_t>(size_)) != 0) errno = cause;
      throw OutputError("cannot write the result file " + path_.string() + ": " +
                        std::strerror(cause) + "; the runs before are in it, --resume goes on");
    }
    done += static_cast<std::size_t>(written);
  }
  size_ += line.size();
}

}  // namespace sunder::app::sweep
