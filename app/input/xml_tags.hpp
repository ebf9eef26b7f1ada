// SPDX-License-Identifier: Apache-2.0
// The tags of an XML file, one after the other: enough for VTK's files, whose appended data no XML
// parser takes.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "sunder/error.hpp"

namespace sunder::app {

struct XmlTag {
  std::string name;
  std::map<std::string, std::string> attributes;
  bool closing = false;                                               ///< </name>
  bool empty = false;                                                 ///< <name/>
  [[nodiscard]] std::string attribute(const std::string& key) const;  ///< "" when absent
};

class XmlTags {
 public:
  XmlTags(std::string_view bytes, std::string name) : bytes_(bytes), name_(std::move(name)) {}

  /// The next tag, comments and declarations skipped; nullopt at the end of the file.
  [[nodiscard]] std::optional<XmlTag> next();
  /// Text from here to the next `mark`, and moves there. Fails when there is none.
  [[nodiscard]] std::string_view text_before(std::string_view mark);
  [[nodiscard]] std::string_view rest() const { return bytes_.substr(position_); }

  [[noreturn]] void fail(const std::string& message,
                         InputFault fault = InputFault::unreadable_file) const;

 private:
  void skip_behind(std::string_view mark);
  [[nodiscard]] std::string word();
  void read_attribute(XmlTag& tag);

  std::string_view bytes_;
  std::string name_;
  std::size_t position_ = 0;
};

}  // namespace sunder::app
