// SPDX-License-Identifier: Apache-2.0
// The files of a sweep: cells with commas, rows that are whole, and what makes two sweeps others.
#include <gtest/gtest.h>

#include "app/output/program.hpp"
#include "app/sweep/csv.hpp"
#include "app/sweep/description.hpp"
#include "app/sweep/rows.hpp"
#include "app/sweep/table.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

using namespace app::sweep;
using Cells = std::vector<std::string>;

TEST(SweepTables, CellsComeBackAsTheyWere) {
  EXPECT_EQ(csv_row({"a", "[0,1]", "say \"x\"", ""}), R"(a,"[0,1]","say ""x""",)");
  for (const Cells& cells :
       {Cells{"a", "[0,1]", "say \"x\"", ""}, Cells{""}, Cells{"", ""}, Cells{"\"", ",", "\",\""}})
    EXPECT_EQ(csv_cells(csv_row(cells)), cells);
  EXPECT_EQ(csv_row({"two\nlines"}), "\"two lines\"");
}

TEST(SweepTables, RowsCountOnceTheyHaveTheirEnd) {
  const TempFolder folder;
  {
    RowFile file(folder.path(), true);
    file.append("3,done,x");
    file.append("0,done,\"y,z\"");
  }
  write_text(folder / "sweep.rows",
             read_file(folder / "sweep.rows") + "7,too,many,cells\nnone,done,x\n2,don");
  const Rows rows = read_rows(folder.path(), 3);
  EXPECT_EQ(rows, (Rows{{0, "0,done,\"y,z\""}, {3, "3,done,x"}}));
  {
    RowFile file(folder.path(), false);  // goes on behind the last whole line
    file.append("2,done,x");
  }
  EXPECT_EQ(read_rows(folder.path(), 3).size(), 3U);
  RowFile anew(folder.path(), true);
  EXPECT_TRUE(read_rows(folder.path(), 3).empty());
}

Description described() {
  Description d;
  d.scene = "s.toml";
  d.text = "mesh = \"m.msh\"";
  d.meshes = {"m.msh 1"};
  d.overrides = {"time.steps=3"};
  d.axes = parse_axes({"a=1,2", "b=\"<x>\",y"});
  d.instruments = 1;
  d.part = {2, 3};
  return d;
}

TEST(SweepTables, ADescriptionComesBackAsItWas) {
  const TempFolder folder;
  EXPECT_FALSE(read_description(folder.path()));
  const Description d = described();
  write_text(folder / "sweep.json", d.json());
  const auto read = read_description(folder.path());
  ASSERT_TRUE(read);
  EXPECT_EQ(difference(d, *read), "");
  EXPECT_EQ(read->part.folder(), "part-2-of-3");
  EXPECT_EQ(read->instruments, 1);
  for (const char* wrong : {"", "{}", "[1]", "{\"version\": 1}", "{\"version\": 99}"}) {
    write_text(folder / "sweep.json", wrong);
    EXPECT_THROW(static_cast<void>(read_description(folder.path())), UsageError) << wrong;
  }
}

TEST(SweepTables, AnotherSweepIsTold) {
  const Description one = described();
  const auto told = [&](auto change) {
    Description other = described();
    change(other);
    return difference(one, other);
  };
  EXPECT_EQ(told([](Description& d) { d.part = {1, 3}; }), "");
  EXPECT_EQ(told([](Description& d) { d.axes.pop_back(); }), "it varies 1 keys and not 2");
  EXPECT_EQ(told([](Description& d) { d.axes[0].key = "c"; }), "it varies \"c\" and not \"a\"");
  EXPECT_EQ(told([](Description& d) { d.axes[1].values.pop_back(); }),
            "it has other values of \"b\"");
  EXPECT_EQ(told([](Description& d) { d.overrides.clear(); }), "it has other --set or options");
  EXPECT_EQ(told([](Description& d) { d.text += " "; }), "the scene has been changed since");
  EXPECT_EQ(told([](Description& d) { d.meshes[0] = "m.msh 2"; }),
            "the mesh has been changed since");
}

TEST(SweepTables, ThePageHoldsItsDataAndNothingElse) {
  const std::string page = sweep_html(described(), {}, "run 3 & 4 <missing>");
  EXPECT_NE(page.find("run 3 &amp; 4 &lt;missing&gt;"), std::string::npos);
  EXPECT_NE(page.find("const sweep = {"), std::string::npos);
  // Opens without a network, and no value ends the script.
  EXPECT_EQ(page.find("http"), std::string::npos);
  EXPECT_EQ(page.find("src="), std::string::npos);
  const std::string script = page.substr(page.find("const sweep"));
  EXPECT_EQ(script.substr(0, script.find('\n')).find('<'), std::string::npos);
}

}  // namespace
}  // namespace sunder::test
