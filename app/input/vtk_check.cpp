// SPDX-License-Identifier: Apache-2.0
#include "app/input/vtk_check.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "app/input/msh_cursor.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/words.hpp"

namespace sunder::app {
namespace {

constexpr int kTetrahedron = 10, kQuadraticTetrahedron = 24;  // VTK's cell types
constexpr int kLagrangeTetrahedron = 71, kBezierTetrahedron = 78;

struct NumberType {
  std::string_view name;
  std::size_t bytes;
  bool integer;
};

constexpr std::array<NumberType, 11> kNumberTypes = {{{"float", 4, false},
                                                      {"double", 8, false},
                                                      {"char", 1, true},
                                                      {"unsigned_char", 1, true},
                                                      {"short", 2, true},
                                                      {"unsigned_short", 2, true},
                                                      {"int", 4, true},
                                                      {"unsigned_int", 4, true},
                                                      {"long", 8, true},
                                                      {"unsigned_long", 8, true},
                                                      {"vtktypeint64", 8, true}}};

class VtkReader {
 public:
  VtkReader(std::string_view bytes, const std::string& name) : cursor_(bytes, name) {}

  VtkContents read() {
    read_header();
    while (true) {
      const std::string section(cursor_.word().substr(0, 40));
      if (section.empty()) break;
      cursor_.set_section(section);
      if (!read_section(section)) break;
    }
    cursor_.set_section("");
    if (!has_points_ || !has_cells_ || !has_types_)
      cursor_.fail(std::string("the section ") +
                   (!has_points_  ? "POINTS"
                    : !has_cells_ ? "CELLS"
                                  : "CELL_TYPES") +
                   " is missing: the file is truncated or holds no mesh");
    keep_tags();
    return std::move(contents_);
  }

 private:
  void read_header() {
    const std::string_view first = cursor_.line();
    constexpr std::string_view head = "# vtk DataFile Version ";
    if (!first.starts_with(head))
      cursor_.fail("the first line is not \"# vtk DataFile Version ...\": no legacy .vtk file");
    const std::string_view version = first.substr(head.size());
    if (version.empty() || version[0] < '1' || version[0] > '4')
      cursor_.fail("the version is " + in_quotes(version, 10) +
                   "; allowed: 1.0 to 4.2 (save as \"legacy\" version 4.2 or older)");
    cursor_.skip_rest_of_line();  // title
    const std::string format(cursor_.word().substr(0, 20));
    if (format != "ASCII" && format != "BINARY")
      cursor_.fail("the format is " + in_quotes(format) + "; allowed: ASCII and BINARY");
    binary_ = format == "BINARY";
    const std::string keyword(cursor_.word().substr(0, 20));
    const std::string dataset(cursor_.word().substr(0, 40));
    if (keyword != "DATASET" || dataset != "UNSTRUCTURED_GRID")
      cursor_.fail("the data set is " + in_quotes(dataset) +
                   "; allowed: DATASET UNSTRUCTURED_GRID");
  }

  // False: an attribute that is not read, and nothing behind it is.
  bool read_section(const std::string& section) {
    if (section == "POINTS") {
      read_points();
    } else if (section == "CELLS") {
      read_cells();
    } else if (section == "CELL_TYPES") {
      read_types();
    } else if (section == "CELL_DATA") {
      const std::uint64_t count = read_count("cells");
      if (count != cell_count_)
        cursor_.fail("is for " + cells(count) + "; the file has " + std::to_string(cell_count_));
      in_cell_data_ = true;
    } else if (in_cell_data_ && section == "SCALARS") {
      read_scalars();
    } else if (in_cell_data_ && section == "FIELD") {
      read_field();
    } else {
      return false;
    }
    return true;
  }

  static std::string cells(std::uint64_t count) {
    return sunder::count_of(static_cast<long long>(count), "cell");
  }

  std::uint64_t read_count(const char* what) {
    return cursor_.check_count(cursor_.text_integer("a count"), 1, what);
  }

  NumberType number_type() {
    const std::string word(cursor_.word().substr(0, 20));
    for (const NumberType& type : kNumberTypes) {
      if (type.name == word) return type;
    }
    cursor_.fail("the number type " + in_quotes(word) + " is not known");
  }

  void begin_body() {
    if (!binary_) return;
    cursor_.skip_rest_of_line();
    cursor_.set_binary(true);
    cursor_.set_swapped(std::endian::native == std::endian::little);  // .vtk is big-endian
  }
  void end_body() { cursor_.set_binary(false); }

  double real(const NumberType& type, const char* what) {
    if (!binary_ || type.bytes == 8) return cursor_.real(what);
    const double value = cursor_.raw<float>(what);
    if (!(std::abs(value) <= std::numeric_limits<double>::max()))
      cursor_.fail(std::string(what) + " is not finite; allowed: finite numbers",
                   InputFault::out_of_range);
    return value;
  }

  std::int64_t integer(const NumberType& type, const char* what) {
    if (!binary_) return cursor_.text_integer(what);
    switch (type.bytes) {
      case 1:
        return cursor_.raw<std::int8_t>(what);
      case 2:
        return cursor_.raw<std::int16_t>(what);
      case 4:
        return cursor_.raw<std::int32_t>(what);
      default:
        return cursor_.raw<std::int64_t>(what);
    }
  }

  void once(bool& flag) {
    if (flag) cursor_.fail("the section occurs twice");
    flag = true;
  }

  void read_points() {
    once(has_points_);
    contents_.points = read_count("points");
    const NumberType type = number_type();
    if (type.integer) cursor_.fail("points must be float or double");
    begin_body();
    for (std::uint64_t i = 0; i < 3 * contents_.points; ++i)
      static_cast<void>(real(type, "a point's coordinate"));
    end_body();
  }

  void read_cells() {
    if (!has_points_) cursor_.fail("stands before POINTS");
    once(has_cells_);
    cell_count_ = read_count("cells");
    std::uint64_t left = read_count("cell entries");
    begin_body();
    for (std::uint64_t i = 0; i < cell_count_; ++i) {
      const int nodes = cursor_.int32("a number of points");
      if (nodes < 1 || static_cast<std::uint64_t>(nodes) + 1 > left)
        cursor_.fail("cell " + std::to_string(i) + " with " + count_of(nodes, "point") +
                     " does not fit the number of entries declared");
      left -= static_cast<std::uint64_t>(nodes) + 1;
      for (int n = 0; n < nodes; ++n) check_point(i, cursor_.int32("a point of a cell"));
    }
    if (left != 0)
      cursor_.fail("declares " +
                   sunder::count_of(static_cast<long long>(left), "entry", "entries") +
                   " more than its cells have");
    end_body();
  }

  void check_point(std::uint64_t cell, int point) {
    if (point < 0 || static_cast<std::uint64_t>(point) >= contents_.points)
      cursor_.fail("cell " + std::to_string(cell) + " uses point " + std::to_string(point) +
                       "; allowed: 0 to " + std::to_string(contents_.points - 1),
                   InputFault::bad_id);
  }

  void read_types() {
    once(has_types_);
    const std::uint64_t count = read_count("cell types");
    if (!has_cells_ || count != cell_count_)
      cursor_.fail("has " + sunder::count_of(static_cast<long long>(count), "type") + " for " +
                   cells(cell_count_));
    begin_body();
    for (std::uint64_t i = 0; i < count; ++i) {
      const int type = cursor_.int32("a cell type");
      is_tet_.push_back(type == kTetrahedron || type == kQuadraticTetrahedron);
      if (type == kTetrahedron) ++contents_.first_order;
      if (type == kLagrangeTetrahedron || type == kBezierTetrahedron) ++contents_.unread;
      if (is_tet_.back()) ++contents_.tetrahedra;
    }
    end_body();
  }

  void read_values(const std::string& name, const NumberType& type, std::uint64_t components,
                   std::uint64_t tuples) {
    begin_body();
    const bool wanted = type.integer && components == 1 && tuples == cell_count_ &&
                        cell_tags_.empty() && names_volumes(name);
    for (std::uint64_t i = 0; i < tuples * components; ++i) {
      if (!type.integer) {
        binary_ ? skip_bytes(type.bytes) : static_cast<void>(cursor_.word());
        continue;
      }
      const std::int64_t value = integer(type, "a cell's value");
      if (!wanted) continue;
      if (value < 0 || value > std::numeric_limits<int>::max())
        cursor_.fail(in_quotes(name) + " has the value " + std::to_string(value) +
                         "; allowed as a volume's tag: 0 to 2147483647",
                     InputFault::bad_id);
      cell_tags_.push_back(static_cast<int>(value));
    }
    end_body();
  }

  void skip_bytes(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) static_cast<void>(cursor_.raw<char>("a cell's value"));
  }

  // SCALARS name type [components], LOOKUP_TABLE name, values
  void read_scalars() {
    const std::string name(cursor_.word().substr(0, 100));
    const NumberType type = number_type();
    const std::string_view rest = cursor_.line();
    std::uint64_t components = 1;
    for (const char c : rest) {
      if (c >= '1' && c <= '4') components = static_cast<std::uint64_t>(c - '0');
    }
    if (cursor_.word() != "LOOKUP_TABLE")
      cursor_.fail("expected LOOKUP_TABLE: the file is truncated or damaged");
    static_cast<void>(cursor_.word());
    read_values(name, type, components, cell_count_);
  }

  // FIELD name arrays, each: name components tuples type, values
  void read_field() {
    static_cast<void>(cursor_.word());
    const std::uint64_t arrays = read_count("arrays");
    for (std::uint64_t i = 0; i < arrays; ++i) {
      const std::string name(cursor_.word().substr(0, 100));
      const std::uint64_t components = read_count("components");
      const std::uint64_t tuples = read_count("tuples");
      const NumberType type = number_type();
      if (components > 1000) cursor_.fail("more than 1000 components");
      static_cast<void>(
          cursor_.check_count(static_cast<std::int64_t>(components * tuples), 1, "values"));
      read_values(name, type, components, tuples);
    }
  }

  void keep_tags() {
    for (std::size_t i = 0; i < cell_tags_.size(); ++i) {
      if (is_tet_[i]) contents_.tet_tags.push_back(cell_tags_[i]);
    }
  }

  MshCursor cursor_;
  VtkContents contents_;
  std::uint64_t cell_count_ = 0;
  std::vector<bool> is_tet_;
  std::vector<int> cell_tags_;
  bool binary_ = false;
  bool has_points_ = false, has_cells_ = false, has_types_ = false, in_cell_data_ = false;
};

}  // namespace

bool names_volumes(std::string_view name) {
  constexpr std::array<std::string_view, 7> names = {
      "CellEntityIds", "gmsh:physical", "volume", "region", "material", "cell_tags", "medit:ref"};
  return std::find(names.begin(), names.end(), name) != names.end();
}

VtkContents check_vtk(std::string_view bytes, const std::string& name) {
  return VtkReader(bytes, name).read();
}

}  // namespace sunder::app
