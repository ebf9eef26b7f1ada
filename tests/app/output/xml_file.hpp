// SPDX-License-Identifier: Apache-2.0
// Reads an XML file into a tree with a parser of its own (GLib's), so that what the writers write
// is checked by somebody else.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace sunder::test {

struct XmlElement {
  std::string name, text;
  std::map<std::string, std::string> attributes;
  std::vector<XmlElement> children;

  /// First child of this name, or (with `key`) whose attribute Name is `key`. Throws if absent.
  [[nodiscard]] const XmlElement& child(std::string_view element, std::string_view key = {}) const;
  [[nodiscard]] std::vector<std::string> array_names() const;
};

/// Throws when the text is not well-formed.
[[nodiscard]] XmlElement parse_xml(const std::string& text);

/// Values of an inline binary array of a VTK XML file: base64 of a 64-bit length and the data.
[[nodiscard]] std::string decode_array(const XmlElement& array);

template <class T>
std::vector<T> values_of(const XmlElement& array) {
  const std::string bytes = decode_array(array);
  std::vector<T> values(bytes.size() / sizeof(T));
  bytes.copy(reinterpret_cast<char*>(values.data()), bytes.size());
  return values;
}

}  // namespace sunder::test
