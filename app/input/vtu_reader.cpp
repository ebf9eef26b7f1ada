// SPDX-License-Identifier: Apache-2.0
#include "app/input/vtu_reader.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "app/input/vtk_check.hpp"
#include "app/input/vtu_array.hpp"
#include "app/input/xml_tags.hpp"
#include "sunder/in_quotes.hpp"
#include "sunder/words.hpp"

namespace sunder::app {
namespace {

constexpr std::int64_t kTetra = 10, kQuadraticTetra = 24, kLagrangeTetra = 71;  // VTK's cell types

/// Solids that are no tetrahedra: voxel to pyramid, the quadratic ones, Lagrange and Bezier.
bool other_solid(std::int64_t type) {
  return (type >= 11 && type <= 16) || (type >= 25 && type <= 27) || type == 29 || type == 32 ||
         type == 33 || type == 37 || type == 42 || (type >= 72 && type <= 74) ||
         (type >= 78 && type <= 81);
}

class VtuReader {
 public:
  VtuReader(std::string_view bytes, const std::string& name)
      : bytes_(bytes), name_(name), tags_(bytes, name) {}

  RawMesh read() {
    read_file_tag();
    while (const auto tag = tags_.next()) {
      if (!read_tag(*tag)) break;
    }
    check_end();
    if (!points_ || !cells_) fail("has no Piece: the file is truncated or holds no mesh");
    read_points();
    read_cells();
    read_names();
    read_fields();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& message,
                         InputFault fault = InputFault::unreadable_file) const {
    throw InputError(fault, name_ + ": " + message);
  }

  void read_file_tag() {
    const auto file = tags_.next();
    if (!file || file->name != "VTKFile")
      fail("does not begin with <VTKFile>: it is no XML file of VTK");
    const std::string type = file->attribute("type");
    if (type != "UnstructuredGrid")
      fail("holds " + in_quotes(type, 40) + "; allowed: UnstructuredGrid");
    const std::string order = file->attribute("byte_order");
    if (!order.empty() && order != "LittleEndian" && order != "BigEndian")
      fail("byte_order is " + in_quotes(order, 40) + "; allowed: LittleEndian and BigEndian");
    coding_.swapped = (order == "BigEndian") != (std::endian::native == std::endian::big);
    const std::string header = file->attribute("header_type");
    if (!header.empty() && header != "UInt32" && header != "UInt64")
      fail("header_type is " + in_quotes(header, 40) + "; allowed: UInt32 and UInt64");
    coding_.header = header == "UInt64" ? 8 : 4;
    const std::string compressor = file->attribute("compressor");
    if (!compressor.empty() && compressor != "vtkZLibDataCompressor")
      fail("is compressed by " + in_quotes(compressor, 40) +
           "; allowed: vtkZLibDataCompressor or none (write it without compression)");
    coding_.compressed = !compressor.empty();
  }

  // False behind the arrays: only the appended data follow.
  bool read_tag(const XmlTag& tag) {
    if (tag.name == "AppendedData" && !tag.closing) {
      read_appended(tag);
      return false;
    }
    if (tag.closing) {
      if (tag.name == section_) section_.clear();
      return true;
    }
    if (tag.name == "Piece") {
      read_piece(tag);
    } else if (tag.name == "DataArray" || tag.name == "Array") {
      read_array(tag);
    } else if (!tag.empty) {
      section_ = tag.name;
    }
    return true;
  }

  std::uint64_t whole_number(const XmlTag& tag, const std::string& key) const {
    const std::string text = tag.attribute(key);
    std::uint64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || text.empty())
      tags_.fail(key + " of " + tag.name + " is " + in_quotes(text, 40) +
                 "; allowed: whole numbers from 0");
    return value;
  }

  void read_piece(const XmlTag& tag) {
    const std::uint64_t points = whole_number(tag, "NumberOfPoints");
    const std::uint64_t cells = whole_number(tag, "NumberOfCells");
    if (points == 0 && cells == 0) return;
    if (points_) tags_.fail("a second piece begins here; allowed: one (merge the blocks first)");
    points_ = points;
    cells_ = cells;
  }

  void read_array(const XmlTag& tag) {
    VtuArray array{section_,
                   tag.attribute("Name"),
                   tag.attribute("type"),
                   tag.attribute("format").empty() ? "ascii" : tag.attribute("format"),
                   tag.attribute("NumberOfComponents"),
                   0,
                   {}};
    if (array.format == "appended") array.offset = whole_number(tag, "offset");
    if (!tag.empty) array.text = tags_.text_before("</");
    arrays_.push_back(std::move(array));
  }

  void read_appended(const XmlTag& tag) {
    const std::string encoding = tag.attribute("encoding");
    if (encoding != "raw" && encoding != "base64")
      tags_.fail("the appended data have the encoding " + in_quotes(encoding, 40) +
                 "; allowed: raw and base64");
    coding_.appended_raw = encoding == "raw";
    static_cast<void>(tags_.text_before("_"));
    coding_.appended = tags_.rest().substr(1);
  }

  void check_end() const {
    const std::size_t last = bytes_.find_last_not_of(" \t\r\n");
    if (last == std::string_view::npos || !bytes_.substr(0, last + 1).ends_with("</VTKFile>"))
      fail("does not end with </VTKFile>: the file is truncated");
  }

  [[nodiscard]] const VtuArray* find(const std::string& section, const std::string& array) const {
    for (const VtuArray& a : arrays_)
      if (a.section == section && (array.empty() || a.name == array)) return &a;
    return nullptr;
  }

  const VtuArray& require(const std::string& section, const std::string& array) const {
    const VtuArray* found = find(section, array);
    if (!found) fail("has no array " + in_quotes(array.empty() ? section : array));
    return *found;
  }

  template <class Read>
  auto values(Read&& read, const VtuArray& array, std::optional<std::uint64_t> wanted) const {
    try {
      auto found = read(array, coding_);
      if (wanted && found.size() != *wanted)
        throw "has " + count_of(static_cast<long long>(found.size()), "value") + "; expected " +
            std::to_string(*wanted);
      return found;
    } catch (const std::string& what) {
      fail("the array of " + array.title() + " " + what);
    }
  }

  void read_points() {
    const VtuArray& array = require("Points", "");
    if (array.components != "3")
      fail("the array of Points has NumberOfComponents " + in_quotes(array.components, 20) +
           "; allowed: 3");
    if (*points_ > std::numeric_limits<Index>::max() || *cells_ > std::numeric_limits<Index>::max())
      fail("has more than 2147483647 points or cells", InputFault::too_large);
    mesh_.coordinates = values(vtu_reals, array, 3 * *points_);
    const auto wrong = std::find_if_not(mesh_.coordinates.begin(), mesh_.coordinates.end(),
                                        [](double x) { return std::isfinite(x); });
    if (wrong != mesh_.coordinates.end())
      fail("point " + std::to_string((wrong - mesh_.coordinates.begin()) / 3) +
               " has a coordinate that is " + in_digits(*wrong) + "; allowed: finite numbers",
           InputFault::out_of_range);
    for (std::uint64_t n = 0; n < *points_; ++n) mesh_.node_tags.push_back(n);
  }

  void read_cells() {
    const auto types = values(vtu_integers, require("Cells", "types"), *cells_);
    const auto offsets = values(vtu_integers, require("Cells", "offsets"), *cells_);
    const auto nodes = values(vtu_integers, require("Cells", "connectivity"), std::nullopt);
    const std::vector<std::int64_t> tags = volume_tags();
    std::int64_t begin = 0;
    for (std::size_t c = 0; c < types.size(); ++c) {
      const std::int64_t end = offsets[c];
      if (end < begin || end > static_cast<std::int64_t>(nodes.size()))
        fail("the offset of cell " + std::to_string(c) + " is " + std::to_string(end) +
             "; allowed: " + std::to_string(begin) + " to " + std::to_string(nodes.size()));
      read_cell(c, types[c], {nodes.data() + begin, nodes.data() + end}, tags);
      begin = end;
    }
  }

  void read_cell(std::size_t c, std::int64_t type, std::span<const std::int64_t> nodes,
                 const std::vector<std::int64_t>& tags) {
    if (other_solid(type)) {
      if (mesh_.other_solids++ == 0) mesh_.other_name = "VTK's cell type " + std::to_string(type);
      return;
    }
    if (type != kTetra && type != kQuadraticTetra && type != kLagrangeTetra) return;
    const bool fits = type == kTetra            ? nodes.size() == 4
                      : type == kQuadraticTetra ? nodes.size() == 10
                                                : nodes.size() >= 4;
    if (!fits)
      fail("cell " + std::to_string(c) + " of type " + std::to_string(type) + " has " +
           count_of(static_cast<long long>(nodes.size()), "point"));
    if (nodes.size() > 4) ++mesh_.curved;
    for (const std::int64_t node : nodes.first(4)) {
      if (node < 0 || static_cast<std::uint64_t>(node) >= *points_)
        fail("cell " + std::to_string(c) + " uses point " + std::to_string(node) +
                 "; the file has points 0 to " + std::to_string(*points_ - 1),
             InputFault::bad_id);
      mesh_.tet_nodes.push_back(static_cast<std::uint64_t>(node));
    }
    mesh_.tet_tags.push_back(c);
    mesh_.tet_group.push_back(tags.empty() ? 0 : static_cast<int>(tags[c]));
  }

  std::vector<std::int64_t> volume_tags() const {
    for (const VtuArray& array : arrays_) {
      if (array.section != "CellData" || !array.integer() || !names_volumes(array.name)) continue;
      if (!array.components.empty() && array.components != "1") continue;
      auto tags = values(vtu_integers, array, *cells_);
      for (const std::int64_t tag : tags) {
        if (tag < 0 || tag > std::numeric_limits<int>::max())
          fail("the array of " + array.title() + " has the value " + std::to_string(tag) +
                   "; allowed as a volume's tag: 0 to 2147483647",
               InputFault::bad_id);
      }
      return tags;
    }
    return {};
  }

  void read_names() {
    for (const VtuArray& array : arrays_) {
      if (array.section != "FieldData" || !array.integer() || array.name.empty()) continue;
      const auto tag = values(vtu_integers, array, std::nullopt);
      if (tag.size() != 1 || tag[0] < 0 || tag[0] > std::numeric_limits<int>::max()) continue;
      mesh_.groups.push_back({3, static_cast<int>(tag[0]), array.name});
    }
  }

  /// Vectors of the tetrahedra, which fibres may follow.
  void read_fields() {
    for (const VtuArray& array : arrays_) {
      const bool real = array.type == "Float32" || array.type == "Float64";
      if (array.section != "CellData" || !real || array.components != "3") continue;
      const auto all = values(vtu_reals, array, 3 * *cells_);
      std::vector<Vec3>& field = mesh_.fields[array.name];
      field.clear();
      for (const std::uint64_t cell : mesh_.tet_tags) {
        field.emplace_back(all[3 * cell], all[3 * cell + 1], all[3 * cell + 2]);
      }
    }
  }

  std::string_view bytes_;
  const std::string& name_;
  XmlTags tags_;
  VtuCoding coding_;
  std::string section_;
  std::vector<VtuArray> arrays_;
  std::optional<std::uint64_t> points_, cells_;
  RawMesh mesh_;
};

}  // namespace

RawMesh read_vtu(std::string_view bytes, const std::string& name) {
  return VtuReader(bytes, name).read();
}

}  // namespace sunder::app
