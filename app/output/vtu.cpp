// SPDX-License-Identifier: Apache-2.0
#include "app/output/vtu.hpp"

#include <array>
#include <bit>
#include <cstring>
#include <span>

#include "app/output/result_file.hpp"
#include "app/output/text.hpp"

namespace sunder::app {
namespace {

static_assert(std::endian::native == std::endian::little, "VTU files are written little endian");

constexpr int kVtkTriangle = 5, kVtkTetra = 10;

template <class T>
constexpr const char* kTypeName = nullptr;
template <>
constexpr const char* kTypeName<double> = "Float64";
template <>
constexpr const char* kTypeName<std::int32_t> = "Int32";
template <>
constexpr const char* kTypeName<std::int64_t> = "Int64";
template <>
constexpr const char* kTypeName<std::uint8_t> = "UInt8";

/// A length as header, then the bytes, in one base64 stream (VTK file formats, "binary").
void write_base64(ResultFile& file, std::string_view bytes) {
  constexpr std::size_t block = 3 * 16384;  // a multiple of three: no padding within the stream
  const std::uint64_t length = bytes.size();
  std::string chunk(sizeof length, '\0');
  std::memcpy(chunk.data(), &length, sizeof length);
  while (true) {
    const std::size_t take = std::min(block - chunk.size(), bytes.size());
    chunk.append(bytes.substr(0, take));
    bytes.remove_prefix(take);
    file.write(base64(chunk));
    if (bytes.empty()) return;
    chunk.clear();
  }
}

template <class T>
void write_array(ResultFile& file, const std::string& name, int components,
                 std::span<const T> values, const std::string& more = {}) {
  file.write("        <DataArray type=\"" + std::string(kTypeName<T>) + "\" Name=\"" +
             escaped(name) + "\" NumberOfComponents=\"" + std::to_string(components) + "\"" + more +
             " format=\"binary\">");
  write_base64(file, {reinterpret_cast<const char*>(values.data()), values.size_bytes()});
  file.write("</DataArray>\n");
}

template <class T>
void write_array(ResultFile& file, const std::string& name, const std::vector<T>& values) {
  write_array<T>(file, name, 1, values);
}

/// Fixed-size vectors of Eigen lie packed in a std::vector.
template <class Vector>
void write_vectors(ResultFile& file, const std::string& name, const std::vector<Vector>& values) {
  constexpr int components = Vector::SizeAtCompileTime;
  static_assert(sizeof(Vector) == components * sizeof(double));
  write_array<double>(
      file, name, components,
      {values.empty() ? nullptr : values.front().data(), values.size() * components});
}

/// One entry per named volume: the array's name is the volume's, its value the tag.
void write_tag_names(ResultFile& file, const Mesh& mesh) {
  file.write("    <FieldData>\n");
  for (const NamedVolume& volume : mesh.volumes) {
    const std::int32_t tag = volume.tag;
    write_array<std::int32_t>(file, volume.name, 1, {&tag, 1}, " NumberOfTuples=\"1\"");
  }
  file.write("    </FieldData>\n");
}

/// Cells of one kind, each with as many corners.
template <std::size_t Corners>
void write_cells(ResultFile& file, const std::vector<std::array<Index, Corners>>& cells,
                 std::uint8_t type) {
  static_assert(sizeof(cells[0]) == Corners * sizeof(std::int32_t));
  std::vector<std::int64_t> offsets(cells.size());
  for (std::size_t e = 0; e < offsets.size(); ++e)
    offsets[e] = static_cast<std::int64_t>(Corners * (e + 1));
  file.write("      <Cells>\n");
  write_array<std::int32_t>(
      file, "connectivity", 1,
      {cells.empty() ? nullptr : cells.front().data(), cells.size() * Corners});
  write_array(file, "offsets", offsets);
  write_array(file, "types", std::vector<std::uint8_t>(cells.size(), type));
  file.write("      </Cells>\n");
}

constexpr const char* kOpening =
    "<?xml version=\"1.0\"?>\n"
    "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
    "header_type=\"UInt64\">\n  <UnstructuredGrid>\n";
constexpr const char* kClosing = "    </Piece>\n  </UnstructuredGrid>\n</VTKFile>\n";

std::string piece(std::size_t points, std::size_t cells) {
  return "    <Piece NumberOfPoints=\"" + std::to_string(points) + "\" NumberOfCells=\"" +
         std::to_string(cells) + "\">\n";
}

void write_cell_data(ResultFile& file, const Problem& problem, const State& state) {
  const Mesh& mesh = problem.mesh();
  std::vector<std::int32_t> tags(mesh.tets.size());
  for (std::size_t e = 0; e < tags.size(); ++e) tags[e] = mesh.volumes[mesh.volume_of[e]].tag;
  file.write("      <CellData>\n");
  if (problem.scene().output.stress && !state.stress.empty()) {
    // VTK's symmetric tensors have the order xx yy zz xy yz xz: Voigt's here.
    write_vectors(file, "stress", state.stress);
    write_array(file, "max_shear", max_shears(state));
    write_array(file, "yield_ratio", yield_ratios(problem, state));
  }
  for (int family = 0; family < problem.fibre_families(); ++family) {
    std::vector<Vec3> along;
    for (Index e = 0; e < problem.tet_count(); ++e) {
      along.push_back(problem.fibre_direction(e, family));
    }
    write_vectors(file, family == 0 ? "fibres" : "fibres_2", along);
  }
  write_array(file, "destroyed", state.destroyed);
  write_array(file, "volume", tags);
  file.write("      </CellData>\n");
}

}  // namespace

void write_vtu(ResultFile& file, const Problem& problem, const State& state) {
  const Mesh& mesh = mesh_of(problem, state);
  file.write(kOpening);
  write_tag_names(file, mesh);
  file.write(piece(mesh.nodes.size(), mesh.tets.size()));
  file.write("      <PointData>\n");
  if (problem.scene().output.displacement) write_vectors(file, "displacement", state.displacement);
  file.write("      </PointData>\n");
  write_cell_data(file, problem, state);
  file.write("      <Points>\n");
  write_vectors(file, "points", mesh.nodes);
  file.write("      </Points>\n");
  write_cells(file, mesh.tets, kVtkTetra);
  file.write(kClosing);
}

namespace {

/// Triangles of both lips with nodes of their own, as cracks.vtu has them.
struct Lips {
  std::vector<Index> nodes;  ///< of the body, per point
  std::vector<std::array<Index, 3>> triangles;
  std::vector<std::int32_t> crack, side;
};

Lips lips_of(const SplitMesh& split) {
  Lips lips;
  std::vector<Index> point(split.mesh.nodes.size(), kNone);
  const auto add = [&](const CrackFace& face, const std::array<Index, 3>& lip, std::int32_t side) {
    std::array<Index, 3> corners{};
    for (std::size_t i = 0; i < 3; ++i) {
      Index& at = point[static_cast<std::size_t>(lip[i])];
      if (at == kNone) {
        at = static_cast<Index>(lips.nodes.size());
        lips.nodes.push_back(lip[i]);
      }
      corners[i] = at;
    }
    lips.triangles.push_back(corners);
    lips.crack.push_back(face.crack);
    lips.side.push_back(side);
  };
  for (const CrackFace& face : split.faces) {
    add(face, face.left, 1);
    add(face, face.right, -1);
  }
  return lips;
}

}  // namespace

void write_cracks_vtu(ResultFile& file, const State& state) {
  const Lips lips = state.split ? lips_of(*state.split) : Lips{};
  const std::vector<double> all =
      state.split ? openings(*state.split, state.displacement) : std::vector<double>{};
  std::vector<double> opening;
  std::vector<Vec3> points, displacement;
  for (const Index n : lips.nodes) {
    const auto node = static_cast<std::size_t>(n);
    opening.push_back(all[node]);
    displacement.push_back(state.displacement[node]);
    points.push_back(state.split->drawn[node] + state.displacement[node]);
  }
  file.write(kOpening);
  file.write(piece(points.size(), lips.triangles.size()));
  file.write("      <PointData>\n");
  write_array(file, "opening", opening);
  write_vectors(file, "displacement", displacement);
  file.write("      </PointData>\n      <CellData>\n");
  write_array(file, "crack", lips.crack);
  write_array(file, "side", lips.side);
  file.write("      </CellData>\n      <Points>\n");
  write_vectors(file, "points", points);
  file.write("      </Points>\n");
  write_cells(file, lips.triangles, kVtkTriangle);
  file.write(kClosing);
}

std::string pvd(const std::vector<SeriesEntry>& entries) {
  std::string out =
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n"
      "  <Collection>\n";
  for (const SeriesEntry& entry : entries)
    out += "    <DataSet timestep=\"" + number(entry.load_factor) + "\" part=\"0\" file=\"" +
           escaped(entry.file) + "\"/>\n";
  return out + "  </Collection>\n</VTKFile>\n";
}

}  // namespace sunder::app
