// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "app/input/nearest.hpp"
#include "app/input/raw_mesh.hpp"
#include "app/input/tag_index.hpp"
#include "sunder/error.hpp"

namespace sunder::test {
namespace {

TEST(Nearest, FindsTypos) {
  const std::vector<std::string> known = {"young", "poisson", "yield"};
  EXPECT_EQ(app::nearest("yuong", known), "young");
  EXPECT_EQ(app::nearest("poison", known), "poisson");
  EXPECT_EQ(app::nearest("density", known), "");
  EXPECT_EQ(app::nearest(std::string(100'000, 'x'), known), "");
  EXPECT_EQ(app::quoted_list({"a", "b", "c"}), "\"a\", \"b\" or \"c\"");
  EXPECT_EQ(app::quoted_list({}), "");
}

TEST(InQuotes, IsOneLineOfBoundedLength) {
  EXPECT_EQ(in_quotes("upper"), "\"upper\"");
  EXPECT_EQ(in_quotes(std::string_view("a\n\r\t\0\x1b\x7f", 7)), R"("a\n\r\t\u0000\u001b\u007f")");
  EXPECT_EQ(in_quotes("\xc2\x9b"
                      "2J \xc2\xb5m"),
            "\"\\u009b2J \xc2\xb5m\"");  // C1's CSI; the micro sign stays
  EXPECT_EQ(in_quotes("abcdef", 4), "\"abcd...\"");
  EXPECT_EQ(in_quotes("ab\xc3\xa4z", 3), "\"ab...\"");  // never half a character
  EXPECT_EQ(in_quotes("", 0), "\"\"");
}

TEST(Errors, KeepTheirWholeMessageOnOneLine) {
  const InputError error(InputFault::syntax, std::string("\0one\ntwo", 8));
  EXPECT_STREQ(error.what(), "\\u0000one\\ntwo");
}

TEST(TagIndex, DenseAndSparse) {
  for (const std::uint64_t offset : {std::uint64_t{0}, std::uint64_t{1} << 40U}) {
    const std::vector<std::uint64_t> tags = {offset + 5, offset + 2, offset + 9};
    const app::TagIndex index(tags);
    EXPECT_EQ(index.find(offset + 5), 0U);
    EXPECT_EQ(index.find(offset + 9), 2U);
    EXPECT_FALSE(index.find(offset + 4).has_value());
    EXPECT_FALSE(index.find(offset + 100).has_value());
    EXPECT_FALSE(index.duplicate().has_value());
    const app::TagIndex twice(std::vector<std::uint64_t>{offset + 3, offset + 1, offset + 3});
    EXPECT_EQ(twice.duplicate(), offset + 3);
  }
  EXPECT_FALSE(app::TagIndex({}).find(0).has_value());
}

TEST(RawMesh, ThroughAPipeAndCutShort) {
  app::RawMesh mesh;
  mesh.node_tags = {1, 2, 3, 4};
  mesh.coordinates = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  mesh.tet_tags = {7};
  mesh.tet_nodes = {1, 2, 3, 4};
  mesh.tet_group = {3};
  mesh.groups = {{3, 3, "body"}};
  mesh.other_name = "Hexahedron 8";
  const std::string bytes = app::to_bytes(mesh);
  const auto back = app::from_bytes(bytes);
  ASSERT_TRUE(back.has_value());
  EXPECT_EQ(back->coordinates, mesh.coordinates);
  EXPECT_EQ(back->groups.at(0).name, "body");
  EXPECT_EQ(back->other_name, "Hexahedron 8");
  for (std::size_t cut = 0; cut < bytes.size(); ++cut)
    ASSERT_FALSE(app::from_bytes(std::string_view(bytes).substr(0, cut)).has_value()) << cut;
}

}  // namespace
}  // namespace sunder::test
