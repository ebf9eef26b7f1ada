// SPDX-License-Identifier: Apache-2.0
// The folder of one run's results. It belongs to one process at a time and holds at any moment the
// files of one run or none.
#pragma once

#include <filesystem>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "app/output/result_file.hpp"
#include "app/system/folder.hpp"
#include "app/system/lock_file.hpp"

namespace sunder::app {

/// Makes the folder for results and checks that files can be created in it. Throws UsageError,
/// since the folder is what the user asked for with --out. Returns the folders that were made, the
/// outermost first.
std::vector<std::filesystem::path> make_result_folder(const std::filesystem::path& folder);

class ResultFolder {
 public:
  /// Makes and locks it; what lies in it stays. Throws UsageError where another process writes its
  /// results there. The system frees the lock when the process ends, however it ends.
  explicit ResultFolder(std::filesystem::path path);
  ~ResultFolder();  ///< as release()
  ResultFolder(const ResultFolder&) = delete;
  ResultFolder& operator=(const ResultFolder&) = delete;

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  /// Says so where the file system has no locks.
  [[nodiscard]] const std::optional<std::string>& warning() const { return warning_; }

  /// Removes what earlier runs left under the names of result files and half-written, whichever
  /// command wrote them; other files stay. From here on the folder is this run's.
  void clear();
  /// Names of files to be written that clear() would not know by themselves: they are kept in the
  /// lock file until the run is done, so that the next one removes those of a killed one.
  void announce(const std::vector<std::string>& names);
  /// Writes a whole file.
  void write(const std::string& name, std::string_view text);
  /// This run is done: gives the lock back, and takes the folder away if it was made here and
  /// nothing is in it. From here on drop() does nothing.
  void release();
  /// Takes back everything that was written since clear(), and the folder if it was made here.
  /// Files that another thread writes at that moment never appear. False: this run was done, and
  /// what it wrote stays.
  bool drop();

 private:
  friend class ResultFile;
  system::File open(const std::string& temporary, std::error_code& error);
  void commit(const std::string& temporary, const std::string& name, std::error_code& error);
  void remove(const std::string& temporary) const;

  void lock();
  void read_lock_file();
  void write_lock_file() const;
  void remove_results();
  void remove_one(const std::string& name) const;
  void give_back();  // once
  [[nodiscard]] std::vector<std::string> listed_by_study() const;

  std::filesystem::path path_;
  std::vector<std::filesystem::path> made_;
  system::Folder directory_;
  system::LockFile lock_;
  std::optional<std::string> warning_;
  std::mutex mutex_;
  std::vector<std::string> announced_;
  bool cleared_ = false, dropped_ = false, released_ = false;
};

}  // namespace sunder::app
