// SPDX-License-Identifier: Apache-2.0
#include "app/input/msh_reader.hpp"

#include <map>
#include <set>
#include <utility>

#include "app/input/msh_contents.hpp"
#include "app/input/msh_sections.hpp"
#include "sunder/in_quotes.hpp"

namespace sunder::app {
namespace {

// $MeshFormat: "version type size", and in binary files the integer 1 to tell the byte order.
// Returns the major version.
int read_format(MshCursor& cursor) {
  const std::string version(cursor.word());
  if (version != "2.2" && version != "2.1" && version != "2" && version != "2.0" &&
      version != "4.1")
    cursor.fail(
        "the version is " + in_quotes(version, 20) +
        "; allowed: 1, 2.2 and 4.1 (gmsh OLD.msh -save -format msh41 -o NEW.msh makes one)");
  const std::int64_t type = cursor.text_integer("the file type");
  if (type != 0 && type != 1)
    cursor.fail("the file type is " + std::to_string(type) + "; allowed: 0 (ascii), 1 (binary)");
  const std::int64_t size = cursor.text_integer("the data size");
  if (size != 8) cursor.fail("the data size is " + std::to_string(size) + "; allowed: 8");
  if (type == 1) {
    cursor.set_binary(true);
    cursor.begin_binary_body();
    const int one = cursor.int32("the byte order mark");
    if (one != 1 && one != 0x01000000)
      cursor.fail("the byte order mark is neither 1 nor swapped 1");
    cursor.set_swapped(one != 1);
  }
  return version[0] - '0';
}

// "name" with quotes, from the rest of a line.
std::string quoted_name(const MshCursor& cursor, std::string_view rest) {
  const std::size_t begin = rest.find('"');
  const std::size_t end = begin == std::string_view::npos ? begin : rest.find('"', begin + 1);
  if (end == std::string_view::npos)
    cursor.fail("a physical name must stand in quotes: dimension tag \"name\"");
  return std::string(rest.substr(begin + 1, end - begin - 1));
}

// Always text, also in binary files.
void read_physical_names(MshCursor& cursor, std::vector<RawGroup>& groups) {
  const std::uint64_t count =
      cursor.check_count(cursor.text_integer("the number of names"), 2, "names");
  std::map<std::pair<std::int64_t, std::string>, std::int64_t> tags;
  std::set<std::pair<std::int64_t, std::int64_t>> named;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::int64_t dimension = cursor.text_integer("a dimension");
    const std::int64_t tag = cursor.text_integer("a physical tag");
    const std::string name = quoted_name(cursor, cursor.line());
    const char* kind = dimension == 3 ? "volume" : dimension == 2 ? "surface" : "group";
    const auto [other, fresh] = tags.try_emplace({dimension, name}, tag);
    if (!fresh && dimension >= 2)
      cursor.fail(std::string("the ") + kind + " " + in_quotes(name) + " is named twice (tags " +
                      std::to_string(other->second) + " and " + std::to_string(tag) + ")",
                  InputFault::duplicate_name);
    if (!named.insert({dimension, tag}).second)
      cursor.fail(
          std::string("the ") + kind + " with tag " + std::to_string(tag) + " has two names",
          InputFault::duplicate_name);
    if ((dimension == 2 || dimension == 3) && std::in_range<int>(tag))
      groups.push_back({static_cast<int>(dimension), static_cast<int>(tag), name});
  }
}

class MshReader {
 public:
  MshReader(std::string_view bytes, const std::string& name) : cursor_(bytes, name) {}

  RawMesh read() {
    read_first_section();
    while (next_section()) read_section();
    cursor_.set_section("");
    for (const std::string& needed : {nodes_name(), elements_name()}) {
      if (!seen_.contains(needed))
        cursor_.fail("the section " + needed +
                     " is missing: the file is truncated or holds no mesh");
    }
    contents_.finish();
    return std::move(contents_.mesh);
  }

 private:
  void read_first_section() {
    bool more = next_section();
    while (more && section_ == "$Comments") {
      skip_section();
      more = next_section();
    }
    if (section_ == "$NOD") {
      version_ = 1;
      read_section();
      return;
    }
    if (section_ != "$MeshFormat")
      cursor_.fail(
          "the file begins neither with $MeshFormat nor with $NOD: it is no .msh file of version "
          "1, 2.2 or 4.1");
    version_ = read_format(cursor_);
    close_section();
  }

  // Opens the next section; false at the end of the file.
  bool next_section() {
    cursor_.set_section("");
    section_ = std::string(cursor_.word().substr(0, 60));
    if (section_.empty()) return false;
    if (section_[0] != '$' || section_.starts_with("$End") || section_.starts_with("$END"))
      cursor_.fail("expected the begin of a section ($...)");
    cursor_.set_section(section_);
    static const std::set<std::string> once = {
        "$MeshFormat", "$PhysicalNames", "$Entities", "$PartitionedEntities",
        "$Nodes",      "$Elements",      "$NOD",      "$ELM"};
    if (once.contains(section_) && !seen_.insert(section_).second)
      cursor_.fail("the section occurs twice");
    return true;
  }

  [[nodiscard]] std::string nodes_name() const { return version_ == 1 ? "$NOD" : "$Nodes"; }
  [[nodiscard]] std::string elements_name() const { return version_ == 1 ? "$ELM" : "$Elements"; }
  [[nodiscard]] std::string end_name() const {
    return (version_ == 1 ? "$END" : "$End") + section_.substr(1);
  }

  void read_section() {
    if (version_ == 1 && section_ == "$NOD") {
      read_nodes_1(cursor_, contents_);
    } else if (version_ == 1 && section_ == "$ELM") {
      read_elements_1(cursor_, contents_);
    } else if (section_ == "$PhysicalNames") {
      read_physical_names(cursor_, contents_.mesh.groups);
    } else if (version_ == 4 && (section_ == "$Entities" || section_ == "$PartitionedEntities")) {
      read_entities();
    } else if (version_ != 1 && section_ == "$Nodes") {
      version_ == 4 ? read_nodes_4(cursor_, contents_) : read_nodes_2(cursor_, contents_);
    } else if (version_ != 1 && section_ == "$Elements") {
      if (!seen_.contains("$Nodes")) cursor_.fail("stands before $Nodes");
      version_ == 4 ? read_elements_4(cursor_, contents_) : read_elements_2(cursor_, contents_);
    } else {
      skip_section();
      return;
    }
    close_section();
  }

  void read_entities() {
    if (seen_.contains("$Elements")) cursor_.fail("stands behind $Elements");
    section_ == "$Entities" ? read_entities_4(cursor_, contents_)
                            : read_partitioned_entities_4(cursor_, contents_);
  }

  void close_section() {
    const std::string end = end_name();
    if (cursor_.word() != end)
      cursor_.fail("it is not closed by " + end +
                   " where it should end: a count is wrong or the file is truncated");
  }

  void skip_section() {
    const std::string end = end_name();
    if (!cursor_.skip_past_line(end))
      cursor_.fail("it is not closed by " + end + ": the file is truncated");
  }

  MshCursor cursor_;
  MshContents contents_;
  std::string section_;
  std::set<std::string> seen_;
  int version_ = 0;
};

}  // namespace

RawMesh read_msh(std::string_view bytes, const std::string& name) {
  return MshReader(bytes, name).read();
}

}  // namespace sunder::app
