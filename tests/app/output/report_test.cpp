// SPDX-License-Identifier: Apache-2.0
// index.html opens without a network and tells what there is to tell.
#include <gtest/gtest.h>

#include "app/output/program.hpp"

namespace sunder::test {
namespace {

TEST(Report, StandsAlone) {
  const std::string html = read_file(torn_board() / "index.html");
  EXPECT_EQ(html.find("http://"), html.find("http://www.w3.org/2000/svg"));  // a name, not a link
  EXPECT_EQ(html.find("https://"), std::string::npos);
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(html.find("<link"), std::string::npos);
  EXPECT_NE(html.find("Board &lt;pulled&gt; &amp; torn"), std::string::npos);
  EXPECT_EQ(html.find("<pulled>"), std::string::npos);
  for (const char* part : {"<svg", "data:image/png;base64,", "Fracture", "Cracks", "Events", "Time",
                           "median", "residual", "Left out", "Beyond small strain", "Warnings",
                           "Reactions", "right forceps", "Files", "summary.json"})
    EXPECT_NE(html.find(part), std::string::npos) << part;
}

}  // namespace
}  // namespace sunder::test
