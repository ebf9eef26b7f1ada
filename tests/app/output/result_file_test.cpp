// SPDX-License-Identifier: Apache-2.0
#include "app/output/result_file.hpp"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

#include "app/output/program.hpp"
#include "app/output/result_folder.hpp"

namespace {
bool no_locks = false;
}

/// In place of the system's: as on a file system without locks where a test says so.
extern "C" int flock(int descriptor, int operation) noexcept {
  if (!no_locks) return static_cast<int>(::syscall(SYS_flock, descriptor, operation));
  errno = ENOLCK;
  return -1;
}

namespace sunder::app {
namespace {

using test::names_in;
using test::read_file;
using test::TempFolder;

TEST(ResultFile, AppearsWhenCommitted) {
  const TempFolder folder;
  ResultFile file(folder / "a.txt");
  file.write("first ");
  file.flush();
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{temporary_name("a.txt")});
  file.write("second");
  file.commit();
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"a.txt"});
  EXPECT_EQ(read_file(folder / "a.txt"), "first second");
}

TEST(ResultFile, VanishesWhenNotCommitted) {
  const TempFolder folder;
  test::write_text(folder / "a.txt", "old");
  {
    ResultFile file(folder / "a.txt");
    file.write(std::string(200000, 'x'));
  }
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"a.txt"});
  EXPECT_EQ(read_file(folder / "a.txt"), "old");
}

TEST(ResultFile, NamesFileAndCause) {
  const TempFolder folder;
  try {
    write_file(folder / "missing" / "a.txt", "x");
    FAIL() << "a file in a folder that does not exist";
  } catch (const OutputError& error) {
    EXPECT_EQ(error.exit_code(), 1);
    EXPECT_NE(std::string(error.what()).find("missing/a.txt: No such file"), std::string::npos)
        << error.what();
  }
}

TEST(ResultFile, CannotReplaceAFolder) {
  const TempFolder folder;
  std::filesystem::create_directories(folder / "a.txt" / "inner");
  EXPECT_THROW(write_file(folder / "a.txt", "x"), OutputError);
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"a.txt"});
}

TEST(ResultFolder, OldResultsGoAndOtherFilesStay) {
  const TempFolder folder;
  for (const char* name :
       {"summary.json", "events.csv", "frames.csv.partial", "frames.csv.4711.partial", "tips.csv",
        "tips.csv.4711.partial", "result_0007.vtu", "cracks.vtu", "cracks_0007.vtu",
        "snapshot_40.png", "index.html", "notes.txt", "result_x.vtu", "my_summary.json"})
    test::write_text(folder / name, "x");
  ResultFolder(folder.path()).clear();
  EXPECT_EQ(names_in(folder.path()),
            (std::vector<std::string>{"my_summary.json", "notes.txt", "result_x.vtu"}));
}

TEST(ResultFolder, FilesOfAStudyGoByItsOwnList) {
  const TempFolder folder;
  for (const char* name : {"index.html", "reproduction.md", "sweep.csv", "sweep.svg",
                           "experiment-1.svg", "experiment-1.png", "mine.csv", "outside.csv"})
    test::write_text(folder / name, "x");
  std::filesystem::create_directory(folder / "inner");
  test::write_text(
      folder / "reproduce.json",
      R"({"chapters": [{"figures": [{"file": "sweep.svg"}, {"file": "experiment-1.svg"}],
                       "tables": [{"file": "sweep.csv"}, {"file": "inner/../outside.csv"}]}, 7]})");
  ResultFolder(folder.path()).clear();
  EXPECT_EQ(names_in(folder.path()),
            (std::vector<std::string>{"inner", "mine.csv", "outside.csv"}));
}

TEST(ResultFolder, AnnouncedFilesOfAKilledRunGo) {
  const TempFolder folder;
  test::write_text(folder / "mine.csv", "x");
  const pid_t child = fork();
  if (child == 0) {  // is killed in the middle of its files
    ResultFolder killed(folder.path());
    killed.clear();
    killed.announce({"sweep.csv", "reproduce.json"});
    killed.write("sweep.csv", "half of a study");
    raise(SIGKILL);
  }
  waitpid(child, nullptr, 0);
  EXPECT_TRUE(std::filesystem::exists(folder / "sweep.csv"));
  {
    ResultFolder next(folder.path());  // nothing goes before the next one has something
    EXPECT_TRUE(std::filesystem::exists(folder / "sweep.csv"));
    next.clear();
  }
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"mine.csv"});
}

TEST(ResultFolder, BelongsToOneAtATime) {
  const TempFolder folder;
  {
    const ResultFolder first(folder / "real");
    std::filesystem::create_directory_symlink(folder / "real", folder / "link");
    for (const char* name : {"real", "link"}) {
      try {
        const ResultFolder second(folder / name);
        FAIL() << "two in one folder, by " << name;
      } catch (const UsageError& error) {
        EXPECT_EQ(std::string(error.what()),
                  "--out: results cannot go to " + (folder / name).string() + ": process " +
                      std::to_string(getpid()) +
                      " is writing its results there; name another folder with --out, or wait "
                      "until it is done");
      }
    }
  }
  // What was made and stayed empty is gone again; a lock file without a process is no lock.
  EXPECT_FALSE(std::filesystem::exists(folder / "real"));
  std::filesystem::create_directory(folder / "real");
  test::write_text(folder / "real/.sunder-lock", "1\n");
  ResultFolder next(folder / "link");
  next.write("summary.json", "{}");
  EXPECT_TRUE(std::filesystem::exists(folder / "real/summary.json"));
}

TEST(ResultFolder, NothingLandsInAnotherFolderOfItsName) {
  const TempFolder folder;
  ResultFolder moved(folder / "out");
  std::filesystem::rename(folder / "out", folder / "kept");
  ResultFolder other(folder / "out");
  moved.write("events.csv", "of the first");
  other.write("frames.csv", "of the second");
  EXPECT_EQ(names_in(folder / "kept"), (std::vector<std::string>{".sunder-lock", "events.csv"}));
  EXPECT_EQ(names_in(folder / "out"), (std::vector<std::string>{".sunder-lock", "frames.csv"}));
}

TEST(ResultFolder, RemovedMeanwhileIsAnError) {
  const TempFolder folder;
  ResultFolder gone(folder / "out");
  std::filesystem::remove_all(folder / "out");
  EXPECT_THROW(gone.write("events.csv", "x"), OutputError);
}

TEST(ResultFolder, DroppedResultsAreGoneAndNoneFollows) {
  const TempFolder folder;
  {
    ResultFolder results(folder / "a/b");
    results.clear();
    results.write("events.csv", "x");
    ResultFile open(results, "frames.csv");
    open.write("x");
    open.flush();
    EXPECT_TRUE(results.drop());
    EXPECT_FALSE(std::filesystem::exists(folder / "a"));
    EXPECT_THROW(open.commit(), OutputError);
    EXPECT_THROW(results.write("summary.json", "x"), OutputError);
  }
  EXPECT_TRUE(names_in(folder.path()).empty());
  // What is done is not taken back.
  {
    ResultFolder done(folder.path());
    done.clear();
    done.write("summary.json", "x");
    done.release();
    EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"summary.json"});
    const ResultFolder next(folder.path());
    EXPECT_FALSE(done.drop());
  }
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"summary.json"});
  std::filesystem::remove(folder / "summary.json");
  // Before clear() what lies there is an earlier run's.
  test::write_text(folder / "events.csv", "x");
  ResultFolder(folder.path()).drop();
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"events.csv"});
}

TEST(ResultFolder, OnAFileSystemWithoutLocksWarns) {
  const TempFolder folder;
  {
    const ResultFolder locked(folder / "a");
    EXPECT_FALSE(locked.warning());
  }
  no_locks = true;
  const ResultFolder results(folder / "b");
  no_locks = false;
  ASSERT_TRUE(results.warning());
  EXPECT_NE(results.warning()->find("has no locks (No locks available): nothing keeps another run"),
            std::string::npos)
      << *results.warning();
}

TEST(ResultFolder, IsMadeWithItsParents) {
  const TempFolder folder;
  make_result_folder(folder / "a/b/c");
  EXPECT_TRUE(std::filesystem::is_directory(folder / "a/b/c"));
  test::write_text(folder / "file", "x");
  EXPECT_THROW(make_result_folder(folder / "file"), UsageError);
  EXPECT_THROW(make_result_folder(folder / "file/below"), UsageError);
}

}  // namespace
}  // namespace sunder::app
