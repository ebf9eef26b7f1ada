// SPDX-License-Identifier: Apache-2.0
// The values of one DataArray of a .vtu file, whichever way they are written.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace sunder::app {

/// What all arrays of a file share.
struct VtuCoding {
  bool swapped = false;       ///< the other byte order
  std::size_t header = 4;     ///< bytes of a length
  bool compressed = false;    ///< by zlib
  bool appended_raw = false;  ///< else base64
  std::string_view appended;  ///< what follows the "_" of AppendedData
};

struct VtuArray {
  std::string section;  ///< Points, Cells, CellData, FieldData, ...
  std::string name, type, format;
  std::string components;
  std::uint64_t offset = 0;  ///< in the appended data
  std::string_view text;     ///< of the element
  [[nodiscard]] std::string title() const;
  [[nodiscard]] bool integer() const;
};

/// Throw std::string: what is wrong with the array, to stand behind its title.
[[nodiscard]] std::vector<double> vtu_reals(const VtuArray& array, const VtuCoding& coding);
[[nodiscard]] std::vector<std::int64_t> vtu_integers(const VtuArray& array,
                                                     const VtuCoding& coding);

}  // namespace sunder::app
