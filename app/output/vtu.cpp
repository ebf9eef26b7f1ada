// SPDX-License-Identifier: Apache-2.0
#include "app/output/vtu.hpp"

#include <bit>
#include <cstring>
#include <span>

#include "app/output/result_file.hpp"
#include "app/output/text.hpp"

namespace sunder::app {
namespace {

static_assert(std::endian::native == std::endian::little, "VTU files are written little endian");

constexpr int kVtkTetra = 10;

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

void write_cells(ResultFile& file, const Mesh& mesh) {
  static_assert(sizeof(mesh.tets[0]) == 4 * sizeof(std::int32_t));
  std::vector<std::int64_t> offsets(mesh.tets.size());
  for (std::size_t e = 0; e < offsets.size(); ++e)
    offsets[e] = static_cast<std::int64_t>(4 * e + 4);
  file.write("      <Cells>\n");
  write_array<std::int32_t>(file, "connectivity", 1,
                            {mesh.tets.front().data(), mesh.tets.size() * 4});
  write_array(file, "offsets", offsets);
  write_array(file, "types", std::vector<std::uint8_t>(mesh.tets.size(), kVtkTetra));
  file.write("      </Cells>\n");
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
  write_array(file, "destroyed", state.destroyed);
  write_array(file, "volume", tags);
  file.write("      </CellData>\n");
}

}  // namespace

void write_vtu(ResultFile& file, const Problem& problem, const State& state) {
  const Mesh& mesh = problem.mesh();
  file.write(
      "<?xml version=\"1.0\"?>\n"
      "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n  <UnstructuredGrid>\n");
  write_tag_names(file, mesh);
  file.write("    <Piece NumberOfPoints=\"" + std::to_string(mesh.nodes.size()) +
             "\" NumberOfCells=\"" + std::to_string(mesh.tets.size()) + "\">\n");
  file.write("      <PointData>\n");
  if (problem.scene().output.displacement) write_vectors(file, "displacement", state.displacement);
  file.write("      </PointData>\n");
  write_cell_data(file, problem, state);
  file.write("      <Points>\n");
  write_vectors(file, "points", mesh.nodes);
  file.write("      </Points>\n");
  write_cells(file, mesh);
  file.write("    </Piece>\n  </UnstructuredGrid>\n</VTKFile>\n");
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
