// SPDX-License-Identifier: Apache-2.0
// fuzz_seeds FOLDER: small meshes in every format that the mesh readers know, each with the byte in
// front that chooses its reader.
#include <filesystem>
#include <fstream>
#include <iostream>

#include "app/input/msh_text.hpp"
#include "app/mesh_board/msh_writer.hpp"
#include "app/mesh_board/structured_board.hpp"

int main(int count, char** arguments) {
  if (count != 2) {
    std::cerr << "usage: fuzz_seeds FOLDER\n";
    return 2;
  }
  const std::filesystem::path folder = arguments[1];
  std::filesystem::create_directories(folder);
  const auto write = [&](const char* name, char reader, const std::string& bytes) {
    std::ofstream(folder / name, std::ios::binary) << reader << bytes;
  };
  const sunder::Mesh board = sunder::app::structured_board({1, 4, 1}, 2.0);
  write("msh22-ascii", 'm', sunder::test::to_msh22_ascii(board));
  write("msh22-binary", 'm', sunder::test::to_msh22_binary(board));
  write("msh41-ascii", 'm', sunder::app::to_msh(board, true));
  write("msh41-binary", 'm', sunder::app::to_msh(board, false));
  write("vtk-ascii", 'v',
        "# vtk DataFile Version 2.0\ntitle\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n"
        "0 0 0\n1 0 0\n0 1 0\n0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nCELL_DATA 1\n"
        "SCALARS region int 1\nLOOKUP_TABLE default\n3\nFIELD f 1\nmaterial 1 1 int\n7\n");
  write("msh1", 'm',
        "$NOD\n4\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n$ENDNOD\n$ELM\n1\n1 4 7 1 4 1 2 3 4\n"
        "$ENDELM\n");
  write("vtu-ascii", 'x',
        "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\"><UnstructuredGrid>"
        "<FieldData><DataArray type=\"Int32\" Name=\"organ\" format=\"ascii\">3</DataArray>"
        "</FieldData><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><Points><DataArray "
        "type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 1 0 0 0 1"
        "</DataArray></Points><Cells><DataArray type=\"Int32\" Name=\"connectivity\" "
        "format=\"ascii\">0 1 2 3</DataArray><DataArray type=\"Int64\" Name=\"offsets\" "
        "format=\"binary\">CAAAAAQAAAAAAAAA</DataArray><DataArray type=\"UInt8\" Name=\"types\" "
        "format=\"appended\" offset=\"0\"/></Cells><CellData><DataArray type=\"Int32\" "
        "Name=\"volume\" format=\"ascii\">3</DataArray></CellData></Piece></UnstructuredGrid>"
        "<AppendedData encoding=\"base64\">_AQAAAAo=</AppendedData></VTKFile>");
  write("mesh", 'e',
        "MeshVersionFormatted 2\nDimension 3\nVertices\n4\n0 0 0 1\n1 0 0 1\n0 1 0 1\n0 0 1 1\n"
        "Tetrahedra\n1\n1 2 3 4 1\nEnd\n");
  write("bdf", 'b',
        "GRID,1,,0,0,0\nGRID,2,,1,0,0\nGRID,3,,0,1,0\nGRID,4,,0,0,1\nCTETRA,1,1,1,2,3,4\n"
        "ENDDATA\n");
  write("unv", 'u',
        "    -1\n  2411\n         1         1         1        11\n"
        "   0.0000000000000000D+00   0.0000000000000000D+00   0.0000000000000000D+00\n    -1\n");
}
