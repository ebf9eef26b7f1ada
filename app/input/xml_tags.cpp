// SPDX-License-Identifier: Apache-2.0
#include "app/input/xml_tags.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "sunder/in_quotes.hpp"

namespace sunder::app {
namespace {

constexpr std::string_view kSpace = " \t\r\n";

std::string unescaped(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, char>, 6> known = {{{"&amp;", '&'},
                                                                       {"&lt;", '<'},
                                                                       {"&gt;", '>'},
                                                                       {"&quot;", '"'},
                                                                       {"&apos;", '\''},
                                                                       {"&#39;", '\''}}};
  std::string plain;
  while (!text.empty()) {
    const auto entity = std::find_if(known.begin(), known.end(),
                                     [&](const auto& e) { return text.starts_with(e.first); });
    plain += entity == known.end() ? text.front() : entity->second;
    text.remove_prefix(entity == known.end() ? 1 : entity->first.size());
  }
  return plain;
}

}  // namespace

std::string XmlTag::attribute(const std::string& key) const {
  const auto found = attributes.find(key);
  return found == attributes.end() ? "" : found->second;
}

void XmlTags::fail(const std::string& message, InputFault fault) const {
  const std::string_view before = bytes_.substr(0, position_);
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  throw InputError(fault, name_ + ":" + std::to_string(line) + ": " + message);
}

void XmlTags::skip_behind(std::string_view mark) {
  static_cast<void>(text_before(mark));
  position_ += mark.size();
}

std::string_view XmlTags::text_before(std::string_view mark) {
  const std::size_t begin = position_;
  const std::size_t end = bytes_.find(mark, begin);
  if (end == std::string_view::npos)
    fail(in_quotes(mark) + " is missing behind here: the file is truncated");
  position_ = end;
  return bytes_.substr(begin, end - begin);
}

std::string XmlTags::word() {
  constexpr std::string_view ends = " \t\r\n=/>";
  const std::size_t begin = position_;
  position_ = std::min(bytes_.find_first_of(ends, begin), bytes_.size());
  return std::string(bytes_.substr(begin, position_ - begin));
}

void XmlTags::read_attribute(XmlTag& tag) {
  const std::string key = word();
  const auto at = [&](char c) { return position_ < bytes_.size() && bytes_[position_] == c; };
  if (key.empty() || !at('=')) fail("a tag is damaged: expected key=\"value\"");
  ++position_;
  if (!at('"') && !at('\'')) fail("a tag is damaged: a value must stand in quotes");
  const char quote = bytes_[position_++];
  tag.attributes[key] = unescaped(text_before(std::string_view(&quote, 1)));
  ++position_;
}

std::optional<XmlTag> XmlTags::next() {
  while (true) {
    position_ = std::min(bytes_.find('<', position_), bytes_.size());
    if (rest().empty()) return std::nullopt;
    if (rest().starts_with("<!--")) {
      skip_behind("-->");
    } else if (rest().starts_with("<?")) {
      skip_behind("?>");
    } else if (rest().starts_with("<!")) {
      skip_behind(">");
    } else {
      break;
    }
  }
  ++position_;
  XmlTag tag;
  tag.closing = rest().starts_with('/');
  if (tag.closing) ++position_;
  tag.name = word();
  while (true) {
    position_ = std::min(bytes_.find_first_not_of(kSpace, position_), bytes_.size());
    if (rest().empty()) fail("the file ends inside a tag: it is truncated");
    if (rest().front() == '>') break;
    if (rest().starts_with("/>")) {
      tag.empty = true;
      ++position_;
      break;
    }
    read_attribute(tag);
  }
  ++position_;
  return tag;
}

}  // namespace sunder::app
