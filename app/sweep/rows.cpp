// SPDX-License-Identifier: Apache-2.0
#include "app/sweep/rows.hpp"

#include <charconv>
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
  std::error_code error;
  file_ = system::File(path_, system::File::Keep::contents, error);
  if (!error) file_.resize(size_, error);
  if (error) {
    throw OutputError("cannot create the result file " + path_.string() + ": " + error.message());
  }
}

void RowFile::append(const std::string& row) {
  const std::string line = row + "\n";
  std::error_code error;
  file_.write(size_, line, error);
  if (error) {
    std::error_code ignored;  // what stays half-written has no end of line and counts for nothing
    file_.resize(size_, ignored);
    throw OutputError("cannot write the result file " + path_.string() + ": " + error.message() +
                      "; the runs before are in it, --resume goes on");
  }
  size_ += line.size();
}

}  // namespace sunder::app::sweep
