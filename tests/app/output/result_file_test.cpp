// SPDX-License-Identifier: Apache-2.0
#include "app/output/result_file.hpp"

#include <gtest/gtest.h>

#include "app/output/program.hpp"

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
  EXPECT_EQ(names_in(folder.path()), std::vector<std::string>{"a.txt.partial"});
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
  for (const char* name : {"summary.json", "events.csv", "frames.csv.partial", "result_0007.vtu",
                           "snapshot_40.png", "index.html", "notes.txt", "result_x.vtu",
                           "my_summary.json", "tips.csv", "tips.csv.partial"})
    test::write_text(folder / name, "x");
  remove_old_results(folder.path());
  EXPECT_EQ(names_in(folder.path()),
            (std::vector<std::string>{"my_summary.json", "notes.txt", "result_x.vtu"}));
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
